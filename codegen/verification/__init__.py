# SPDX-License-Identifier: BSD-3-Clause
"""Right results of a package's functions, and its own test, run before it is written."""
