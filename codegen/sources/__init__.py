# SPDX-License-Identifier: BSD-3-Clause
"""C sources as the templates show them."""
