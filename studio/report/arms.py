# SPDX-License-Identifier: BSD-3-Clause
"""Arms as stick figures for reports."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from softimpact.symbolic import Robot
from softimpact.symbolic.robot.rigid import Array

from ..figures.postures import stick_points
from .page import ArmPicture, Hit

ORIGIN = np.zeros(3)
"""Place of a hit until its frame says it."""


def arm_picture(
    robot: Robot, q: Array, hits: Mapping[str, Hit], words: str, faint: Sequence[Array] = ()
) -> ArmPicture:
    """Return an arm in a posture, hit at some of its frames.

    Args:
        robot: the arm.
        q: its posture.
        hits: by the frame that is hit, which says their place.
        words: what the picture shows.
        faint: postures behind.
    """
    first = next(iter(hits), robot.tip or "")
    deepest = max(range(robot.n), key=lambda i: len(robot.ancestors(i)))
    ends = [f.name for f in robot.frames.values() if f.joint == deepest]
    whole = first if robot.frame(first).joint == deepest or not ends else ends[-1]
    arm, *behind = stick_points(robot, whole, [q, *faint])
    placed = [
        replace(hit, place=np.round(stick_points(robot, frame, [q])[0][:, -1], 4))
        for frame, hit in hits.items()
    ]
    return ArmPicture(np.round(arm.T, 4), placed, words, [np.round(b.T, 4) for b in behind])
