# SPDX-License-Identifier: BSD-3-Clause
"""The worst moments of a program are looked at by the nonlinear robot, too."""

from __future__ import annotations

from typing import Any

import numpy as np
from impact_cases import CHEST

from softimpact.simulate.trust import TRUSTED
from softimpact.simulate.zones import Somebody
from softimpact.studio.program_run import Question
from softimpact.studio.program_trust import doubts
from softimpact.symbolic import Motors, Robot, approach_velocity, drives, impact_model

NEARLY_STRETCHED = np.array([-0.15, 0.67, 0.06, -0.45, -0.05, 1.2, 0.19])


def moment(panda: Robot, speed: float, factor: float) -> tuple[Question, dict[str, Any]]:
    """A push along the stretched arm, in which the joints are fast."""
    model = impact_model(panda, drives=drives(panda, 3e3, 0.3))
    direction = np.array([-0.44, 0.18, -0.88]) / np.linalg.norm([0.44, 0.18, 0.88])
    rate = approach_velocity(model, NEARLY_STRETCHED, direction)
    question = Question(
        model, [model.tip], [Somebody(CHEST)], {"free": Motors("free")}, 0.1, payload=0.0
    )
    found = {"t": 1.0, "point": model.tip, "body": 0, "motors": "free", "factor": factor}
    found |= {"speed": speed, "direction": direction, "joint_velocity": speed * rate}
    return question, found | {"q": NEARLY_STRETCHED}


def test_what_the_nonlinear_robot_says_of_a_moment(panda: Robot) -> None:
    question, fast = moment(panda, 2.5, 1.0)
    (seen,), (line,) = doubts(question, [fast])
    assert seen["linear_error"] > TRUSTED
    assert line.startswith(f"at 1 s '{question.model.tip}' is beyond its limit by ")
    assert line.endswith("factors near there are too high by as much")
    question, slow = moment(panda, 2.5, 0.1)
    (seen,), lines = doubts(question, [slow])
    assert not lines
    assert 0 < seen["linear_error"] < TRUSTED
