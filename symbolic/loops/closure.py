# SPDX-License-Identifier: BSD-3-Clause
"""Configurations at which a robot's loops are closed, and at which springs and gravity balance."""

from __future__ import annotations

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from ..dynamics.equations_of_motion import gravity_torques
from ..errors import InvalidValue, NoEquilibrium, SingularLoop
from ..impact.impact_model import ImpactModel
from ..matrices import Matrix, on_scalars
from ..robot.rigid import Array
from ..robot.robot import Robot, vector_of
from .loop_equations import (
    ClosedChain,
    gap_jacobian,
    gaps,
    solve_few,
    stiffness_along,
    tangent,
)
from .loops import CLOSED, closed_chain, nearest_to_closed, require_closed

NEWTON_STEPS = 30
"""Most Newton steps for one closure or balance."""

LEAST_STEP = 2.0**-10
"""Share of a motion or load below which it is not divided further."""

FARTHEST = 1.0
"""Longest move of a coordinate in one step [rad, m]; what moves further may be another branch."""

BALANCED = 1e-12
"""Unbalanced torque over the largest stiffness [rad] at which an equilibrium counts as found."""

OPEN = 1e-6
"""Gap [m] at which a given configuration counts as not closed."""

NEARLY_SINGULAR = 1e-6
"""Smallest singular value of the dependent joints' equations over the largest at a dead point."""


def require_closed_at(robot: Robot, q: ArrayLike) -> None:
    """Raise LoopCannotClose if a loop is open at a configuration, length n."""
    hint = "choose a closed configuration, e.g. by close_loops or from motor angles"
    require_closed(closed_chain(robot), np.asarray(q, dtype=float), hint, OPEN)


def close_loops(robot: Robot, independent: ArrayLike) -> Array:
    """Return the closed configuration q at given coordinates of the independent joints.

    The chain is moved there from home, so that it stays assembled as it is.

    Args:
        robot: with or without loops.
        independent: coordinates of ``closed_chain(robot).independent``, length n−r.

    Raises:
        LoopCannotClose: it cannot get there.
        SingularLoop: the other joints do not follow from these there (a dead point).
        LoopError: the loops themselves are wrong, see ``closed_chain``.
        InvalidValue: a coordinate that is not finite; WrongLength for their number.
    """
    chain = closed_chain(robot)
    goal = vector_of([robot.joint_names[i] for i in chain.independent], "independent", independent)
    if not np.isfinite(goal).all():
        raise InvalidValue("independent", "must hold finite numbers")
    q = _moved(chain, chain.home, goal)
    if q is None:
        q = chain.home.copy()
        q[list(chain.independent)] = goal
        hint = "choose other coordinates of the independent joints"
        require_closed(chain, nearest_to_closed(chain, q, chain.dependent), hint)
        raise SingularLoop(robot.loops[0].name, "passes a dead point on the way there from home")
    if _condition(chain, q) < NEARLY_SINGULAR:
        raise SingularLoop(robot.loops[0].name, "is at a dead point there: joints can move freely")
    return q


def closed_near(robot: Robot, independent: Matrix, near: Matrix, steps: int = 6) -> Matrix:
    """Return the closed configuration as an expression, for expressions that differentiate it.

    Args:
        robot: with or without loops.
        independent: coordinates of the independent joints, length n−r.
        near: a configuration of length n from which a fixed number of Newton steps start.
        steps: how many; each doubles the digits once it is near.
    """
    chain = closed_chain(robot)
    return on_scalars(_newton, (chain, steps), independent, near)


def _newton(chain: ClosedChain, steps: int, independent: Matrix, near: Matrix) -> Matrix:
    free, bound = list(chain.independent), list(chain.dependent)
    q = ca.SX(near)
    q[free] = independent
    for _ in range(steps if bound else 0):
        jacobian = gap_jacobian(chain, q)[:, bound]
        q[bound] -= solve_few(jacobian, gaps(chain, q))
    return q


def configuration_at_rest(model: ImpactModel, motor_angles: ArrayLike) -> Array:
    """Return the closed configuration q at which springs and gravity balance (MSM §3.3.2).

    The load of gravity grows from nothing, so that the equilibrium is the one into which the
    unloaded robot sags. Joints without motors and springs start from home.

    Args:
        model: the robot, its drives and gravity.
        motor_angles: of the joints that have motors, in the order of q [rad, m].

    Raises:
        NoEquilibrium: there is none, or it is unstable (springs too soft), or nothing holds a
            joint.
        LoopError: the loops cannot be closed there.
        InvalidValue: a motor's joint follows from other joints; WrongLength for the angles.
    """
    robot = model.robot
    chain = closed_chain(robot)
    motors = [i for i, actuated in enumerate(robot.actuated) if actuated]
    angles = vector_of([robot.joint_names[i] for i in motors], "motor_angles", motor_angles)
    if not np.isfinite(angles).all():
        raise InvalidValue("motor_angles", "must hold finite numbers")
    for i in motors:
        if i not in chain.independent:
            raise InvalidValue(
                "motor_angles", f"joint '{robot.joint_names[i]}' follows from the others' motion"
            )
    unloaded = np.array(
        [
            j.spring_reference if j.stiffness else h
            for j, h in zip(robot.joints, chain.home, strict=True)
        ]
    )
    unloaded[motors] = angles
    balance = _Balance(model, chain, unloaded)
    q = close_loops(robot, unloaded[list(chain.independent)])
    return balance.loaded(q) if balance.free else q


class _Balance:
    """The equilibrium over the independent joints that no motor holds directly."""

    def __init__(self, model: ImpactModel, chain: ClosedChain, motors: Array) -> None:
        self.robot, self.gravity, self.chain, self.motors = (
            model.robot,
            np.array(model.gravity),
            chain,
            motors,
        )
        held = np.array(model.actuated) & ~np.array(model.elastic, dtype=bool)
        self.free = [k for k, is_held in enumerate(held) if not is_held]
        springs = np.array(model.drives.springs, dtype=float).ravel()
        self.springs = np.where(model.drives.elastic, springs, 0.0)

    def loaded(self, q: Array) -> Array:
        """Return the equilibrium into which an unloaded configuration sags."""
        load, step = 0.0, 1.0
        while load < 1.0:
            trial = self._found(q, min(1.0, load + step))
            if trial is not None:
                q, load, step = trial, load + step, 2 * step
            elif step > LEAST_STEP:
                step /= 2
            else:
                residual = float(abs(self._torques(q, 1.0)).max())
                names = [self.robot.joint_names[self.chain.independent[k]] for k in self.free]
                raise NoEquilibrium(
                    residual,
                    f"the springs at {', '.join(names)} are too soft for the arm to hold itself "
                    f"(at {100 * load:.0f} % of gravity it gives way), or nothing holds them",
                )
        return q

    def _found(self, start: Array, load: float) -> Array | None:
        """Return the stable equilibrium near a configuration, if Newton's method finds one."""
        q, ind = start, list(self.chain.independent)
        for _ in range(NEWTON_STEPS):
            torques, stiffness = self._torques(q, load), self._stiffness(q, load)
            eigenvalues = np.linalg.eigvalsh(stiffness)
            if not eigenvalues[0] > BALANCED * abs(eigenvalues).max():
                return None
            if abs(torques).max() <= BALANCED * abs(eigenvalues).max():
                return q
            goal = q[ind]
            goal[self.free] -= np.linalg.solve(stiffness, torques)
            if abs(goal - start[ind]).max() > FARTHEST:
                return None
            moved = _moved(self.chain, q, goal)
            if moved is None:
                return None
            q = moved
        return None

    def _torques(self, q: Array, load: float) -> Array:
        pull = np.array(gravity_torques(self.robot, ca.DM(q), tuple(load * self.gravity))).ravel()
        pull += self.springs * (q - self.motors)
        G = np.array(tangent(self.chain, ca.DM(q)))
        return np.asarray((G.T @ pull)[self.free])

    def _stiffness(self, q: Array, load: float) -> Array:
        whole = np.array(stiffness_along(self.chain, tuple(load * self.gravity), ca.DM(q)))
        ind = list(self.chain.independent)
        whole = whole + np.diag(self.springs[ind])
        return np.asarray(whole[np.ix_(self.free, self.free)])


def _moved(chain: ClosedChain, start: Array, goal: Array) -> Array | None:
    """Move the independent joints to a goal along a straight line with all loops closed."""
    ind = list(chain.independent)
    if not chain.dependent:
        return np.asarray(goal, dtype=float).copy()
    origin, q, done, step = start[ind], start, 0.0, 1.0
    while done < 1.0:
        share = min(1.0, done + step)
        aim = goal if share == 1.0 else origin + share * (goal - origin)
        trial = _closed_near(chain, q, aim)
        if trial is not None:
            q, done, step = trial, share, 2 * step
        elif step > LEAST_STEP:
            step /= 2
        else:
            return None
    return q


def _closed_near(chain: ClosedChain, start: Array, goal: Array) -> Array | None:
    """Close the loops by Newton's method from a nearby closed configuration, on its branch."""
    ind, dep = list(chain.independent), list(chain.dependent)
    G = np.array(tangent(chain, ca.DM(start)))
    q = start + G @ (goal - start[ind])
    q[ind] = goal
    for _ in range(NEWTON_STEPS):
        if not abs(q - start).max() < FARTHEST:
            return None
        gap = np.array(gaps(chain, ca.DM(q))).ravel()
        if abs(gap).max() < CLOSED * 1e-3:
            return q if _side(chain, q) == _side(chain, start) else None
        q[dep] -= np.linalg.lstsq(_dependent(chain, q), gap, rcond=None)[0]
    return None


def _dependent(chain: ClosedChain, q: Array) -> Array:
    return np.array(gap_jacobian(chain, ca.DM(q)))[:, list(chain.dependent)]


def _side(chain: ClosedChain, q: Array) -> float:
    """Sign that changes at dead points: two ways to assemble a chain differ in it."""
    return float(np.sign(np.linalg.det(_dependent(chain, q))))


def _condition(chain: ClosedChain, q: Array) -> float:
    if not chain.dependent:
        return 1.0
    values = np.linalg.svd(_dependent(chain, q), compute_uv=False)
    return float(values[-1] / values[0])
