# SPDX-License-Identifier: BSD-3-Clause
"""The quantities as CasADi functions of (q, n, springs, rotors, gains) with one dense output."""

from __future__ import annotations

from typing import Any

import casadi as ca

from softimpact.symbolic import (
    Drives,
    ImpactModel,
    Robot,
    contact_mobility,
    count_flops,
    giaf,
    giif,
)

SLOW = (ca.OP_DIV, ca.OP_INV, ca.OP_SQRT)
"""Operations that take a Cortex-M fourteen cycles."""

QUANTITIES = ("mass_matrix", "osim", "reflected_mass", "reduced_model", "giaf")


class Quantities:
    """Functions of one contender by quantity, their operations, and divisions among them."""

    def __init__(self, contender: str, symbols: list[Any], values: dict[str, list[Any]]) -> None:
        self.flops: dict[str, int] = {}
        self.divisions: dict[str, int] = {}
        self.functions: dict[str, Any] = {}
        for quantity, parts in values.items():
            output = ca.cse(ca.densify(ca.veccat(*parts)))
            self.flops[quantity] = count_flops(output)
            function = ca.Function(f"{contender}_{quantity}", symbols, [output])
            steps = range(function.n_instructions())
            self.divisions[quantity] = sum(function.instruction_id(k) in SLOW for k in steps)
            self.functions[quantity] = function


def our_expressions(robot: Robot) -> Quantities:
    """Return our own expressions, for CasADi's code generator."""
    symbols = _symbols(robot.n)
    q, n, springs, rotors, gains = symbols
    model = ImpactModel(robot, str(robot.tip), Drives(rotors, springs, (True,) * robot.n, gains))
    real, free, reduced = model.mobility(q), model.free_mobility(q), model.reduced(q, n)
    values = {
        "mass_matrix": [model.mass_matrix(q)],
        "osim": [real.inertia, free.inertia],
        "reflected_mass": [model.reflected_mass(q, n)],
        "reduced_model": [reduced.m_c, reduced.k_r, reduced.m_a],
        "giaf": [giaf(free, real), giif(free, real)],
    }
    return Quantities("casadi", symbols, values)


def built_on(contender: str, arm: Any) -> Quantities:
    """Return what follows from another library's M(q) and J(q), as the papers' formulas say."""
    joints = arm.numel_in(0)
    symbols = _symbols(joints)
    q, n, springs, rotors, gains = symbols
    M, J = arm(q)
    real, free = contact_mobility(M + ca.diag(rotors), J), contact_mobility(M, J)
    values = {
        "mass_matrix": [M],
        "osim": [real.inertia, free.inertia],
        "reflected_mass": [_pushed(M, J, n)[0]],
        "reduced_model": _two_masses(M, J, n, springs, rotors, gains),
        "giaf": [giaf(free, real), giif(free, real)],
    }
    return Quantities(contender, symbols, values)


def _symbols(joints: int) -> list[Any]:
    sizes = {"q": joints, "n": 3, "springs": joints, "rotors": joints, "gains": joints}
    return [ca.SX.sym(name, size) for name, size in sizes.items()]


def _pushed(M: Any, J: Any, n: Any) -> tuple[Any, Any]:
    """Return m_c and M⁻¹ Jᵀ n."""
    j = ca.mtimes(J.T, n)
    D, LT, order = ca.ldl(M)
    pushed = ca.ldl_solve(j, D, LT, order)
    return 1 / ca.dot(j, pushed), pushed


def _two_masses(M: Any, J: Any, n: Any, springs: Any, rotors: Any, gains: Any) -> list[Any]:
    """Return m_c, k_r and m_a = k_r⟨N, B⟩/⟨B, B⟩ (MSM Eq. 36-38), with N and B written out."""
    j = ca.mtimes(J.T, n)
    m_c, pushed = _pushed(M, J, n)
    J_c = ca.vertcat(j, j).T
    inverse = m_c * ca.vertcat(ca.SX.zeros(j.numel()), pushed)  # J_c#
    M0 = ca.blockcat([[M + ca.diag(rotors), M], [M, M]])
    K0 = ca.diag(ca.vertcat(gains, springs))
    S = ca.SX.eye(J_c.numel()) - ca.mtimes(inverse, J_c)
    N, B = M0 - m_c * ca.mtimes(J_c.T, J_c), ca.mtimes([S.T, K0, S])
    k_r = ca.dot(inverse, ca.mtimes(K0, inverse))
    return [m_c, k_r, k_r * ca.dot(N, B) / ca.dot(B, B)]
