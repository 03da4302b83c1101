# SPDX-License-Identifier: BSD-3-Clause
"""Robot and body joined into one system for SUNDIALS.

States are scaled to an approach of 1 m/s and positions to ``UNIT_TIME``, so that one absolute
tolerance fits all; time is scaled to the span of a run, so that one integrator serves all spans.
"""

from __future__ import annotations

import re
from dataclasses import dataclass

import casadi as ca
import numpy as np

from softimpact.symbolic import Contact, SoftImpactError
from softimpact.symbolic.matrices import Matrix
from softimpact.symbolic.robot.rigid import Array

from .mechanism import (
    Body,
    BodyKind,
    Mechanism,
    Press,
    body_parameters,
    body_units,
    press,
)

NODES = 400
"""Intervals of a run's time grid."""

UNIT_TIME = 1e-3
"""Time by which positions are scaled to be of the size of velocities [s]."""


class SimulationFailed(SoftImpactError):
    """The integrator gave up."""

    def __init__(self, reason: str) -> None:
        super().__init__(
            f"the simulation failed ({reason}): check the stiffnesses and masses of robot and "
            "body, or allow a larger tolerance"
        )
        self.reason = reason


@dataclass(frozen=True, eq=False)
class Run:
    """What happened at the nodes of a run.

    Attributes:
        time: since first touch [s], length K.
        state: scaled, one column a node: the robot's positions and velocities, its controller's
            memory, the body's position and velocity (unless it is clamped), its plate's velocity
            (if it has one) and last the node x_0 between skin and spring.
        depth: δ = x_c − x_0 [m], negative when apart.
        closing: dδ/dt [m/s].
        force: f_c [N].
    """

    time: Array
    state: Array
    depth: Array
    closing: Array
    force: Array


@dataclass(frozen=True, eq=False)
class Simulator:
    """An integrator for the impacts of one kind of robot on one kind of body.

    Attributes:
        integrate: SUNDIALS; state and parameters → states at the nodes.
        observe: state and parameters → depth, closing and force.
        kind: of the body.
        memory: length of what the robot's controller keeps.
    """

    integrate: Matrix
    observe: Matrix
    kind: BodyKind
    memory: int


@dataclass(frozen=True, eq=False)
class Switch:
    """Other parameters of the robot from a time [s] on."""

    time: float
    parameters: Array


@dataclass(frozen=True, eq=False)
class Scene:
    """A robot and a body about to touch.

    Attributes:
        simulator: for their kinds.
        parameters: of the robot.
        velocity: rates of the robot's coordinates per 1 m/s of approach.
        speed: of the approach [m/s].
        contact: with the body.
        switch: what changes later, if anything.
    """

    simulator: Simulator
    parameters: Array
    velocity: Array
    speed: float
    contact: Contact
    switch: Switch | None = None

    @property
    def touch(self) -> Array:
        """State at first touch."""
        body = len(body_units(self.simulator.kind, UNIT_TIME))
        rest = np.zeros(self.simulator.memory + body)
        return np.concatenate([np.zeros_like(self.velocity), self.velocity, rest])

    def run(self, state: Array, span: float, start: float = 0.0) -> Run:
        """Simulate from a state over a span [s]; raises SimulationFailed.

        Args:
            state: at the start.
            span: how long; the switch must not be within.
            start: time since first touch [s].
        """
        simulator, switch = self.simulator, self.switch
        switched = switch is not None and start + span / 2 > switch.time
        parameters = switch.parameters if switch and switched else self.parameters
        p = [*parameters, *body_parameters(self.contact), self.speed, span]
        damped = simulator.kind.damped
        initial = {"x0": state} if damped else {"x0": state[:-1], "z0": state[-1]}
        try:
            end = simulator.integrate(**initial, p=p)
        except RuntimeError as error:
            flags = re.findall(r'returned "(\w+)"', str(error))
            raise SimulationFailed(flags[0] if flags else str(error)) from None
        states = np.array(end["xf"] if damped else ca.vertcat(end["xf"], end["zf"]))
        depth, closing, force = (np.array(row).ravel() for row in simulator.observe(states, p))
        return Run(np.linspace(0, span, NODES + 1), states, depth, closing, force)


def build_simulator(robot: Mechanism, kind: BodyKind, tolerance: float) -> Simulator:
    """Return the simulator of a robot's impacts on a kind of body.

    The node x_0 has no mass: with a damper it follows a differential equation (CVODES), without
    one an algebraic equation (IDAS).

    Args:
        robot: its equations of motion.
        kind: of the body.
        tolerance: relative and absolute, for an approach of 1 m/s.
    """
    body = Body.symbols(kind)
    speed, span = ca.SX.sym("v"), ca.SX.sym("T")
    pressed = press(robot, body, kind)
    state = ca.vertcat(robot.position, robot.velocity, robot.memory, body.state)
    k, memory = robot.size, int(robot.memory.numel())
    lengths = [UNIT_TIME] * k + [1.0] * k + [UNIT_TIME] * memory
    scale = speed * ca.DM([*lengths, *body_units(kind, UNIT_TIME)])
    x = ca.SX.sym("x", state.numel())

    def scaled(expression: Matrix) -> Matrix:
        return ca.cse(ca.substitute(expression, state, scale * x))

    rate = scaled(span * _rate(robot, pressed) / scale)
    p = ca.vertcat(robot.parameters, body.parameters, speed, span)
    if kind.damped:
        solver, dae = "cvodes", {"x": x, "p": p, "ode": rate}
    else:
        balance = scaled(pressed.imbalance / (body.stiffness * scale[-1]))
        solver, dae = "idas", {"x": x[:-1], "z": x[-1], "p": p, "ode": rate[:-1], "alg": balance}
    options = {"reltol": tolerance, "abstol": tolerance, "max_num_steps": 100_000}
    integrate = ca.integrator("impact", solver, dae, 0, np.linspace(0, 1, NODES + 1), options)
    seen = [scaled(e) for e in (pressed.depth, pressed.closing, pressed.force)]
    return Simulator(integrate, ca.Function("observe", [x, p], seen), kind, memory)


def _rate(robot: Mechanism, pressed: Press) -> Matrix:
    acceleration = ca.substitute(robot.acceleration, robot.force, pressed.force)
    return ca.vertcat(robot.velocity, acceleration, robot.memory_rate, pressed.rate)
