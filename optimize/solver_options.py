# SPDX-License-Identifier: BSD-3-Clause
"""How CasADi calls Ipopt."""

from __future__ import annotations

from typing import Any

FEASIBLE = 1e-5
"""Ipopt's tolerance on design NLPs, and so the share by which a design may miss a bound."""


def quiet(ipopt: dict[str, Any]) -> dict[str, Any]:
    """Return options of CasADi's nlpsol for an Ipopt that prints nothing and raises nothing."""
    silent = {**ipopt, "print_level": 0, "sb": "yes"}
    return {"ipopt": silent, "print_time": False, "error_on_fail": False}
