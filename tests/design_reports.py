# SPDX-License-Identifier: BSD-3-Clause
"""Design reports to draw and to print: a real one, and one made by hand for another robot."""

from __future__ import annotations

from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import numpy as np
from oracles import example_urdf

from softimpact.optimize import Design, Outcome, PoseResult, Study, design, load_study
from softimpact.optimize.co_design import Answers, DesignReference
from softimpact.optimize.impact.timing import Timing
from softimpact.optimize.study.poses import Candidate, candidates
from softimpact.studio.design.report import DesignReport, design_report

PANDA = """
title = "three poses of the Panda"
[robot]
model = "panda"
rotor_inertia = "drake_fr3"
[impact]
region = "chest"
direction = [0.0, 1.0, 0.0]
speed = 1.0
[stiffness]
lower = 300.0
upper = 100000.0
nominal = 15000.0
[accuracy]
forces = [[30.0, 0.0, 0.0]]
max_deflection = 0.001
[task]
pose_of = "q9"
[[poses]]
name = "q9"
q = [-1.22, 0.84, 0.72, -2.41, 0.79, 1.97, -2.04]
[[poses]]
name = "q19"
q = [-0.35, 0.64, -0.07, -2.36, 1.18, 1.51, -2.29]
recovered = true
[[poses]]
name = "q22"
q = [0.00, 0.63, -0.10, -2.36, 1.19, 1.50, -2.29]
"""

UR5 = """
[robot]
model = "{urdf}"
tip = "tool0"
rotor_inertia = 0.5
[impact]
region = "hand"
clamped = false
direction = [0.0, 0.6, 0.8]
speed = 0.5
[stiffness]
lower = 300.0
upper = [1e4, 2e4, 3e4, 4e4, 5e4, 6e4]
nominal = 5000.0
[accuracy]
forces = [[20.0, 0.0, 0.0]]
max_deflection = 0.003
[task]
pose_of = "up"
exact = false
[[poses]]
name = "up"
q = [0.3, -1.1, 1.4, -0.6, 1.2, 0.4]
[[poses]]
name = "low"
q = [0.3, -0.4, 1.2, -0.9, 1.2, 0.4]
"""


def panda_report(folder: Path) -> DesignReport:
    """Return a design by Ipopt, in this process."""
    study = _study(folder, PANDA)
    with ThreadPoolExecutor(1) as executor:
        return design_report(design(study, executor=executor))


def ur5_report(folder: Path) -> DesignReport:
    """Return what a design in table mode alone might find."""
    urdf = example_urdf("ur5_robot.urdf").as_posix()
    study = _study(folder, UR5.format(urdf=urdf))
    poses = tuple(
        PoseResult(candidate, 90.0 + i, 1e-3, _found(candidate, study, 70.0 + i), None)
        for i, candidate in enumerate(candidates(study))
    )
    winner = poses[0].table
    assert winner is not None
    timing = Timing(duration=0.04, nodes=200, substeps=2)
    reference = DesignReference(study.nominal, 90.0, 1e-3)
    ranges = np.column_stack([study.lower, study.upper])
    answers = Answers(1e-3, ranges, (), study.motors[0], reference)
    return design_report(Design(study, poses, winner, None, answers, timing, compiled=False))


def _study(folder: Path, text: str) -> Study:
    path = folder / "study.toml"
    path.write_text(text, encoding="utf-8")
    return load_study(path)


def _found(candidate: Candidate, study: Study, force: float) -> Outcome:
    return Outcome(
        name=candidate.pose.name,
        mode="table",
        status="Solve_Succeeded",
        solved=True,
        iterations=1,
        attempts=1,
        seconds=0.0,
        q=candidate.q,
        springs=study.nominal * np.linspace(0.2, 1.5, study.robot.n),
        force=force,
        violation=0.0,
    )
