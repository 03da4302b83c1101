# SPDX-License-Identifier: BSD-3-Clause
"""Postures all over a plane."""

from __future__ import annotations

import numpy as np
import pytest

from softimpact.optimize.posture.tip_pose import tip_pose
from softimpact.optimize.posture.workspace import Hold, postures_in_plane
from softimpact.symbolic import ImpactModel, InvalidValue, drives, load_robot

PANDA = load_robot("panda")
MODEL = ImpactModel(PANDA, "hand_tcp", drives(PANDA))
Q = np.array([0, 0.2, 0, -1.8, 0, 2, 0.78])


@pytest.mark.parametrize("hold", ["pose", "position"])
def test_postures_put_the_tip_on_the_grid(hold: Hold) -> None:
    found = postures_in_plane(MODEL, Q, (0, 2), 0.2, hold)
    start, rotation = tip_pose(MODEL, Q)
    lower, upper = PANDA.limits
    assert found.reached.sum() > (10 if hold == "pose" else 30)
    for i, j in np.argwhere(found.reached):
        q = found.q[i, j]
        position, turned = tip_pose(MODEL, q)
        assert np.abs(position - found.place[i, j]).max() < 1e-7
        assert found.place[i, j, [0, 2]] == pytest.approx([found.u[i], found.v[j]])
        assert position[1] == pytest.approx(start[1], abs=1e-7)
        assert hold == "position" or np.abs(turned - rotation).max() < 1e-6
        assert (lower <= q).all()
        assert (q <= upper).all()
    assert np.isclose(found.q, Q).all(axis=2).sum() == 1
    if hold == "pose":  # a free hand reaches farther
        assert (
            found.reached.sum() < postures_in_plane(MODEL, Q, (0, 2), 0.2, "position").reached.sum()
        )


def test_steps_are_checked() -> None:
    with pytest.raises(InvalidValue, match="greater than 0 m"):
        postures_in_plane(MODEL, Q, (0, 2), 0.0)
