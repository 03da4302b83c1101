# SPDX-License-Identifier: BSD-3-Clause
"""Springs in given proportions that are just stiff enough for a study's bounds."""

from __future__ import annotations

import numpy as np

from softimpact.symbolic.robot.rigid import Array

from ..evaluation import largest_deflection, largest_share
from ..solver_options import FEASIBLE
from ..study.study import Study

ENOUGH = 1e-3
"""Share of a bound that springs in proportion may leave free."""


def accurate_springs(study: Study, q: Array, springs: Array) -> Array:
    """Return the softest springs, in the given proportions, that meet the deflection bound.

    Where they break a bound that stiffer ones keep, such as one on a frequency, they are just stiff
    enough for that. Joints that reach a bound of their stiffness stay there; if the upper
    bounds are too soft, the springs come as near as they can.

    Args:
        study: whose forces and bounds count.
        q: posture, length n, or postures in each of which they do, m×n [rad].
        springs: proportions of the stiffness, one for each spring [N·m/rad].
    """
    scaled = np.clip(springs, study.lower, study.upper)
    for _ in range(4 * len(study.groups)):
        share = largest_deflection(study, q, scaled) / study.max_deflection
        if 1 - ENOUGH < share <= 1 + FEASIBLE:
            break
        scaled = np.clip(scaled * share, study.lower, study.upper)
    return _stiffened(study, q, scaled)


def _stiffened(study: Study, q: Array, springs: Array) -> Array:
    """Return springs times the least factor with which they keep all bounds; as given if none."""

    def times(logarithm: float) -> Array:
        return np.asarray(np.clip(springs * np.exp(logarithm), study.lower, study.upper))

    def keeps(logarithm: float) -> bool:
        return largest_share(study, q, times(logarithm)) <= 1 + FEASIBLE

    low, high = 0.0, float(np.log(np.max(study.upper / springs)))
    if keeps(low) or not keeps(high):
        return springs
    while high - low > ENOUGH:
        middle = (low + high) / 2
        low, high = (low, middle) if keeps(middle) else (middle, high)
    return times(high)
