# SPDX-License-Identifier: BSD-3-Clause
"""All numbers of a factor study."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from softimpact.optimize import Candidate, Study, candidates
from softimpact.optimize.posture.self_motion import SelfMotion, self_motion
from softimpact.optimize.posture.tip_pose import tip_pose
from softimpact.symbolic import InvalidValue
from softimpact.symbolic.robot.rigid import Array

from .agreement import Agreement, agreements
from .functions import factor_functions
from .heavy_base import HeavyBase, on_heavy_base
from .poses import PoseFactors, pose_factors
from .redundancy import AlongSelfMotion, along_self_motion

TipAndRotors = tuple[str, str]
"""A tip and a set of rotor inertias, by name."""


@dataclass(frozen=True, eq=False)
class FactorStudy:
    """Impact factors of a study's poses.

    Attributes:
        study: robot, impact and poses.
        names: of the poses, length P.
        poses: link angles that hold the task, P×n [rad].
        rotor_sets: reflected rotor inertias by name [kg m²].
        tips: contact frames.
        factors: of every case.
        curve: the self-motion that all poses lie on.
        along: figures along it, for every case.
        heavy_base: on floating bases, study's tip, by rotor set.
        agreements: of factors and forces with the study's own tip and rotors.
    """

    study: Study
    names: tuple[str, ...]
    poses: Array
    rotor_sets: Mapping[str, Array]
    tips: tuple[str, ...]
    factors: Mapping[TipAndRotors, PoseFactors]
    curve: SelfMotion
    along: Mapping[TipAndRotors, AlongSelfMotion]
    heavy_base: Mapping[str, HeavyBase]
    agreements: Sequence[Agreement]


def factor_study(
    study: Study, tips: Sequence[str] = (), tell: Callable[[str], None] | None = None
) -> FactorStudy:
    """Compute all numbers of a factor study.

    Args:
        study: whose poses are examined; its robot needs one joint more than its task.
        tips: contact frames; default the study's own.
        tell: called with what is being done.

    Raises:
        FrameNotFound: the robot has no such tip.
        InvalidValue: the robot has no self-motion, or its tip cannot move in all directions.
    """
    say = tell or (lambda _: None)
    frames = tuple(dict.fromkeys(tips or (study.model.tip,)))
    for tip in frames:
        study.robot.frame(tip)
    J = np.array(study.model.jacobian(study.task_pose.q))
    if np.linalg.matrix_rank(J, tol=1e-6) < 3:
        raise InvalidValue("study", "its tip cannot move in all three directions")
    found = candidates(study)
    curve = self_motion(study.model, _held_task(study, found))
    poses = np.array([candidate.q for candidate in found])
    own = np.array(study.model.drives.rotors).ravel()
    sets = {name: study.robot.rotor_inertia_set(name) for name in study.robot.rotor_inertia_sets}
    sets = sets or {"study": own}
    factors, along = {}, {}
    for tip in frames:
        functions = factor_functions(replace(study.model, tip=tip))
        for name, rotors in sets.items():
            say(f"{tip}, rotors {name}: poses and self-motion")
            geared = replace(study.model.drives, rotors=ca.DM(rotors))
            model = replace(study.model, tip=tip, drives=geared)
            axes = tip_pose(model, poses[0])[1]
            factors[tip, name] = pose_factors(functions, list(poses), rotors, study.direction, axes)
            along[tip, name] = along_self_motion(study, model, functions, curve)
    say("floating bases")
    heavy = on_heavy_base(study.model, list(poses), sets)
    say("forces over joint stiffness")
    return FactorStudy(
        study=study,
        names=tuple(candidate.pose.name for candidate in found),
        poses=poses,
        rotor_sets=sets,
        tips=frames,
        factors=factors,
        curve=curve,
        along=along,
        heavy_base=heavy,
        agreements=agreements(study, factor_functions(study.model), list(poses), own),
    )


def _held_task(study: Study, found: Sequence[Candidate]) -> Array:
    return next(c.q for c in found if c.pose.name == study.task_pose.name)
