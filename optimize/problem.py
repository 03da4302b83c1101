# SPDX-License-Identifier: BSD-3-Clause
"""A study made ready to search: candidate postures, time steps, compiled NLP and bounds."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from softimpact.symbolic.robot.rigid import Array

from .compiled import c_compiler, compiled_nlp
from .nlp import DesignNlp, build_nlp, parameters
from .poses import Candidate, candidates, leaves_a_choice, tip_pose
from .solve import Bounds, Mode, Program, nlp_solver
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
        nlp: the program's functions.
        program: the same for worker processes.
        bounds: on the variables.
    """

    study: Study
    poses: tuple[Candidate, ...]
    before: tuple[float, ...]
    timing: Timing
    nlp: DesignNlp
    program: Program
    bounds: Bounds

    @property
    def freest(self) -> Mode:
        """The mode that leaves most free."""
        return "free" if leaves_a_choice(self.study) else "table"

    def numbers(self, max_deflection: float | None = None) -> Array:
        """Return the NLP's parameters, with another bound on the deflection [m] if one is given."""
        study = self.study
        if max_deflection is not None:
            study = replace(study, max_deflection=max_deflection)
        position, rotation = tip_pose(study.model, study.task_pose.q)
        return parameters(study, position, rotation, self.timing.step, self.bounds.unit)


def prepare(study: Study) -> Problem:
    """Place a study's poses, time its impacts, and build and compile its NLP.

    Raises:
        InvalidValue: as ``candidates`` and ``impact_timing``.
    """
    poses = tuple(candidates(study))
    timing = impact_timing(study, [pose.q for pose in poses])
    nlp = build_nlp(study.model, len(study.forces), timing.nodes, timing.substeps)
    before = tuple(peak_force(study, nlp, timing, pose.q, study.nominal) for pose in poses)
    bounds = Bounds(*study.robot.limits, study.lower, study.upper, float(np.median(before)))
    library = compiled_nlp(nlp_solver(nlp.oracle), c_compiler())
    program = Program(nlp.oracle.serialize(), library, nlp.n, nlp.pose, nlp.forces)
    return Problem(study, poses, before, timing, nlp, program, bounds)


def peak_force(study: Study, nlp: DesignNlp, timing: Timing, q: Array, springs: Array) -> float:
    """Return the peak of the first contact [N] as the NLP sees it."""
    x = np.concatenate([q, np.log10(springs), [0.0]])
    numbers = parameters(study, np.zeros(3), np.eye(3), timing.step, 1.0)
    return float(np.array(nlp.oracle(x, numbers)[1])[nlp.forces].max())
