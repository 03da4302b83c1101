# SPDX-License-Identifier: BSD-3-Clause
"""What a package's header declares, for those who call it from other languages."""
