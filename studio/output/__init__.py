# SPDX-License-Identifier: BSD-3-Clause
"""What leaves a command: JSON, tables, progress, a folder of results, and its cautions."""
