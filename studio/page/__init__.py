# SPDX-License-Identifier: BSD-3-Clause
"""The interactive page: a robot's C package as WebAssembly, and what draws it in a browser."""
