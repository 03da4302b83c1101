# SPDX-License-Identifier: BSD-3-Clause
"""Many impacts of a linear robot at once, in NumPy."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike

from softimpact.symbolic import Contact, ImpactModel, Motors, generalised_velocity

from .arrival import Approach, arrival_of
from .history import HORIZON, PRESSED_UNTIL
from .linear import given_motion, linear_system, modes
from .stepping import Bodies, LargestForces, ManyPeaks, SteppedStage, at_first_touch, faster, slower


def many_peaks(
    model: ImpactModel,
    approach: Approach,
    contact: Contact,
    speeds: ArrayLike,
    *,
    motors: Motors | None = None,
    horizon: float = HORIZON,
) -> ManyPeaks:
    """Return the peaks of one robot's linearised impacts at many speeds.

    Args:
        model: the robot.
        approach: how it arrives, but for the speed.
        contact: what it hits.
        speeds: of the approach [m/s], any number.
        motors: as in ``simulate_impact``.
        horizon: up to which the largest force counts [s].
    """
    arrival = arrival_of(model, approach)
    what = motors or Motors("servo" if model.drives.has_gains else "free")
    v = np.atleast_1d(np.asarray(speeds, dtype=float))
    before = generalised_velocity(model, arrival.link_velocity)
    until = max(horizon, PRESSED_UNTIL) if contact.clamped else horizon
    largest = LargestForces(len(v), horizon, contact.clamped)
    bodies = Bodies.of([contact.region], contact.clamped, contact.law)
    state = at_first_touch(len(v), model.size, bodies)
    ends = [begin for begin, _ in what.laws[1:]] + [until]
    for (begin, law), end in zip(what.laws, ends, strict=True):
        if min(end, until) <= begin:
            continue
        system = linear_system(model, arrival, law)
        found = modes(system)
        stage = SteppedStage.of(system, found, bodies, np.array(begin), np.array(min(end, until)))
        given = given_motion(
            system, found, law, slower(state.motion, v), before, begin, what.stopping_time
        )
        state = stage.run(*faster(*given, v), state, largest)
    return largest.found
