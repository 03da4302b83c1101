# SPDX-License-Identifier: BSD-3-Clause
"""Robot and body joined into one system for SUNDIALS.

States are scaled to an approach of 1 m/s and positions to ``UNIT_TIME``, so that one absolute
tolerance fits all; time is scaled to the span of a run, so that one integrator serves all spans.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from softimpact.symbolic import SoftImpactError
from softimpact.symbolic.matrices import Matrix

from .mechanism import BodyKind, BodySymbols, Mechanism, Press, body_units, press

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
class Simulator:
    """An integrator for the impacts of one kind of robot on one kind of body.

    Attributes:
        integrate: SUNDIALS; state and parameters → states at the nodes.
        observe: state and parameters → depth, closing, force and reading.
        body_states: number of states of the body, which come last.
        differential: number of states that follow a differential equation; the others come last.
    """

    integrate: ca.Function
    observe: ca.Function
    body_states: int
    differential: int


def build_simulator(robot: Mechanism, kind: BodyKind, tolerance: float) -> Simulator:
    """Return the simulator of a robot's impacts on a kind of body.

    The node x_0 has no mass: with a damper it follows a differential equation (CVODES), without
    one an algebraic equation (IDAS).

    Args:
        robot: its equations of motion.
        kind: of the body.
        tolerance: relative and absolute, for an approach of 1 m/s.
    """
    body = BodySymbols.symbols(kind)
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
    shown = (pressed.depth, pressed.closing, pressed.force, pressed.reading)
    seen = [scaled(e) for e in shown]
    size, bodies = int(state.numel()), int(body.state.numel())
    observe = ca.Function("observe", [x, p], seen)
    return Simulator(integrate, observe, bodies, size if kind.damped else size - 1)


def _rate(robot: Mechanism, pressed: Press) -> Matrix:
    acceleration = ca.substitute(robot.acceleration, robot.force, pressed.force)
    return ca.vertcat(robot.velocity, acceleration, robot.memory_rate, pressed.rate)
