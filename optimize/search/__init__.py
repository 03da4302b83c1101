# SPDX-License-Identifier: BSD-3-Clause
"""Searches of springs and postures: the program, Ipopt on it, and where it begins and ends."""
