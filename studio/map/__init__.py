# SPDX-License-Identifier: BSD-3-Clause
"""Safe speeds all over a plane or along a self-motion."""
