# SPDX-License-Identifier: BSD-3-Clause
"""The symbols that all functions of a package share, and what a function reads of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property

import casadi as ca

from softimpact.symbolic import Drives, ImpactModel, Matrix, Robot, closed_chain, contact_mobility
from softimpact.symbolic.factors.contact_mobility import ContactMobility

from ..inputs.parameters import SCALARS, Parameter, is_elastic
from .description import CFunction, Guard, Output
from .guards import loops_closed


@dataclass(frozen=True, eq=False)
class Symbols:
    """A robot's model over symbols.

    Attributes:
        model: whose drives are the parameters.
        q: joint coordinates.
        n: direction of impact, a unit vector.
        parameters: all of the package, frozen ones too.
        values: symbols or frozen numbers of each parameter, symbols of each scalar, by name.
        inputs: symbols of all inputs in the order in which samples have them.
    """

    model: ImpactModel
    q: Matrix = field(repr=False)
    n: Matrix = field(repr=False)
    parameters: tuple[Parameter, ...]
    values: Mapping[str, Matrix] = field(repr=False)
    inputs: tuple[Matrix, ...] = field(repr=False)

    @property
    def robot(self) -> Robot:
        """Return the rigid robot with its payload."""
        return self.model.robot

    @cached_property
    def mass_matrix(self) -> Matrix:
        """M(q); like what follows derived once for all functions."""
        return self.model.mass_matrix(self.q)

    @cached_property
    def rotor_mass_matrix(self) -> Matrix:
        """M + B."""
        return self.model.rotor_mass_matrix(self.q)

    @cached_property
    def jacobian(self) -> Matrix:
        """J(q) in the base's axes."""
        return self.model.jacobian(self.q)

    @cached_property
    def mobility(self) -> ContactMobility:
        """J (M+B)⁻¹ Jᵀ, with rotors."""
        return contact_mobility(self.rotor_mass_matrix, self.jacobian)

    @cached_property
    def free_mobility(self) -> ContactMobility:
        """J M⁻¹ Jᵀ, without."""
        return contact_mobility(self.mass_matrix, self.jacobian)


def symbols_of(
    robot: Robot,
    tip: str,
    gravity: tuple[float, float, float],
    parameters: Sequence[Parameter],
) -> Symbols:
    """Return new symbols for a robot's package.

    Args:
        robot: any robot.
        tip: contact frame.
        gravity: as in ``generate_package``.
        parameters: of the package, see ``parameters_of`` and ``freeze``.
    """
    n = robot.n
    q, direction = ca.SX.sym("q", n), ca.SX.sym("n", 3)
    symbols: dict[str, Matrix] = {
        p.name: ca.SX.sym(p.name, p.size) for p in (*parameters, *SCALARS)
    }
    known = {p.name: ca.DM(p.frozen) for p in parameters if p.frozen is not None}
    values: dict[str, Matrix] = {**symbols, **known}
    motors = ca.sparsify(ca.DM([float(a) for a in robot.actuated]))
    drives = Drives(
        values["rotor_inertia"],
        values.get("joint_stiffness", ca.SX(n, 1)),
        (is_elastic(robot),) * n,
        values["position_gain"] * motors,
    )
    if "payload_mass" in values:
        robot = robot.with_payload(tip, values["payload_mass"], values["payload_com"])
    model = ImpactModel(robot, tip, drives, gravity)
    return Symbols(
        model, q, direction, tuple(parameters), values, (q, direction, *symbols.values())
    )


def function_over(
    symbols: Symbols,
    name: str,
    summary: str,
    outputs: tuple[Output, ...],
    guards: tuple[Guard, ...] = (),
) -> CFunction:
    """Return a function with the arguments that its outputs depend on."""
    read = {symbol.name() for output in outputs for symbol in ca.symvar(ca.SX(output.value))}

    def reads(vector: Matrix) -> bool:
        return any(vector[i].name() in read for i in range(vector.numel()))

    def chosen(inputs: Sequence[Parameter]) -> tuple[Parameter, ...]:
        fields = (p for p in inputs if p.frozen is None)
        return tuple(p for p in fields if reads(symbols.values[p.name]))

    return CFunction(
        name,
        summary,
        outputs,
        symbols.inputs,
        reads(symbols.n),
        chosen(symbols.parameters),
        chosen(SCALARS),
        (*loops_closed(symbols.robot, symbols.q), *guards),
    )


def coordinates_of(robot: Robot) -> int:
    """Number of generalised coordinates."""
    return len(closed_chain(robot).independent) * (2 if is_elastic(robot) else 1)
