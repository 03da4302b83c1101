# SPDX-License-Identifier: BSD-3-Clause
"""The force of an impact as an expression that Ipopt can differentiate."""
