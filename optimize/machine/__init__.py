# SPDX-License-Identifier: BSD-3-Clause
"""The machine that a design may change."""
