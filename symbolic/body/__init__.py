# SPDX-License-Identifier: BSD-3-Clause
"""The human side of an impact: regions of the body and the law of contact."""
