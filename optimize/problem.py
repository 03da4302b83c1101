# SPDX-License-Identifier: BSD-3-Clause
"""A study made ready to search: candidate postures, time steps, compiled impacts and bounds."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from softimpact.symbolic.robot.rigid import Array

from .impact_program import ImpactProgram, impact_numbers, impact_program
from .nlp import POSE, Program, task_function, task_numbers
from .poses import Candidate, candidates, leaves_a_choice, tip_pose
from .solve import Bounds, Instance, Mode, one_posture
from .study import Study
from .timing import Timing, impact_timing


@dataclass(frozen=True, eq=False)
class Problem:
    """What all searches of a study share.

    Attributes:
        study: what was asked.
        poses: its candidates as they serve the task.
        before: peak force of each with the nominal stiffness [N].
        timing: of the impacts simulated.
        program: the NLP's functions, also for worker processes.
        bounds: on the variables.
    """

    study: Study
    poses: tuple[Candidate, ...]
    before: tuple[float, ...]
    timing: Timing
    program: Program
    bounds: Bounds

    @property
    def freest(self) -> Mode:
        """The mode that leaves most free."""
        return "free" if leaves_a_choice(self.study) else "table"

    def numbers(self, max_deflection: float | None = None) -> Instance:
        """Return the NLP of one posture, with another bound on the deflection [m] if given."""
        study = self.study
        if max_deflection is not None:
            study = replace(study, max_deflection=max_deflection)
        task = task_numbers(study, *tip_pose(study.model, study.task_pose.q))
        impacts = study_impacts(study, self.timing.step)
        unit = float(np.median(self.before))
        shape = one_posture(study.groups, len(impacts))
        return Instance(shape, task[None, :], impacts, np.full(len(impacts), unit))


def prepare(study: Study) -> Problem:
    """Place a study's poses, time its impacts, and build and compile its NLP.

    Raises:
        InvalidValue: as ``candidates`` and ``impact_timing``.
    """
    poses = tuple(candidates(study))
    timing = impact_timing(study, [pose.q for pose in poses])
    impact = impact_program(study.model, timing.nodes, timing.substeps, compiled=True)
    before = tuple(peak_force(study, impact, timing, pose.q, study.nominal) for pose in poses)
    bounds = Bounds(*study.robot.limits, study.lower, study.upper)
    program = study_program(study, (impact,))
    return Problem(study, poses, before, timing, program, bounds)


def study_program(study: Study, impacts: tuple[ImpactProgram, ...]) -> Program:
    """Return the functions of a study's NLPs."""
    wrenches = len(study.forces)
    task = task_function(study.model, wrenches)
    return Program(impacts, task.serialize(), study.robot.n, POSE + wrenches, task.numel_in(1))


def study_impacts(study: Study, step: float) -> Array:
    """Return the numbers of a study's own impact, a row for each end of what motors may do."""
    return np.array(
        [
            impact_numbers(study.direction, study.speed, study.contact, motors, step)
            for motors in study.motors
        ]
    )


def peak_force(
    study: Study, program: ImpactProgram, timing: Timing, q: Array, springs: Array
) -> float:
    """Return the largest peak force [N] over what the motors may do, as the NLP sees it."""
    x = np.concatenate([q, np.log10(springs)])
    rows = study_impacts(study, timing.step)
    return float(max(np.array(program["peaks"](x, row, 0)).max() for row in rows))
