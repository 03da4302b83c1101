# SPDX-License-Identifier: BSD-3-Clause
"""Both papers recomputed: every number MSM prints, the figures and statements of GIAF."""
