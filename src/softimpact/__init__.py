# SPDX-License-Identifier: BSD-3-Clause
"""softimpact: design compliant robots whose impacts do not hurt."""

__version__ = "0.1.0"
