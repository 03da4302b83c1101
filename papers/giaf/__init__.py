# SPDX-License-Identifier: BSD-3-Clause
"""GIAF recomputed: Relaño, Sanz-Merodio, López, Monje on impact response factors, §III."""
