# SPDX-License-Identifier: BSD-3-Clause
"""What a robot's file says, and a study to begin with."""
