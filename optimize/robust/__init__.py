# SPDX-License-Identifier: BSD-3-Clause
"""One machine for many scenarios, by exchange."""
