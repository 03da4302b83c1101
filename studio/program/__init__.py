# SPDX-License-Identifier: BSD-3-Clause
"""Programs: motions, zones, and how far each sample must slow down."""
