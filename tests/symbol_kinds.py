# SPDX-License-Identifier: BSD-3-Clause
"""CasADi's kinds of symbols, for tests that expressions take any of them."""

from __future__ import annotations

import casadi as ca

from softimpact.symbolic import Matrix

KINDS: tuple[Matrix, ...] = (ca.SX, ca.MX)
"""CasADi's functions take lists of the one or of the other, which only ``Matrix`` can say."""
