# SPDX-License-Identifier: BSD-3-Clause
"""A study made ready to search: candidate postures, time steps, compiled impacts and bounds."""

from __future__ import annotations

from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from softimpact.symbolic import InvalidValue, Matrix
from softimpact.symbolic.robot.rigid import Array

from ..evaluation import equipped
from ..impact.impact_program import PARTS, ImpactProgram, Parts, impact_program
from ..impact.timing import Timing, impact_timing, study_impacts
from ..machine.postures import side_function
from ..objectives import WorstForce
from ..posture.tip_pose import posture_equations, tip_pose
from ..study.poses import Candidate, candidates, leaves_a_choice
from ..study.study import Study
from .ipopt import Instance, VariableBounds, one_posture
from .nlp import Program, hardware_function, task_function, task_numbers
from .solve import Mode


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
    bounds: VariableBounds

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
        if study.objective.scales_speed:
            unit = study.limit
        shape = one_posture(len(impacts), study.objective)
        return Instance(shape, task[None, :], impacts, np.full(len(impacts), unit))


def prepare(study: Study, *, elsewhere: bool = False) -> Problem:
    """Place a study's poses, time its impacts, and build and compile its NLP.

    With ``elsewhere`` its functions run on other machines, too.

    Raises:
        InvalidValue: as ``candidates`` and ``impact_timing``.
    """
    _require_forces_alone(study)
    poses = tuple(candidates(study))
    timing = impact_timing(study, [pose.q for pose in poses])
    parts = sought_parts(study)
    impact = impact_program(
        study.model,
        timing.nodes,
        timing.substeps,
        parts=parts,
        compiled=True,
        elsewhere=elsewhere,
    )
    program = study_program(study, (impact,))
    before = tuple(peak_force(study, impact, timing, pose.q, study.nominal) for pose in poses)
    return Problem(study, poses, before, timing, program, VariableBounds.of(study))


def _require_forces_alone(study: Study) -> None:
    """Refuse what only a design for scenarios can do: nothing of a study is left out in silence."""
    tables = [f"hardware.{variable.kind}" for variable in study.other_variables]
    if study.catalogue:
        tables.append("hardware.catalogue")
    if study.objective.kind != WorstForce.kind:
        tables.append("objective")
    if tables:
        raise InvalidValue(
            f"{study.source}: {tables[0]}",
            "needs 'softimpact design' and a table [scenarios], which may be empty; poses by "
            "themselves and fronts have springs and forces alone",
        )


def sought_parts(study: Study) -> Parts:
    """Return what a study's variables and objective change of what an impact feels."""
    moved = {part for variable in study.variables for part in variable.moves}
    if study.objective.scales_speed:
        moved.add("speed")
    return tuple(part for part in PARTS if part in moved)


def study_program(study: Study, impacts: tuple[ImpactProgram, ...]) -> Program:
    """Return the functions of a study's NLPs."""
    (task, each), hardware = task_function(study), hardware_function(study, impacts[0].parts)
    variables = study.range.lower.size
    rows, size = task.numel_out(0), task.numel_in(1)
    serialised = task.serialize(), hardware.serialize()
    held = posture_equations(study.model)
    side = side_function(study.model)
    of_loops = "" if side is None else side.serialize()
    squares = tuple(
        bound.sense == "most"
        for bound, count in zip(study.bounds, each, strict=True)
        for _ in range(count)
    )
    return Program(
        impacts, *serialised, study.robot.n, variables, each, squares, rows, size, held, of_loops
    )


def felt_numbers(
    study: Study, parts: Parts, springs: Array, others: Array | None = None, speed: float = 1.0
) -> Array:
    """Return log10 of the parts that impacts feel.

    Args:
        study: whose variables they are.
        parts: that are sought.
        springs: stiffness of each spring [N·m/rad].
        others: values of the other variables; default the machine as it is.
        speed: factor on the speed.
    """
    if parts == ("springs",):
        return np.log10(springs)
    hardware = equipped(study, ca.DM(springs), others)
    felt: dict[str, Matrix] = {
        "springs": springs,
        "rotors": hardware.reflected_rotors,
        "masses": hardware.masses,
        "cover": hardware.cover,
        "beside": hardware.beside,
        "speed": speed,
    }
    return np.concatenate([np.log10(np.array(felt[part], dtype=float)).ravel() for part in parts])


def peak_force(
    study: Study,
    program: ImpactProgram,
    timing: Timing,
    q: Array,
    springs: Array,
    others: Array | None = None,
) -> float:
    """Return the largest peak force [N] over what the motors may do, as the NLP sees it."""
    x = np.concatenate([q, felt_numbers(study, program.parts, springs, others)])
    rows = study_impacts(study, timing.step)
    return float(max(np.array(program["peaks"](x, row, 0)).max() for row in rows))
