# SPDX-License-Identifier: BSD-3-Clause
"""Where long work runs: processes, clusters, and results on disk as they arrive."""
