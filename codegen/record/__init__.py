# SPDX-License-Identifier: BSD-3-Clause
"""What a package says of itself, what it was measured to cost and what search it stood."""
