# SPDX-License-Identifier: BSD-3-Clause
"""What a user typed: options, values, and the robot, pose and motors that are meant."""
