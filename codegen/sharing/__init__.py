# SPDX-License-Identifier: BSD-3-Clause
"""What several functions compute, so that it stands in C once."""
