# SPDX-License-Identifier: BSD-3-Clause
"""What a robot is: joints, bodies and frames as frozen data; reading files; welding."""
