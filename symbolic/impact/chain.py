# SPDX-License-Identifier: BSD-3-Clause
"""A chain of masses and springs that stands for the robot at a contact point.

The Lanczos recurrence on (K0, M0) from the contact mode J_c# turns the linear model into a
tridiagonal one, which is a chain of masses with the contact on the first. A chain of order r
reproduces the contact point's motion to order 2r in time, does not depend on the choice of
coordinates, and at full order is the linear model itself.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Literal, get_args

import casadi as ca

from ..errors import InvalidValue, UnknownName
from ..matrices import Matrix
from .elastic import LinearModel
from .reduction import contact_mode

CLOSED = 1e-20
"""Square of the share of a mass's pull below which nothing is left behind its spring."""

ChainEnd = Literal["free", "grounded"]


@dataclass(frozen=True, eq=False)
class Chain:
    """Masses in a row; the contact force acts on the first.

    Attributes:
        mass: [kg], the first is m_c.
        stiffness: [N/m]; entry i joins mass i and i+1, the last holds the last mass to ground.
        displacement: N×r matrix W; the masses move by Wᵀ Δq.
    """

    mass: Sequence[Matrix]
    stiffness: Sequence[Matrix]
    displacement: Matrix

    @property
    def order(self) -> int:
        """Number of masses."""
        return len(self.mass)


def chain(
    model: LinearModel,
    order: int,
    end: ChainEnd = "grounded",
    *,
    reorthogonalise: bool | Literal["once"] = False,
) -> Chain:
    """Return the chain of ``order`` masses; the first spring is k_r of MSM.

    A model with fewer coordinates gives fewer masses, and so does a numeric one whose chain closes
    before (no spring reaches further masses).

    Args:
        model: M0, K0 and J_c.
        order: number of masses, at least 1; raises InvalidValue.
        end: ``grounded`` keeps the spring from the last mass to ground, ``free`` drops it; raises
            UnknownName.
        reorthogonalise: keep every mass's motion orthogonal to all before it, not just to the
            last two. Rounding makes this necessary beyond five masses or so; it costs N·r more.
            ``once`` is half of it, and enough for six digits in double or three in float.
    """
    if order < 1:
        raise InvalidValue("order", f"must be at least 1, but is {order}")
    if end not in get_args(ChainEnd):
        raise UnknownName("end of a chain", end, get_args(ChainEnd))
    order = min(order, model.stiffness.shape[0])
    mode = contact_mode(model)
    links = [_Link(mode.m_c, mode.direction, model.jacobian.T * mode.m_c)]
    springs: list[Matrix] = []
    while True:
        pull = ca.mtimes(model.stiffness, links[-1].shape)
        total = ca.dot(links[-1].shape, pull)
        springs.append(total - springs[-1] if springs else total)
        if len(links) == order:
            break
        rest = _pull_on_rest(links, springs, pull, total)
        if reorthogonalise:
            rest = _orthogonal(rest, links)
        if reorthogonalise is True:
            rest = _orthogonal(rest, links)
        answer = model.mass.solve(rest)
        mobility = ca.dot(rest, answer)
        if _is_closed(mobility, total * total / links[-1].mass):
            break
        mass = springs[-1] * springs[-1] / mobility
        scale = -mass / springs[-1]
        links.append(_Link(mass, answer * scale, rest * scale))
    displacement = ca.horzcat(*[link.momentum / link.mass for link in links])
    grounded = Chain([link.mass for link in links], springs, displacement)
    return grounded if end == "grounded" else free_end(grounded)


@dataclass(frozen=True, eq=False)
class _Link:
    """A mass of the chain: how the coordinates move with it, and M0 times that."""

    mass: Matrix
    shape: Matrix
    momentum: Matrix


def _pull_on_rest(links: list[_Link], springs: list[Matrix], pull: Matrix, total: Matrix) -> Matrix:
    """Return what the last mass pulls on, less itself and the mass before it."""
    rest = pull - links[-1].momentum * (total / links[-1].mass)
    if len(links) > 1:
        rest = rest + links[-2].momentum * (springs[-2] / links[-2].mass)
    return rest


def _orthogonal(rest: Matrix, links: list[_Link]) -> Matrix:
    for link in links:
        rest = rest - link.momentum * (ca.dot(link.shape, rest) / link.mass)
    return rest


def _is_closed(mobility: Matrix, own: Matrix) -> bool:
    """Whether the last spring of a numeric model pulls on nothing but ground."""
    return isinstance(mobility, ca.DM) and not float(mobility) > CLOSED * float(own)


def free_end(grounded: Chain) -> Chain:
    """Return the chain without the spring between its last mass and ground."""
    return replace(grounded, stiffness=[*grounded.stiffness[:-1], 0 * grounded.stiffness[-1]])
