# SPDX-License-Identifier: BSD-3-Clause
"""CasADi expressions as lists of operations, and these as C."""
