# SPDX-License-Identifier: BSD-3-Clause
"""MSM recomputed from end to end: Jeanneau, Begoc, Briot, J. Mechanisms Robotics 16(4), 2024."""
