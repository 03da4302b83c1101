# SPDX-License-Identifier: BSD-3-Clause
"""Impacts that others measured, foretold from what is known of the robots and what is not."""
