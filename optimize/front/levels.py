# SPDX-License-Identifier: BSD-3-Clause
"""The accuracies at which a Pareto front is sought."""

from __future__ import annotations

import numpy as np

from softimpact.symbolic import InvalidValue
from softimpact.symbolic.robot.rigid import Array

from ..study.study import Study

LEAST_ROOM = 1.01
"""The stiffest level over the least deflection that can be reached, where there is no choice."""

SAME_FORCE_SHARE = 1e-6
"""Share of a force that counts as no difference."""

NO_BOUND = 1e3
"""A deflection [m] that no spring reaches."""


def level_range(study: Study, least: float, ideal: float) -> tuple[float, float]:
    """Return the smallest and the largest bound on the deflection [m].

    Args:
        study: whose levels are wanted.
        least: deflection that can be reached [m].
        ideal: deflection of the least force without a bound on it [m].

    Raises:
        InvalidValue: the study asks for levels where there is nothing to find.
    """
    wanted, ideal = study.levels, max(ideal, least)
    if wanted.lower is not None and wanted.lower < least:
        raise InvalidValue(
            f"{study.source}: pareto.lower",
            f"springs and posture give way by {least:.4g} m at least; raise it",
        )
    if wanted.lower is not None and wanted.upper is None and wanted.lower >= ideal:
        raise InvalidValue(
            f"{study.source}: pareto.lower",
            f"the force is least at a deflection of {ideal:.4g} m already; lower it",
        )
    if wanted.upper is not None and wanted.upper < LEAST_ROOM * least:
        raise InvalidValue(
            f"{study.source}: pareto.upper",
            f"springs and posture give way by {least:.4g} m at least; raise it",
        )
    upper = ideal if wanted.upper is None else wanted.upper
    return min(LEAST_ROOM * least, upper) if wanted.lower is None else wanted.lower, upper


def even_bounds(bounds: Array, forces: Array) -> Array:
    """Return as many bounds [m], evenly spaced along a first front.

    Length along it counts the logarithm of the bound and the force, each from 0 to 1.

    Args:
        bounds: on the deflection, ascending [m].
        forces: found with them [N]; NaN where nothing was.
    """
    known = np.isfinite(forces)
    if bounds[0] >= bounds[-1] or not known.any():
        return bounds
    x = np.log(bounds / bounds[0]) / np.log(bounds[-1] / bounds[0])
    y = np.minimum.accumulate(np.interp(x, x[known], forces[known]))
    y /= max(float(y[0] - y[-1]), SAME_FORCE_SHARE * float(y[0]))
    arc = np.concatenate([[0.0], np.cumsum(np.hypot(np.diff(x), np.diff(y)))])
    places = np.interp(np.linspace(0.0, arc[-1], bounds.size), arc, np.log(bounds))
    return np.concatenate([bounds[:1], np.exp(places[1:-1]), bounds[-1:]])
