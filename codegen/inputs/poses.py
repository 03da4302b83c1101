# SPDX-License-Identifier: BSD-3-Clause
"""Candidate poses of a package, checked and rounded so that they are the same on any machine."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from softimpact.symbolic import InvalidValue, Robot

DIGITS = 6
"""Decimals of a coordinate [rad, m]: more than any robot repeats."""


def checked_poses(
    robot: Robot, poses: Mapping[str, Sequence[float]]
) -> dict[str, tuple[float, ...]]:
    """Return poses rounded to ``DIGITS``, in the order given.

    Raises:
        InvalidValue: a pose of the wrong length, with a number that is not finite, or beyond the
            limits of a joint.
    """
    lower, upper = robot.limits
    checked = {}
    for name, q in poses.items():
        values = np.round(np.asarray(q, dtype=float), DIGITS)
        if values.shape != (robot.n,) or not np.isfinite(values).all():
            raise InvalidValue(f"poses.{name}", f"needs {robot.n} finite numbers")
        beyond = np.flatnonzero((values < lower) | (values > upper))
        if beyond.size:
            joint = robot.joints[beyond[0]].name
            raise InvalidValue(f"poses.{name}", f"joint '{joint}' is beyond its limits")
        checked[name] = tuple(values.tolist())
    return checked
