# SPDX-License-Identifier: BSD-3-Clause
"""The accuracies at which a Pareto front is sought."""

from __future__ import annotations

import numpy as np

from softimpact.symbolic import InvalidValue
from softimpact.symbolic.rigid import Array

from .study import Study

ROOM = 1.01
"""The stiffest level over the least deflection that can be reached, where there is no choice."""

NO_BOUND = 1e3
"""A deflection [m] that no spring reaches."""


def level_bounds(study: Study, least: float, ideal: float) -> Array:
    """Return bounds on the deflection, evenly spaced on a logarithmic scale, ascending [m].

    The study's own bound is among them if it lies between.

    Args:
        study: whose levels are wanted.
        least: deflection that can be reached [m].
        ideal: deflection of the least force without a bound on it [m].

    Raises:
        InvalidValue: the study asks for levels where there is nothing to find.
    """
    wanted = study.levels
    if wanted.lower is not None and wanted.lower < least:
        raise InvalidValue(
            f"{study.source}: pareto.lower",
            f"no springs and posture give way by less than {least:.4g} m; raise it",
        )
    if wanted.lower is not None and wanted.upper is None and wanted.lower >= ideal:
        raise InvalidValue(
            f"{study.source}: pareto.lower",
            f"the force is least at a deflection of {ideal:.4g} m already; lower it",
        )
    if wanted.upper is not None and wanted.lower is None and wanted.upper < ROOM * least:
        raise InvalidValue(
            f"{study.source}: pareto.upper",
            f"springs and posture give way by {least:.4g} m at least; raise it",
        )
    upper = wanted.upper if wanted.upper is not None else max(ideal, least)
    lower = wanted.lower if wanted.lower is not None else min(ROOM * least, upper)
    bounds = np.geomspace(lower, upper, wanted.points)
    if lower < study.max_deflection < upper:
        bounds = np.append(bounds, study.max_deflection)
    return np.unique(bounds)
