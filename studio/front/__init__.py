# SPDX-License-Identifier: BSD-3-Clause
"""Fronts of designs, checked by simulation, in tables and words; their published form."""
