# SPDX-License-Identifier: BSD-3-Clause
"""The joint stiffness up to which an impact's first peak stays alone."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from softimpact.symbolic import Contact, ImpactModel, InvalidValue
from softimpact.symbolic.chain import ChainEnd

from .approach import Approach
from .controller import Controller
from .history import Fidelity, ImpactHistory
from .impact import simulate_impact

Case = tuple[ImpactModel, Approach]

STEP = 10**0.125
"""Ratio of the stiffnesses at which the search for a second peak looks."""


def is_isolated(history: ImpactHistory) -> bool:
    """Whether the first contact ends before the force rises again: it has one peak.

    Neither force nor time has a scale in this: the contact is lost between two peaks or it is not.
    """
    end = np.inf if history.separation is None else history.separation
    force = history.force[history.time < end]
    changes = np.sign(np.diff(force))
    peaks = np.count_nonzero((changes[:-1] > 0) & (changes[1:] <= 0))
    return history.separation is not None and peaks == 1


def decoupling_stiffness(
    case: Callable[[float], Case],
    contact: Contact,
    between: tuple[float, float],
    fidelity: Fidelity = "full",
    *,
    order: int = 3,
    end: ChainEnd | None = None,
    controller: Controller | None = None,
    accuracy: float = 1e-4,
) -> float | None:
    """Return the largest k_s up to which the first peak stays isolated; None if it always does.

    Links and motors then hit one after the other, and to make the springs softer does not make
    the first peak lower (MSM §3.2.4). Searched from the soft end: a stiff robot has a single peak
    again, but one with the motors in it.

    Args:
        case: robot and approach for a k_s; ``scaled_springs`` makes one from any robot.
        contact: with the body.
        between: the softest and the stiffest k_s.
        fidelity: as in ``simulate_impact``.
        order: as in ``simulate_impact``.
        end: as in ``simulate_impact``.
        controller: as in ``simulate_impact``.
        accuracy: relative, of the k_s found.

    Raises:
        InvalidValue: no range, or the first peak is not isolated at its soft end.
    """
    softest, stiffest = between
    if not 0 < softest < stiffest < np.inf:
        raise InvalidValue("between", "needs two finite stiffnesses, 0 < softest < stiffest")

    def isolated(stiffness: float) -> bool:
        model, approach = case(stiffness)
        history = simulate_impact(
            model, approach, contact, fidelity, order=order, end=end, controller=controller
        )
        return is_isolated(history)

    if not isolated(softest):
        raise InvalidValue("between", f"the peaks are one at {softest:g} already; start softer")
    soft = softest
    while soft < stiffest:
        stiff = min(soft * STEP, stiffest)
        if not isolated(stiff):
            return _boundary(isolated, soft, stiff, accuracy)
        soft = stiff
    return None


def _boundary(isolated: Callable[[float], bool], soft: float, stiff: float, share: float) -> float:
    while stiff > soft * (1 + share):
        middle = float(np.sqrt(soft * stiff))
        soft, stiff = (middle, stiff) if isolated(middle) else (soft, middle)
    return soft


def scaled_springs(model: ImpactModel, factor: float) -> ImpactModel:
    """Return the robot with all its joint springs, drives' and file's, ``factor`` as stiff."""
    if not 0 < factor < np.inf:
        raise InvalidValue("factor", f"must be finite and greater than 0, not {factor}")
    joints = tuple(replace(j, stiffness=factor * j.stiffness) for j in model.robot.joints)
    stiffer = model.with_springs(factor * model.drives.springs)
    return replace(stiffer, robot=replace(model.robot, joints=joints))
