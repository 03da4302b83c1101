# SPDX-License-Identifier: BSD-3-Clause
"""The nonlinear robot over links and motors."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import casadi as ca
import numpy as np

from softimpact.symbolic import (
    Contact,
    ImpactModel,
    InvalidValue,
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
from softimpact.symbolic.impact.impact_model import WEIGHTLESS
from softimpact.symbolic.matrices import Factorisation, Matrix
from softimpact.symbolic.robot.rigid import Array

from .approach import Arrival
from .controller import Controller
from .mechanism import BodyKind, Mechanism
from .motors import (
    LawBuilder,
    Motors,
    after_reaction,
    computed_torque,
    controller_parameters,
    held,
)
from .simulator import Scene, Simulator, Switch, build_simulator

Gravity = tuple[float, float, float]

AT_REST = 1e-6
"""Torque [N·m, N] on a joint without a motor below which it counts as balanced."""


def full_scene(
    model: ImpactModel,
    arrival: Arrival,
    contact: Contact,
    tolerance: float,
    controller: Controller | None = None,
) -> Scene:
    """Return the scene of the nonlinear robot's impact.

    Without a controller, constant motor torques balance gravity at first touch, where the springs
    hold the links at q; K_p holds the motors where they are then.

    Args:
        model: the robot.
        arrival: how it arrives.
        contact: with the body.
        tolerance: of the integrator.
        controller: takes the place of the model's K_p.

    Raises:
        InvalidValue: a joint without a motor is not in equilibrium.
    """
    robot, q, n = model.robot, arrival.q, arrival.direction
    elastic, free = model.elastic, list(model.independent)
    law = held if controller is None else computed_torque
    kind = BodyKind.of(contact)
    simulator = _full_simulator(robot, model.tip, elastic, model.gravity, law, kind, tolerance)
    start = n @ _column(frame_pose(robot, model.tip, q).position)
    rotors, springs = _column(model.drives.rotors), _column(model.drives.springs)[free]
    parameters = np.concatenate([q, n, [start], _balance(model, q), rotors, springs])
    rates = np.array(loop_tangent(robot, ca.DM(q))) @ arrival.link_velocity
    velocity = np.concatenate([rates, arrival.link_velocity[list(elastic)]])

    def scene(of_law: Array, switch: Switch | None = None) -> Scene:
        everything = np.concatenate([parameters, of_law])
        return Scene(simulator, everything, velocity, arrival.speed, contact, switch)

    if controller is None:
        return scene(_gains(model, q).ravel())
    of_law = controller_parameters(arrival, model.actuated, controller)
    reacting = np.concatenate([parameters, after_reaction(of_law)])
    return scene(of_law, Switch(controller.reaction_time, reacting))


def _column(vector: Matrix) -> Array:
    return np.array(vector, dtype=float).ravel()


def _balance(model: ImpactModel, q: Array) -> Array:
    """Torques that hold the robot at q; joints without a motor must need none."""
    G = np.array(loop_tangent(model.robot, ca.DM(q)))
    torques = G.T @ _column(gravity_torques(model.robot, q, model.gravity))
    for i, actuated, torque in zip(model.independent, model.actuated, torques, strict=True):
        if not actuated and abs(torque) > AT_REST:
            raise InvalidValue(
                "q",
                f"joint '{model.robot.joint_names[i]}' has no motor and is not at rest there "
                f"(torque {torque:.3g} N·m); choose its equilibrium",
            )
    return np.asarray(torques)


def _gains(model: ImpactModel, q: Array) -> Array:
    """K_p over the independent joints."""
    return np.array(ca.densify(model.position_gains(q)))


@lru_cache(maxsize=16)
def _full_simulator(
    robot: Robot,
    tip: str,
    elastic: tuple[bool, ...],
    gravity: Gravity,
    law: LawBuilder,
    kind: BodyKind,
    tolerance: float,
) -> Simulator:
    return build_simulator(_mechanism(robot, tip, elastic, gravity, law), kind, tolerance)


def _mechanism(
    robot: Robot, tip: str, elastic: tuple[bool, ...], gravity: Gravity, law: LawBuilder
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

    q, rate = q0 + position[:n], velocity[:n]
    moved, motors, motor_rates = position[free], position[free], velocity[free]
    motors[E], motor_rates[E] = position[n:], velocity[n:]

    along = _Tangent.of(robot, q, rate)
    M = mass_matrix(robot, q)
    potential = along.forces(gravity_torques(robot, q, gravity))
    coriolis = bias_torques(robot, q, rate, WEIGHTLESS)
    whole = M + ca.diag(rotors)
    driven = law(
        Motors(
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
    bias = along.forces(coriolis + ca.mtimes(links, along.bend)) + potential - balance
    push = along.forces(direction_jacobian(robot, tip, q, direction).T * force)
    acceleration = Factorisation(along.inertia(links)).solve(torque - bias - push)
    own = rotors[[free[k] for k in E]]
    return Mechanism(
        position=position,
        velocity=velocity,
        force=force,
        parameters=ca.vertcat(q0, direction, start, balance, rotors, springs, driven.parameters),
        acceleration=ca.vertcat(along.motion(acceleration), (driven.torque[E] - spring[E]) / own),
        displacement=ca.dot(direction, frame_pose(robot, tip, q).position) - start,
        memory=driven.memory,
        memory_rate=driven.memory_rate,
    )


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
