# SPDX-License-Identifier: BSD-3-Clause
"""What a study asks: its file, checked, and what it means for a robot."""
