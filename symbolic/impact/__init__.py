# SPDX-License-Identifier: BSD-3-Clause
"""The robot about to hit: drives, springs, the linear model and its reductions."""
