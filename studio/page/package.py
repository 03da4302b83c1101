# SPDX-License-Identifier: BSD-3-Clause
"""The C package of a page: the controller's, but that its contact point is a parameter.

``contact`` is where the point is, in the base's axes, and ``moved_by`` which joints move it: enough
for any point of any body. Two functions are for drawing: where bodies are, and how the end moves.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import casadi as ca
import numpy as np

from softimpact.codegen.functions import Symbols, coordinates_of, has_potential, links_of
from softimpact.codegen.functions.catalogue import moves_in_space
from softimpact.codegen.functions.description import CFunction, Output
from softimpact.codegen.functions.frames import frames_of
from softimpact.codegen.functions.guards import fastest_arrival, heaviest
from softimpact.codegen.functions.impact_factors import directional_factor, impact_factors
from softimpact.codegen.functions.reductions import reduced_model, reflected_mass
from softimpact.codegen.functions.symbols import function_over, symbols_of
from softimpact.codegen.inputs.defaults import Payload, defaults_of
from softimpact.codegen.inputs.directions import directions_of_motion
from softimpact.codegen.inputs.parameters import ANY, SHARE, Parameter, is_elastic, parameters_of
from softimpact.codegen.inputs.samples import Sample
from softimpact.codegen.package.generate import TIP
from softimpact.codegen.package.render import Package
from softimpact.codegen.record.manifest import FunctionRecord, ImpactRecord
from softimpact.codegen.sources.function import CSource
from softimpact.codegen.sources.impact import DEFAULT_BUDGET, HORIZON, PEAK_ERROR, ImpactSource
from softimpact.symbolic import (
    Drives,
    ImpactModel,
    InvalidValue,
    Matrix,
    Robot,
    frame_jacobian,
    frame_pose,
)
from softimpact.symbolic.dynamics.kinematics import placed_point_jacobian
from softimpact.symbolic.impact.impact_model import WEIGHTLESS
from softimpact.symbolic.impact.motors import REACTION_TIME
from softimpact.symbolic.robot.robot import BASE

PREFIX = "page"
"""Of the package's C names."""


@dataclass(frozen=True, eq=False)
class PlacedContact(ImpactModel):
    """A robot that is hit at a place that is given, not at a frame.

    Attributes:
        contact: where, base axes, length 3 [m].
        moved_by: 1 for each joint that moves it, else 0, length n.
    """

    contact: Matrix = (0.0, 0.0, 0.0)
    moved_by: Matrix = ()

    def jacobian(self, q: Any, axes_of: int = BASE) -> Any:
        """Return J of the point in the base's axes, whatever axes are asked for."""
        return placed_point_jacobian(self.robot, q, self.contact, self.moved_by)

    def direction_row(self, q: Matrix, direction: Matrix) -> Matrix:
        """Return nᵀJ over the links, 1×n."""
        return ca.mtimes(ca.reshape(direction, 1, 3), self.jacobian(q))


def page_package(robot: Robot, drives: Drives) -> Package:
    """Return the package of a robot's page.

    Args:
        robot: whose tip is where it holds its payload.
        drives: defaults of the parameters.

    Raises:
        InvalidValue: the robot is no open chain, or no contact is possible.
    """
    tip = robot.frame(robot.tip or "").name
    if robot.loops:
        raise InvalidValue("model", f"'{robot.name}' has closed loops; the page is for open chains")
    parameters = (*parameters_of(robot, payload=True), *_placed(robot))
    symbols = _symbols(robot, tip, parameters)
    at_tip = ImpactModel(symbols.robot, tip, symbols.model.drives, WEIGHTLESS)
    directions = directions_of_motion(replace(at_tip, robot=robot))
    if directions is None:
        raise InvalidValue("model", f"'{robot.name}' moves its tip in no direction of its own")
    functions = [reflected_mass(symbols), _end(symbols, tip)]
    if coordinates_of(robot) > 1:
        functions.append(reduced_model(symbols))
    if moves_in_space(replace(at_tip, robot=robot)):
        functions += [impact_factors(symbols), directional_factor(symbols)]
    if not is_elastic(robot):  # springs of its own: those that the page guesses are not for it
        drives = replace(drives, elastic=(False,) * robot.n)
    numbers = defaults_of(robot, parameters[: -len(_placed(robot))], drives, Payload())
    return Package(
        prefix=PREFIX,
        robot=robot,
        tip=tip,
        real="double",
        gravity=WEIGHTLESS,
        chain_order=1,
        parameters=parameters,
        defaults=numbers,
        functions=tuple(_source(robot, parameters, function) for function in functions),
        samples=2 * (_shown(robot, parameters),),
        tables={function.name: ((),) for function in functions},  # none to be tested against
        impact=ImpactSource(
            robot=robot,
            parameters=parameters,
            links=_source(robot, parameters, _links(symbols, tip)),
            points={TIP: tip},
            directions=directions,
            potential=has_potential(symbols),
            fastest=fastest_arrival(replace(at_tip, robot=robot)),
            heaviest=heaviest(robot),
            record=ImpactRecord((TIP,), 0, PEAK_ERROR, HORIZON, REACTION_TIME, DEFAULT_BUDGET),
            joint_frames=_source(robot, parameters, frames_of(symbols)),
            golden=(),
        ),
    )


def _placed(robot: Robot) -> tuple[Parameter, ...]:
    return (
        Parameter("contact", "m", "where the contact point is, base axes", ANY, (3,)),
        Parameter("moved_by", "", "1 for each joint that moves it, else 0", SHARE, (robot.n,)),
    )


def _symbols(robot: Robot, tip: str, parameters: tuple[Parameter, ...]) -> Symbols:
    plain = symbols_of(robot, tip, WEIGHTLESS, parameters)
    model, values = plain.model, plain.values
    placed = PlacedContact(
        model.robot, tip, model.drives, WEIGHTLESS, values["contact"], values["moved_by"]
    )
    return replace(plain, model=placed)


def _links(symbols: Symbols, tip: str) -> CFunction:
    """Return what impacts start from, with the Jacobian of the contact point that is given."""
    plain = links_of(symbols, (tip,))
    outputs = tuple(
        replace(o, value=ca.densify(symbols.model.jacobian(symbols.q))) if o.name == "J" else o
        for o in plain.outputs
    )
    built = function_over(symbols, plain.name, plain.summary, outputs)
    return replace(built, open_ended=True)


def _end(symbols: Symbols, tip: str) -> CFunction:
    pose = frame_pose(symbols.robot, tip, symbols.q)
    outputs = (
        Output("J", ca.densify(frame_jacobian(symbols.robot, tip, symbols.q)), "m, rad", ""),
        Output("position", ca.densify(pose.position), "m", "base axes"),
        Output("rotation", ca.densify(pose.rotation), "1", "base axes"),
    )
    return function_over(symbols, "end", "Where the end of the arm is, and how it moves.", outputs)


def _shown(robot: Robot, parameters: tuple[Parameter, ...]) -> Sample:
    """Return numbers for what nobody reads of a page's package: its README and its own test."""
    zeros = tuple((0.0,) * parameter.size for parameter in parameters)
    return Sample((0.0,) * robot.n, (0.0, 0.0, 1.0), zeros)


def _source(robot: Robot, parameters: tuple[Parameter, ...], function: CFunction) -> CSource:
    name = f"{PREFIX}_{function.name}"
    unmeasured = FunctionRecord(name, function.flops, function.sines_and_cosines, 0.0, 0.0, 0.0)
    return CSource(PREFIX, robot.n, parameters, function, unmeasured)


def ancestors(robot: Robot) -> list[list[float]]:
    """Return for each joint's body which joints move it, n×n."""
    table = np.zeros((robot.n, robot.n))
    for i in range(robot.n):
        table[i, robot.ancestors(i)] = 1.0
    return [list(map(float, row)) for row in table]
