# SPDX-License-Identifier: BSD-3-Clause
"""All branches of the self-motion that holds a task, and where on each a search should begin."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import casadi as ca
import numpy as np

from softimpact.symbolic import ImpactModel, InvalidValue
from softimpact.symbolic.robot.rigid import Array

from ..impact.timing import study_impacts
from ..machine.coordinates import is_plain
from ..posture.self_motion import SelfMotion, self_motion
from ..posture.tip_pose import POSE, tip_pose, tip_pose_error
from ..study.study import Study
from .accurate_springs import accurate_springs
from .problem import Problem, felt_numbers

SEEDS = 200
"""Random postures from which branches are sought; one that a hundredth of them leads to is missed
in one of seven runs, and the seed is always the same."""

NEWTON_STEPS = 40
"""Most steps from a random posture to the task."""

HELD = 1e-6
"""Pose error [m, rad] up to which the task counts as held."""

STEP = 0.1
"""Between postures of a branch [rad]."""


@dataclass(frozen=True, eq=False)
class Branch:
    """A piece of the self-motion within the joint limits, and its best posture before any search.

    Attributes:
        curve: postures along it.
        q: posture of least force with springs that are just accurate, length n [rad].
        springs: these, one each [N·m/rad].
        force: with them [N].
    """

    curve: SelfMotion
    q: Array
    springs: Array
    force: float


def self_motions(study: Study) -> list[SelfMotion]:
    """Return all pieces of the self-motion at the task's pose that were found, largest first.

    Empty for arms that have none with one parameter.
    """
    redundant = is_plain(study.model) and study.robot.n == POSE + 1
    if not redundant or not np.isfinite(study.robot.limits).all():
        return []
    return _self_motions(study.model, tuple(study.task_pose.q.tolist()))


@lru_cache(maxsize=4)
def _self_motions(model: ImpactModel, task: tuple[float, ...]) -> list[SelfMotion]:
    found: list[SelfMotion] = []
    postures = [np.array(task), *_postures_at(model, np.array(task))]
    for q in postures:
        if any(_apart(curve, q) < STEP for curve in found):
            continue
        try:
            found.append(self_motion(model, q, STEP))
        except InvalidValue:  # a singular posture, from which no curve can be traced
            continue
    return sorted(found, key=lambda curve: -len(curve.q))


def _apart(curve: SelfMotion, q: Array) -> float:
    """Return how far a posture is from a curve, full turns apart being the same [rad]."""
    off = np.remainder(curve.q - q + np.pi, 2 * np.pi) - np.pi
    return float(np.linalg.norm(off, axis=1).min())


def _postures_at(model: ImpactModel, task: Array) -> Array:
    """Return postures within the limits that hold the task, from random ones by Newton's method."""
    lower, upper = model.robot.limits
    position, rotation = tip_pose(model, task)
    x = ca.SX.sym("q", task.size)
    error = tip_pose_error(model, x, ca.DM(position), ca.DM(rotation))
    function = ca.Function("hold", [x], [error, ca.jacobian(error, x)], {"cse": True})
    q = np.random.default_rng(0).uniform(lower, upper, (SEEDS, task.size))
    for _ in range(NEWTON_STEPS):
        errors, jacobians = (np.array(each) for each in function(q.T))
        J = jacobians.reshape(POSE, len(q), -1).transpose(1, 0, 2)
        steps = (np.linalg.pinv(J, rcond=1e-3) @ errors.T[:, :, None])[:, :, 0]
        lengths = np.linalg.norm(steps, axis=1, keepdims=True)
        q = q - steps * np.minimum(1.0, 0.5 / np.maximum(lengths, 1e-12))
    q = np.remainder(q + np.pi, 2 * np.pi) - np.pi  # Newton's method may wind joints up
    errors = np.array(function(q.T)[0])
    held = (abs(errors).max(axis=0) < HELD) & ((lower <= q) & (q <= upper)).all(axis=1)
    return np.asarray(q[held])


def branches(problem: Problem, max_deflection: float | None = None) -> list[Branch]:
    """Return each piece of the self-motion with its best posture before any search.

    Args:
        problem: the study made ready.
        max_deflection: bound that the springs just keep [m]; default the study's.
    """
    study = problem.study
    if max_deflection is not None:
        study = replace(study, max_deflection=max_deflection)
    impact, rows = problem.program.impacts[0], study_impacts(study, problem.timing.step)
    equal = np.full(len(study.groups), float(np.median(study.nominal)))
    found = []
    for curve in self_motions(study):
        tried = []
        for q in curve.q[:: max(1, round(0.2 / STEP))]:
            springs = accurate_springs(study, q, equal)
            x = np.concatenate([q, felt_numbers(study, impact.parts, springs)])
            force = max(float(np.array(impact["peaks"](x, row, 0)).max()) for row in rows)
            tried.append((force, q, springs))
        force, q, springs = min(tried, key=lambda each: each[0])
        found.append(Branch(curve, q, springs, force))
    return found
