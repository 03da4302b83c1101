# SPDX-License-Identifier: BSD-3-Clause
"""A package as a folder of files."""
