# SPDX-License-Identifier: BSD-3-Clause
"""Impacts of a package: what its runtime starts from, and golden results."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from softimpact.symbolic import Frame, JointKind, Robot, closed_chain
from softimpact.symbolic.body.verdict import QUASI_STATIC_FROM
from softimpact.symbolic.impact.motors import REACTION_TIME
from softimpact.symbolic.robot.rigid import Array

from ..functions import Symbols, has_potential, links_of
from ..functions.frames import frames_of
from ..functions.guards import fastest_arrival, heaviest
from ..inputs.directions import directions_of_motion
from ..inputs.parameters import Parameter, is_elastic
from ..inputs.regions import BuiltIn
from ..record.manifest import FunctionRecord, ImpactRecord
from ..record.searched import searched
from ..verification.impacts import Impact, draw_impacts, reference_force
from .function import CSource

GOLDEN_IMPACTS = 12
"""Impacts in a package's own test."""

PEAK_ERROR = 2e-3
"""Bound stated of the error of peak forces, in double and in float."""

HORIZON = QUASI_STATIC_FROM
"""Default time in which forces count [s]: what a transient limit is stated for."""

DEFAULT_BUDGET = 800
"""Default budget of steps of a call."""


NOT_MEASURED = FunctionRecord("", 0, 0, 0.0, 0.0, 0.0)
"""Record of a function whose errors nobody asks for, or only in what is made of it."""

UNLIMITED = "servos have whatever torque their gains ask for, and so press harder than limited ones"

STEADY = "motors go on with the torque that the joints' own damping took before the impact"


@dataclass(frozen=True, eq=False)
class ImpactSource:
    """What the templates need for impacts.

    Attributes:
        robot: the rigid robot.
        parameters: all of the package.
        links: the internal function they start from.
        points: frames of the contact points by name; the first, ``tip``, is the package's own.
        directions: in which motors move the contact points, as rows.
        potential: whether gravity or springs of the model file pull.
        fastest: squared joint velocity for 1 m/s from which on an arrival is singular.
        heaviest: mass felt from which on it is.
        record: what the manifest says.
        joint_frames: where joints' frames are, for contact points given at run time; None for
            closed chains, whose links move as their loops let them.
        golden: impacts and the right peak forces [N].
    """

    robot: Robot
    parameters: tuple[Parameter, ...]
    links: CSource
    points: Mapping[str, str]
    directions: Array
    potential: bool
    fastest: float
    heaviest: float
    record: ImpactRecord
    joint_frames: CSource | None
    golden: tuple[tuple[Impact, float], ...]

    @property
    def independent(self) -> tuple[int, ...]:
        """Indices of the joints whose coordinates describe the robot."""
        return closed_chain(self.robot).independent

    @property
    def motors(self) -> list[bool]:
        """Which of these have a motor."""
        return [self.robot.actuated[i] for i in self.independent]

    @property
    def frames(self) -> dict[str, Frame]:
        """Frames that move, by names that C can have."""
        if self.joint_frames is None:
            return {}
        found: dict[str, Frame] = {}
        for frame in self.robot.frames.values():
            short = re.sub(r"\W+", "_", frame.name, flags=re.ASCII).strip("_").lower() or "frame"
            taken = short in found
            if frame.joint >= 0:
                found[f"{short}_{len(found)}" if taken else short] = frame
        return found

    @property
    def slides(self) -> list[bool]:
        """Which joints slide."""
        return [joint.kind is JointKind.SLIDE for joint in self.robot.joints]

    @property
    def moves(self) -> list[list[bool]]:
        """Whether a joint, a row each, moves the link of another."""
        n = self.robot.n
        above = [set(self.robot.ancestors(link)) for link in range(n)]
        return [[joint in above[link] for link in range(n)] for joint in range(n)]

    @property
    def damping(self) -> list[float]:
        """Damping of these joints' own [N·m·s/rad]."""
        return [float(self.robot.damping[i]) for i in self.independent]

    @property
    def damped(self) -> bool:
        """Whether any of these joints has damping of its own."""
        return any(self.damping)

    @property
    def elastic(self) -> bool:
        """Whether every joint has a spring behind its motor."""
        return is_elastic(self.robot)

    @property
    def frozen(self) -> list[Parameter]:
        """Frozen parameters that impacts read; the model's table holds them."""
        read = ("joint_stiffness", "rotor_inertia", "position_gain", "damping_gain")
        return [p for p in self.parameters if p.frozen is not None and p.name in read]


def impact_source(
    prefix: str,
    symbols: Symbols,
    points: Mapping[str, str],
    golden: int = GOLDEN_IMPACTS,
    contacts: Sequence[BuiltIn] = (),
) -> ImpactSource | None:
    """Return the impacts of a robot.

    None where there are none: if the contact point's directions of motion depend on the
    configuration, if motors turn joints that follow from others, or if the robot arrives nowhere.

    Args:
        prefix: of the C names.
        symbols: of the robot's package.
        points: frames of the contact points by name, the package's tip first.
        golden: how many golden impacts there should be; with none of them nobody looks whether
            the robot arrives anywhere.
        contacts: built in, of which each has a golden impact of its own.
    """
    robot, parameters = symbols.robot, symbols.parameters
    directions = directions_of_motion(symbols.model)
    independent = closed_chain(robot).independent
    led = any(a and i not in independent for i, a in enumerate(robot.actuated))
    if directions is None or led:
        return None
    links = links_of(symbols, tuple(points.values()))
    fastest, heavy = fastest_arrival(symbols.model), heaviest(robot)

    def first(count: int, drawn: Iterable[Impact]) -> Iterator[tuple[Impact, float]]:
        """Yield the first that are regular, with their forces."""
        for impact in drawn:
            force = reference_force(symbols, links, impact, directions, fastest, heavy)
            if count > 0 and force is not None:
                count -= 1
                yield impact, float(f"{force:.6g}")
            if count == 0:
                return

    found = [*first(golden, draw_impacts(robot, parameters, directions, 4 * golden, seed=3))]
    if golden and not found:
        return None
    for i, body in enumerate(contacts if golden else ()):
        drawn = draw_impacts(robot, parameters, directions, 4 * golden, seed=4 + i)
        covered = (replace(impact, contact=body.contact, built_in=i) for impact in drawn[i % 4 :])
        found += first(1, covered)
    record = ImpactRecord(
        points=tuple(points),
        flops=links.flops,
        accuracy=PEAK_ERROR,
        horizon=HORIZON,
        reaction_time=REACTION_TIME,
        steps=DEFAULT_BUDGET,
        searched=searched(),
        assumed=(UNLIMITED, *([STEADY] if robot.damping.any() else [])),
    )
    return ImpactSource(
        robot=robot,
        parameters=tuple(parameters),
        links=CSource(prefix, robot.n, parameters, links, NOT_MEASURED),
        points=points,
        directions=directions,
        potential=has_potential(symbols),
        fastest=fastest,
        heaviest=heavy,
        record=record,
        joint_frames=None
        if robot.loops
        else CSource(prefix, robot.n, parameters, frames_of(symbols), NOT_MEASURED),
        golden=tuple(found),
    )
