# SPDX-License-Identifier: BSD-3-Clause
"""The physics as CasADi expressions."""
