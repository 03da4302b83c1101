# SPDX-License-Identifier: BSD-3-Clause
"""What a design found, checked by simulation, in tables and words."""
