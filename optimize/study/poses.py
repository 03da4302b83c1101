# SPDX-License-Identifier: BSD-3-Clause
"""Candidate postures held against the task: which are turned about the base, and by how much."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from softimpact.symbolic import InvalidValue, Joint, JointKind
from softimpact.symbolic.robot.rigid import Array

from ..machine.postures import freedom, held, turns_with_first
from ..posture.at_pose import held_elsewhere, nearest_at_pose, posture_at_pose
from ..posture.tip_pose import POSE, posture_error, tip_pose, tip_poses
from .study import Pose, Study

LEAST_TURN = 0.1
"""Angle [rad] about the base from which a pose counts as another one, turned."""


@dataclass(frozen=True, eq=False)
class Candidate:
    """A pose as the study gives it, and as it serves the task.

    Attributes:
        pose: as given.
        turned: angle about the first joint's axis by which it differs from the task [rad]; zero
            unless it is so large that the pose is another one, turned.
        moved: largest change of a joint, after that turn, that holds the tip exactly [rad].
        q: posture that serves the task, length n [rad].
        offset: distance of the tip from the task's position at q [m].
    """

    pose: Pose
    turned: float
    moved: float
    q: Array
    offset: float


def leaves_a_choice(study: Study) -> bool:
    """Return whether an arm's posture can be sought while its tip is held as the task asks.

    Six motors or more can be led there from any pose, even if they then have no choice. Fewer have
    one posture nearby, that of the task itself, unless they move in a plane or the like. Passive
    joints stay where their springs are unbent: nothing else would hold them.
    """
    model = study.model
    if freedom(model) >= POSE:
        return True
    q = ca.SX.sym("q", model.robot.n)
    position, rotation = tip_pose(model, study.task_pose.q)
    error = posture_error(model, q, ca.DM(position), ca.DM(rotation))
    jacobian = ca.Function("error", [q], [ca.jacobian(error, q)])(study.task_pose.q)
    moving = [i for i in range(model.robot.n) if i not in held(model)]
    return bool(np.linalg.matrix_rank(np.array(jacobian)[:, moving], tol=1e-6) < len(moving))


def candidates(study: Study) -> list[Candidate]:
    """Return the study's poses; those turned about the base are turned back to the task.

    A fixed base robot does not feel a turn about its first axis if the impact turns with it, so
    turning the pose back compares like with like.

    Raises:
        InvalidValue: a pose cannot be moved to where it holds the tip exactly, as the study wants.
    """
    task = tip_pose(study.model, study.task_pose.q)
    first, given = study.robot.joints[0], np.array([pose.q for pose in study.poses])
    turns = np.zeros(len(given))
    if first.kind is JointKind.HINGE and turns_with_first(study.model):
        turns = _best_turns(study, given, task)
        turns[abs(turns) <= LEAST_TURN] = 0.0
    back = given.copy()
    back[:, 0] = [
        _within_limits(first, q - turn) for q, turn in zip(given[:, 0], turns, strict=True)
    ]
    served = back.copy()
    if study.exact:
        elsewhere = held_elsewhere(study.model, back, *task)
        nearest, right = nearest_at_pose(study.model, back[elsewhere], *task)
        served[elsewhere[right]] = nearest[right]
        for i in elsewhere[~right]:
            served[i] = _moved(study, study.poses[i], back[i], task)
    offsets = np.linalg.norm(tip_poses(study.model, served)[0] - task[0], axis=1)
    moved = abs(served - back).max(axis=1)
    numbers = zip(
        study.poses, turns.tolist(), moved.tolist(), served, offsets.tolist(), strict=True
    )
    return [Candidate(*each) for each in numbers]


def _moved(study: Study, pose: Pose, back: Array, task: tuple[Array, Array]) -> Array:
    """Return the posture near a pose that serves the task."""
    q = posture_at_pose(study.model, back, *task)
    if q is None:
        raise InvalidValue(
            f"{study.source}: poses.{pose.name}.q",
            f"no posture near it holds the tip where pose '{study.task_pose.name}' does; change "
            "it, or set task.exact = false",
        )
    return q


def _within_limits(joint: Joint, angle: float) -> float:
    """Return the angle, a full turn on or back if only that is within the joint's limits."""
    same = (angle, angle - 2 * np.pi, angle + 2 * np.pi)
    return next((a for a in same if joint.lower <= a <= joint.upper), angle)


def _best_turns(study: Study, postures: Array, task: tuple[Array, Array]) -> Array:
    """Angles of the first joint that, taken back, bring the tip's axes nearest to the task's."""

    def agreement(turn: float) -> Array:
        moved = postures.copy()
        moved[:, 0] -= turn
        position, rotation = tip_poses(study.model, moved)
        miss = np.sum((position - task[0]) ** 2, axis=1)
        return np.asarray(np.sum(rotation * task[1], axis=(1, 2)) - miss / np.sum(task[0] ** 2))

    # over turns the agreement is a + b cos + c sin: three samples give its maximum
    at = [agreement(turn) for turn in (0.0, 2 * np.pi / 3, -2 * np.pi / 3)]
    cosine = 2 * at[0] - at[1] - at[2]
    sine = np.sqrt(3.0) * (at[1] - at[2])
    return np.asarray(np.arctan2(sine, cosine))
