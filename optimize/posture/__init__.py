# SPDX-License-Identifier: BSD-3-Clause
"""Where a robot holds its tip: poses, postures that hold one, and planes of them."""
