# SPDX-License-Identifier: BSD-3-Clause
"""Closed chains: what a robot's loops demand of its joints, and the motion that they leave."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import lru_cache
from typing import overload

import casadi as ca
import numpy as np

from ..dynamics.equations_of_motion import STANDARD_GRAVITY, Gravity
from ..errors import (
    InvalidValue,
    LoopCannotClose,
    RedundantLoop,
    SingularLoop,
    UnknownName,
)
from ..matrices import Kind, Matrix, Numbers
from ..robot.constraints import Constraint, Loop
from ..robot.rigid import Array
from ..robot.robot import Robot
from ..robot.welding import require_modelled
from .loop_equations import (
    ClosedChain,
    gap_acceleration,
    gap_jacobian,
    gaps,
    stiffness_along,
    tangent,
)

SAMPLES = 40
"""Random configurations that show which equations of a loop hold everywhere."""

ALWAYS = 1e-9
"""Gap over the robot's size below which points count as never leaving each other along an axis."""

DEPENDENT = 1e-7
"""Smallest singular value, over the largest, of independent equations."""

CLOSING_STEPS = 200
"""Most steps of the search for a closed configuration near home."""

CLOSED = 1e-10
"""Gap [m] at which a loop counts as closed."""


@lru_cache(maxsize=64)
def closed_chain(robot: Robot) -> ClosedChain:
    """Return the equations of a robot's loops.

    Raises:
        LoopCannotClose: no closed configuration was found near home.
        RedundantLoop: a loop's equations follow from the others'.
        UnsupportedModel: it has ball joints, tendons through space, or bodies that its file welds
            together.
        UnknownName: ``robot.independent`` names a joint that there is not.
        InvalidValue: it does not name one joint for each degree of freedom, or leaves out a motor.
        SingularLoop: the others do not follow from those it names.
    """
    require_modelled(robot)
    axes = tuple(_free_axes(robot, loop) for loop in robot.loops)
    chain = ClosedChain(robot, axes, np.zeros(robot.n), tuple(range(robot.n)), ())
    if not robot.loops:
        return chain
    start = np.zeros(robot.n) if robot.home is None else robot.vector("home", robot.home)
    home = nearest_to_closed(chain, start, range(robot.n))
    hint = "check its points, or give a keyframe near a closed configuration"
    require_closed(chain, home, hint)
    jacobian = np.array(gap_jacobian(chain, ca.DM(home)))
    _require_full_rank(robot, axes, jacobian)
    chosen = _named(robot, jacobian) if robot.independent else _chosen(robot, jacobian)
    dependent = tuple(i for i in range(robot.n) if i not in chosen)
    return replace(chain, home=home, independent=chosen, dependent=dependent)


@overload
def loop_gaps(robot: Robot, q: Kind) -> Kind: ...
@overload
def loop_gaps(robot: Robot, q: Numbers) -> ca.DM: ...
def loop_gaps(robot: Robot, q: Matrix) -> Matrix:
    """Return φ(q), how far apart the loops' ends are [m]; equations that always hold are left out.

    Args:
        robot: with or without loops.
        q: configuration, length n, of any matrix kind.

    Returns:
        Length r, zero where the loops are closed.
    """
    return gaps(closed_chain(robot), q)


@overload
def loop_jacobian(robot: Robot, q: Kind) -> Kind: ...
@overload
def loop_jacobian(robot: Robot, q: Numbers) -> ca.DM: ...
def loop_jacobian(robot: Robot, q: Matrix) -> Matrix:
    """Return Φ = ∂φ/∂q, r×n."""
    return gap_jacobian(closed_chain(robot), q)


@overload
def loop_acceleration(robot: Robot, q: Kind, velocity: Kind | Numbers) -> Kind: ...
@overload
def loop_acceleration(robot: Robot, q: Numbers, velocity: Numbers) -> ca.DM: ...
def loop_acceleration(robot: Robot, q: Matrix, velocity: Matrix) -> Matrix:
    """Return Φ̇ q̇, length r: joints that keep the loops closed have Φ q̈ + Φ̇ q̇ = 0."""
    return gap_acceleration(closed_chain(robot), q, velocity)


@overload
def loop_tangent(robot: Robot, q: Kind) -> Kind: ...
@overload
def loop_tangent(robot: Robot, q: Numbers) -> ca.DM: ...
def loop_tangent(robot: Robot, q: Matrix) -> Matrix:
    """Return G = ∂q/∂q_ind along the loops, n×(n−r), for a closed configuration q."""
    return tangent(closed_chain(robot), q)


def constrained_stiffness(robot: Robot, q: Matrix, gravity: Gravity = STANDARD_GRAVITY) -> Matrix:
    """Return the curvature Gᵀ ∇²(V + λᵀφ) G of the potential along the loops, (n−r)×(n−r).

    λ are the forces in the loops that hold the dependent joints, φ_depᵀ λ = −∂V/∂q_dep.

    Args:
        robot: with or without loops.
        q: closed configuration, length n, of any matrix kind.
        gravity: acceleration along the base's axes [m/s²].
    """
    return stiffness_along(closed_chain(robot), tuple(gravity), q)


def _free_axes(robot: Robot, loop: Constraint) -> Array:
    """Directions along which a loop's ends can part, as sparse orthonormal rows."""
    if not isinstance(loop, Loop):
        return np.ones((1, 1))
    size = _size(robot)
    random = np.random.default_rng(0)
    alone = replace(robot, loops=(loop,))
    chain = ClosedChain(alone, (np.eye(3),), np.zeros(robot.n), (), ())
    samples = random.uniform(-np.pi, np.pi, (robot.n, SAMPLES))
    found = np.column_stack([np.array(gaps(chain, ca.DM(q))) for q in samples.T])
    mean = found.mean(axis=1)
    moving, values, _ = np.linalg.svd(found - mean[:, None])
    free = moving[:, values > ALWAYS * size * np.sqrt(SAMPLES)]
    still = mean - free @ (free.T @ mean)
    if np.linalg.norm(still) > ALWAYS * size:
        hint = f"no joint moves them along {_shown(still)}"
        raise LoopCannotClose(loop.name, float(np.linalg.norm(still)), hint)
    if not free.shape[1]:
        raise RedundantLoop(loop.name, "holds whatever the joints do; remove it")
    return _sparse_rows(free @ free.T, free.shape[1])


def _sparse_rows(projector: Array, count: int) -> Array:
    """Orthonormal rows that span a projector's image; base axes where these lie in it."""
    rows: list[Array] = []
    left = projector.copy()
    while len(rows) < count:
        row = left[int(np.argmax(np.round(np.diag(left), 9)))]
        row = row / np.linalg.norm(row)
        row = np.where(abs(row - row.round()) < ALWAYS, row.round(), row)
        rows.append(row)
        left = left - np.outer(left @ row, row)
    return np.array(rows)


def _shown(direction: Array) -> str:
    unit = direction / np.linalg.norm(direction)
    return "[" + ", ".join(f"{x:.3g}" for x in unit.round(9) + 0.0) + "]"


def _size(robot: Robot) -> float:
    """Length of all links together [m]."""
    loops = [loop for loop in robot.loops if isinstance(loop, Loop)]
    ends = [robot.frame(end) for loop in loops for end in (loop.first, loop.second)]
    places = [joint.placement for joint in robot.joints] + [end.placement for end in ends]
    return float(sum(np.linalg.norm(place.translation) for place in places))


def nearest_to_closed(chain: ClosedChain, start: Array, joints: Sequence[int]) -> Array:
    """Return the configuration of least gap that damped least squares over some joints finds."""
    move, q = list(joints), start.copy()
    damping, tiny = 1e-3, 1e-12 * _size(chain.robot) ** 2
    gap = np.array(gaps(chain, ca.DM(q))).ravel()
    for _ in range(CLOSING_STEPS):
        if abs(gap).max() < CLOSED / 100:
            break
        J = np.array(gap_jacobian(chain, ca.DM(q)))[:, move]
        damped = J @ J.T + damping * max(float(gap @ gap), tiny) * np.eye(len(gap))
        trial = q.copy()
        trial[move] -= J.T @ np.linalg.lstsq(damped, gap, rcond=None)[0]
        left = np.array(gaps(chain, ca.DM(trial))).ravel()
        if left @ left < gap @ gap:
            q, gap, damping = trial, left, damping / 4
        else:
            damping *= 8
    return q


def require_closed(chain: ClosedChain, q: Array, hint: str, tolerance: float = CLOSED) -> None:
    """Raise LoopCannotClose for the widest loop if its gap is not below a tolerance [m]."""
    if not chain.axes:
        return
    gap = np.array(gaps(chain, ca.DM(q))).ravel()
    ends = np.cumsum([len(axes) for axes in chain.axes])[:-1]
    widths = [float(np.linalg.norm(part)) for part in np.split(gap, ends)]
    widest = int(np.argmax(widths))
    if not widths[widest] < tolerance:
        raise LoopCannotClose(chain.robot.loops[widest].name, widths[widest], hint)


def _rank(matrix: Array) -> int:
    return int(np.linalg.matrix_rank(matrix, DEPENDENT * np.linalg.norm(matrix, 2)))


def _require_full_rank(robot: Robot, axes: Sequence[Array], jacobian: Array) -> None:
    """Raise RedundantLoop for the first loop whose equations follow from those before it."""
    if _rank(jacobian) == len(jacobian):
        return
    rows = 0
    for loop, directions in zip(robot.loops, axes, strict=True):
        rows += len(directions)
        if _rank(jacobian[:rows]) < rows:
            raise RedundantLoop(
                loop.name,
                "is redundant: its equations follow from those of the loops before it; remove it, "
                "or give a keyframe where the mechanism is not singular",
            )


def _chosen(robot: Robot, jacobian: Array) -> tuple[int, ...]:
    """Choose independent joints: motors first, then joints with springs, then the others."""
    preferred = sorted(range(robot.n), key=lambda i: _rank_of_joint(robot, i))
    dependent: list[int] = []
    for joint in reversed(preferred):
        if _rank(jacobian[:, [*dependent, joint]]) > len(dependent):
            dependent.append(joint)
        if len(dependent) == len(jacobian):
            break
    return tuple(i for i in preferred if i not in dependent)


def _rank_of_joint(robot: Robot, index: int) -> int:
    joint = robot.joints[index]
    return 0 if joint.actuated else 1 if joint.stiffness else 2


def _named(robot: Robot, jacobian: Array) -> tuple[int, ...]:
    for name in robot.independent:
        if name not in robot.joint_names:
            raise UnknownName("independent joint", name, robot.joint_names)
    chosen = tuple(dict.fromkeys(robot.joint_names.index(name) for name in robot.independent))
    needed = robot.n - len(jacobian)
    if len(chosen) != needed or len(robot.independent) != needed:
        raise InvalidValue(
            "independent", f"must name {needed} joints, one for each degree of freedom"
        )
    motors = [i for i, actuated in enumerate(robot.actuated) if actuated]
    left_out = [robot.joint_names[i] for i in motors if i not in chosen]
    if left_out and len(motors) <= needed:
        raise InvalidValue("independent", f"leaves out '{left_out[0]}', which has a motor")
    dependent = [i for i in range(robot.n) if i not in chosen]
    if _rank(jacobian[:, dependent]) < len(dependent):
        names = ", ".join(robot.joint_names[i] for i in dependent)
        raise SingularLoop(
            robot.loops[0].name, f"does not decide {names}; choose other independent joints"
        )
    return chosen
