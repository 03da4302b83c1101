# SPDX-License-Identifier: BSD-3-Clause
"""What C functions read: parameters, poses, contacts, and samples of them."""
