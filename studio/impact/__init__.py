# SPDX-License-Identifier: BSD-3-Clause
"""Impacts as a user asks for them, and their record."""
