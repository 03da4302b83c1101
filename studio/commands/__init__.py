# SPDX-License-Identifier: BSD-3-Clause
"""The commands, a file each; ``common`` is what all have."""
