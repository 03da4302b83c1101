# SPDX-License-Identifier: BSD-3-Clause
"""Equations of motion of the nonlinear robot under a law of its motors."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import casadi as ca

from softimpact.symbolic import (
    Robot,
    bias_torques,
    closed_chain,
    direction_jacobian,
    frame_pose,
    gravity_torques,
    loop_acceleration,
    loop_jacobian,
    loop_tangent,
    mass_matrix,
)
from softimpact.symbolic.dynamics.equations_of_motion import FixedGravity
from softimpact.symbolic.impact.impact_model import WEIGHTLESS
from softimpact.symbolic.matrices import Factorisation, Matrix

from .mechanism import BodyKind, Mechanism
from .motor_actions import MotorActionBuilder, MotorSide
from .simulator import Simulator, build_simulator


@lru_cache(maxsize=16)
def full_simulator(
    robot: Robot,
    tip: str,
    elastic: tuple[bool, ...],
    gravity: FixedGravity,
    law: MotorActionBuilder,
    kind: BodyKind,
    tolerance: float,
) -> Simulator:
    """Return the simulator of a robot's impacts under a law of its motors."""
    return build_simulator(_mechanism(robot, tip, elastic, gravity, law), kind, tolerance)


def _mechanism(
    robot: Robot,
    tip: str,
    elastic: tuple[bool, ...],
    gravity: FixedGravity,
    law: MotorActionBuilder,
) -> Mechanism:
    """Equations over the links' and the elastic joints' motors' motion since first touch.

    GᵀM(q)(G q̈_ind + Ġ q̇_ind) + Gᵀh(q, q̇) = τ − GᵀJᵀ n f_c over the independent joints, with τ
    from the spring (elastic joints, whose rotor follows B θ̈ = τ_m − τ) or the motor (rigid
    joints, whose rotor turns with the link). All joints are integrated, so that the loops need
    not be closed anew; without loops G = I.
    """
    free = list(closed_chain(robot).independent)
    n, m, E = robot.n, len(free), [i for i, is_elastic in enumerate(elastic) if is_elastic]
    position, velocity = ca.SX.sym("z", n + len(E)), ca.SX.sym("dz", n + len(E))
    force = ca.SX.sym("f_c")
    q0, direction, start = ca.SX.sym("q0", n), ca.SX.sym("n", 3), ca.SX.sym("p0")
    balance, springs, rotors = ca.SX.sym("g0", m), ca.SX.sym("k_s", m), ca.SX.sym("B", n)
    damping, before = ca.SX.sym("d", n), ca.SX.sym("dq0", n)

    q, rate = q0 + position[:n], velocity[:n]
    moved, motors, motor_rates = position[free], position[free], velocity[free]
    motors[E], motor_rates[E] = position[n:], velocity[n:]

    along = _Tangent.of(robot, q, rate)
    M = mass_matrix(robot, q)
    potential = along.forces(gravity_torques(robot, q, gravity))
    coriolis = bias_torques(robot, q, rate, WEIGHTLESS)
    whole = M + ca.diag(rotors)
    driven = law(
        MotorSide(
            active=[k for k, i in enumerate(free) if robot.joints[i].actuated],
            moved=motors,
            speed=motor_rates,
            inertia=along.inertia(whole),
            coriolis=along.forces(coriolis + ca.mtimes(whole, along.bend)),
            potential=potential,
        ),
        balance,
    )
    spring = springs * (motors - moved)
    torque, carried = ca.SX(driven.torque), ca.SX(rotors)
    torque[E], carried[[free[k] for k in E]] = spring[E], 0
    links = M + ca.diag(carried)
    slowed = damping * (rate - before)  # the motors carry what the motion before the impact needs
    bias = along.forces(coriolis + ca.mtimes(links, along.bend) + slowed) + potential - balance
    push = along.forces(direction_jacobian(robot, tip, q, direction).T * force)
    has_motor = [robot.joints[i].actuated for i in free]
    given = driven.acceleration
    fixed = [k for k in range(m) if given is not None and has_motor[k] and not elastic[k]]
    acceleration = _solved(along.inertia(links), torque - bias - push, fixed, given)
    turning = (driven.torque[E] - spring[E]) / rotors[[free[k] for k in E]]
    for row, k in enumerate(E):
        if given is not None and has_motor[k]:
            turning[row] = given[k]
    return Mechanism(
        position=position,
        velocity=velocity,
        force=force,
        parameters=ca.vertcat(
            q0, direction, start, balance, rotors, springs, damping, before, driven.parameters
        ),
        acceleration=ca.vertcat(along.motion(acceleration), turning),
        displacement=ca.dot(direction, frame_pose(robot, tip, q).position) - start,
        memory=driven.memory,
        memory_rate=driven.memory_rate,
    )


def _solved(mass: Matrix, forces: Matrix, fixed: list[int], given: Matrix | None) -> Matrix:
    """Return accelerations under forces; those of some coordinates are given."""
    if given is None or not fixed:
        return Factorisation(mass).solve(forces)
    acceleration = ca.SX(mass.shape[0], 1)
    acceleration[fixed] = given[fixed]
    rest = [k for k in range(mass.shape[0]) if k not in fixed]
    if rest:
        left = forces[rest] - ca.mtimes(mass[rest, fixed], given[fixed])
        acceleration[rest] = Factorisation(mass[rest, rest]).solve(left)
    return acceleration


@dataclass(frozen=True, eq=False)
class _Tangent:
    """How joints move with the independent ones: q̈ = G q̈_ind + Ġ q̇_ind; G is None for G = I.

    Attributes:
        G: ∂q/∂q_ind, n×m.
        bend: Ġ q̇_ind, length n.
    """

    G: Matrix | None
    bend: Matrix

    @staticmethod
    def of(robot: Robot, q: Matrix, rate: Matrix) -> _Tangent:
        bend = ca.SX(robot.n, 1)
        if not robot.loops:
            return _Tangent(None, bend)
        bound = list(closed_chain(robot).dependent)
        jacobian = loop_jacobian(robot, q)[:, bound]
        bend[bound] = -ca.solve(jacobian, loop_acceleration(robot, q, rate))
        return _Tangent(loop_tangent(robot, q), bend)

    def inertia(self, matrix: Matrix) -> Matrix:
        """GᵀXG."""
        return matrix if self.G is None else ca.mtimes([self.G.T, matrix, self.G])

    def forces(self, vector: Matrix) -> Matrix:
        """Gᵀx."""
        return vector if self.G is None else ca.mtimes(self.G.T, vector)

    def motion(self, independent: Matrix) -> Matrix:
        """Accelerations of all joints."""
        return independent if self.G is None else ca.mtimes(self.G, independent) + self.bend
