# SPDX-License-Identifier: BSD-3-Clause
"""The symbols that all functions of a package share, and what a function reads of them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import casadi as ca

from softimpact.symbolic import Drives, ImpactModel, Matrix, Robot, closed_chain

from ..description import CFunction, Guard, Output, Parameter
from .guards import loops_closed


@dataclass(frozen=True, eq=False)
class Symbols:
    """A robot's model over symbols.

    Attributes:
        model: whose drives are the parameters.
        q: joint coordinates.
        n: direction of impact, a unit vector.
        parameters: by their names.
    """

    model: ImpactModel
    q: Matrix = field(repr=False)
    n: Matrix = field(repr=False)
    parameters: Mapping[str, Matrix] = field(repr=False)


def symbols_of(robot: Robot, tip: str, gravity: tuple[float, float, float]) -> Symbols:
    """Return new symbols for a robot's package."""
    n = robot.n
    q, direction = ca.SX.sym("q", n), ca.SX.sym("n", 3)
    values = {p.name: ca.SX.sym(p.name, n) for p in parameters_of(robot)}
    motors = ca.sparsify(ca.DM([float(a) for a in robot.actuated]))
    springs = values.get("joint_stiffness", ca.SX(n, 1))
    elastic = (is_elastic(robot),) * n
    drives = Drives(values["rotor_inertia"], springs, elastic, values["position_gain"] * motors)
    return Symbols(ImpactModel(robot, tip, drives, gravity), q, direction, values)


def model_of(robot: Robot, tip: str, gravity: tuple[float, float, float]) -> ImpactModel:
    """Return the model that a package's functions are made of, over symbols."""
    return symbols_of(robot, tip, gravity).model


def function_over(
    symbols: Symbols,
    name: str,
    summary: str,
    outputs: tuple[Output, ...],
    guards: tuple[Guard, ...] = (),
) -> CFunction:
    """Return a function with the arguments that its outputs depend on."""
    everything = (symbols.q, symbols.n, *symbols.parameters.values())
    read = {symbol.name() for output in outputs for symbol in ca.symvar(output.value)}

    def reads(vector: Matrix) -> bool:
        return any(vector[i].name() in read for i in range(vector.numel()))

    parameters = tuple(key for key, symbol in symbols.parameters.items() if reads(symbol))
    guards = (*loops_closed(symbols.model.robot, symbols.q), *guards)
    return CFunction(name, summary, outputs, everything, reads(symbols.n), parameters, guards)


def parameters_of(robot: Robot) -> tuple[Parameter, ...]:
    """Return the fields of a robot's parameter struct."""
    rotors = "rotor inertia, reflected to the joint"
    gains = "proportional gain of the motor's controller"
    if not is_elastic(robot):
        return (
            Parameter("rotor_inertia", "kg m^2", f"{rotors}; may be 0", positive=False),
            Parameter("position_gain", "N m/rad", f"{gains}", positive=False),
        )
    return (
        Parameter("joint_stiffness", "N m/rad", "stiffness of the joint's spring", positive=True),
        Parameter("rotor_inertia", "kg m^2", rotors, positive=True),
        Parameter("position_gain", "N m/rad", f"{gains}", positive=False),
    )


def is_elastic(robot: Robot) -> bool:
    """Whether every joint gets a spring behind its motor.

    A robot with passive joints, loops or springs of its own describes its compliance itself.
    """
    plain = not robot.loops and not any(joint.stiffness for joint in robot.joints)
    return plain and all(robot.actuated)


def coordinates_of(robot: Robot) -> int:
    """Number of generalised coordinates."""
    return len(closed_chain(robot).independent) * (2 if is_elastic(robot) else 1)
