# SPDX-License-Identifier: BSD-3-Clause
"""Impact factors: GIAF and its family, ellipsoids, impulses, mitigation."""
