# SPDX-License-Identifier: BSD-3-Clause
"""Closed chains: independent coordinates, loop equations and configurations that close."""
