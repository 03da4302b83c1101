# SPDX-License-Identifier: BSD-3-Clause
"""Rigid-body dynamics over symbols: kinematics, mass matrix, bias, potential, rest."""
