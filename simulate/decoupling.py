# SPDX-License-Identifier: BSD-3-Clause
"""The joint stiffness up to which an impact's first peak stays alone."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from itertools import pairwise

import numpy as np

from softimpact.symbolic import Contact, ImpactModel, InvalidValue, Motors
from softimpact.symbolic.impact.chain import ChainEnd

from .arrival import Approach
from .controller import Controller
from .history import Fidelity, ImpactHistory
from .impact import simulate_impact

ModelAndApproach = tuple[ImpactModel, Approach]

STEP = 10**0.125
"""Ratio of the stiffnesses at which the search looks."""

CHANGE = 0.05
"""Relative change of the first peak from one of these to the next in which a jump may hide."""

JUMP = 0.01
"""Relative change of the first peak, at one stiffness, that counts as a jump."""


@dataclass(frozen=True)
class Decoupling:
    """Up to which k_s links and motors hit one after the other; None: over the whole range.

    Attributes:
        isolated: the contact is lost after the first peak.
        distinct: the first peak, if not isolated, is a maximum of its own; above, it has merged
            with the next one and the first peak's force has jumped.
    """

    isolated: float | None
    distinct: float | None


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
    case: Callable[[float], ModelAndApproach],
    contact: Contact,
    between: tuple[float, float],
    fidelity: Fidelity = "full",
    *,
    order: int = 3,
    end: ChainEnd | None = None,
    motors: Motors | Controller | None = None,
    accuracy: float = 1e-4,
) -> Decoupling:
    """Return the largest joint stiffness that decouples the links from the motors (MSM §3.2.4).

    To make the springs softer than that does not make the first peak lower. Searched from the
    soft end, in steps of a third: a stiff robot has a single peak again, with the motors in it.

    Args:
        case: robot and approach for a k_s; ``scaled_springs`` makes one from any robot.
        contact: with the body.
        between: the softest and the stiffest k_s.
        fidelity: as in ``simulate_impact``.
        order: as in ``simulate_impact``.
        end: as in ``simulate_impact``.
        motors: as in ``simulate_impact``.
        accuracy: relative, of the k_s found, from 1e-12 to 1.

    Raises:
        InvalidValue: no range, another accuracy, or the first peak is not isolated at its soft end.
    """
    softest, stiffest = between
    if not 0 < softest < stiffest < np.inf:
        raise InvalidValue("between", "needs two finite stiffnesses, 0 < softest < stiffest")
    if not 1e-12 <= accuracy <= 1:
        raise InvalidValue("accuracy", f"must be from 1e-12 to 1, not {accuracy:g}")

    @cache
    def impact(stiffness: float) -> ImpactHistory:
        model, approach = case(stiffness)
        return simulate_impact(
            model,
            approach,
            contact,
            fidelity,
            order=order,
            end=end,
            motors=motors,
            horizon=None,
        )

    def isolated(stiffness: float) -> bool:
        return is_isolated(impact(stiffness))

    def first_peak(stiffness: float) -> float:
        return float(np.log(impact(stiffness).force_of("first_peak")))

    steps = int(np.ceil(np.log(stiffest / softest) / np.log(STEP)))
    grid = [float(k) for k in np.geomspace(softest, stiffest, steps + 1)]
    if not isolated(softest):
        raise InvalidValue("between", f"the peaks are one at {softest:g} already; start softer")
    lost = (
        _boundary(isolated, *pair, accuracy) for pair in pairwise(grid) if not isolated(pair[1])
    )
    jumps = (
        _jump(first_peak, *pair, accuracy)
        for pair in pairwise(grid)
        if abs(first_peak(pair[1]) - first_peak(pair[0])) > CHANGE
    )
    return Decoupling(next(lost, None), next((k for k in jumps if k is not None), None))


def _boundary(isolated: Callable[[float], bool], soft: float, stiff: float, share: float) -> float:
    while stiff > soft * (1 + share):
        middle = float(np.sqrt(soft * stiff))
        soft, stiff = (middle, stiff) if isolated(middle) else (soft, middle)
    return soft


def _jump(peak: Callable[[float], float], soft: float, stiff: float, share: float) -> float | None:
    """Follow the steeper half; what is still steep at the end is a jump."""
    while stiff > soft * (1 + share):
        middle = float(np.sqrt(soft * stiff))
        below, above = abs(peak(middle) - peak(soft)), abs(peak(stiff) - peak(middle))
        soft, stiff = (soft, middle) if below > above else (middle, stiff)
        if max(below, above) < JUMP:
            return None
    return soft


def scaled_springs(model: ImpactModel, factor: float) -> ImpactModel:
    """Return the robot with all its joint springs, drives' and file's, ``factor`` as stiff."""
    if not 0 < factor < np.inf:
        raise InvalidValue("factor", f"must be finite and greater than 0, not {factor}")
    joints = tuple(replace(j, stiffness=factor * j.stiffness) for j in model.robot.joints)
    stiffer = model.with_springs(factor * model.drives.springs)
    return replace(stiffer, robot=replace(model.robot, joints=joints))
