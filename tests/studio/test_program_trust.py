# SPDX-License-Identifier: BSD-3-Clause
"""The worst moments of a program are looked at by the nonlinear robot, too."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import run
from impact_cases import CHEST

from softimpact.simulate import simulate_impact
from softimpact.simulate.trust import TRUSTED
from softimpact.simulate.zones import Somebody
from softimpact.studio.program.moments import Question, approach_at
from softimpact.studio.program.table import Names, ProgramTable
from softimpact.studio.program.trust import nonlinear_share
from softimpact.symbolic import (
    Motors,
    Robot,
    approach_velocity,
    drives,
    impact_model,
    unit_direction,
)

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
    share, (seen,), (line,) = nonlinear_share(question, [fast])
    assert seen["linear_error"] > TRUSTED
    assert "says the nonlinear robot" in line
    assert 0.1 < share < 1
    # at that share of its speed the nonlinear robot just keeps the limit
    history = simulate_impact(
        question.model,
        approach_at(question, fast, share * fast["speed"]),
        CHEST,
        "full",
        motors=question.ends["free"],
        horizon=question.horizon,
    )
    limit = question.bodies[0].limits.transient.force
    assert history.peak == pytest.approx(limit, rel=1e-3)
    question, slow = moment(panda, 2.5, 0.1)
    share, (seen,), lines = nonlinear_share(question, [slow])
    assert share == 1.0
    assert not lines
    assert 0 < seen["linear_error"] < TRUSTED


def table_of(share: list[float], factor: list[float]) -> ProgramTable:
    names = Names(("tip",), ("chest",), ("free",))
    table = ProgramTable.empty(names, np.arange(float(len(share))))
    table.share[:], table.factor[:] = share, factor
    table.speed[:] = 2.0
    table.safe_speed[:] = np.where(table.factor < 1, 2 * table.factor, np.inf)
    table.two_body[:-1] = 0.7  # nothing moves at the last
    return table


def test_a_table_is_lowered_wherever_a_limit_may_be_passed() -> None:
    table = table_of([1.6, 0.95, 0.5, np.nan, -np.inf, -np.inf], [0.6, 1, 1, 1, 1, 1])
    table.lower(0.9)
    assert table.factor == pytest.approx([0.54, 0.9, 1, 0.9, 0.9, 1])
    assert table.safe_speed[:2] == pytest.approx([1.08, 1.8])


@pytest.mark.slow
def test_a_program_keeps_what_the_nonlinear_robot_keeps(tmp_path: Path, panda: Robot) -> None:
    """A pose in which the linear model errs most, of sixty by chance."""
    model = impact_model(panda, drives=drives(panda, 613.0, 0.3))
    pose = np.array([0.21, -0.17, 2.65, -0.21, 1.72, 2.51, 2.0])
    rate = approach_velocity(model, pose, unit_direction([0.28, 0.17, -0.94]))
    time = np.linspace(0, 0.02, 5)
    q = pose + np.outer(time - 0.01, rate)
    header = ",".join(("t", *panda.joint_names))
    motion = tmp_path / "motion.csv"
    np.savetxt(motion, np.column_stack([time, q]), delimiter=",", header=header, comments="")
    options = ("--model", "panda", "--points", panda.tip, "--regions", "back", "--free")
    springs = ("--joint-stiffness", "613", "--rotor-inertia", "0.3", "--motors", "free")
    result = run("program", motion, *options, *springs, "--horizon", "0.1", "--json")
    found = json.loads(result.out)
    (line,) = (line for line in found["warnings"] if "all factors were lowered" in line)
    assert line in result.err.replace("\n", " ")
    assert max(found["factor"]) < 1
    for worst in found["worst"]:
        assert worst["factor"] == found["factor"][worst["sample"]]
        assert worst["safe_speed"] == pytest.approx(worst["factor"] * worst["speed"])
