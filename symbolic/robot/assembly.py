# SPDX-License-Identifier: BSD-3-Clause
"""From a description to a robot: find its tree and its base, and compose what moves together."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Literal

from ..errors import ModelFileError, UnsupportedModel
from .constraints import Ball, Constraint, Coupling, Loop, Through, Weld
from .description import WORLD, Description, RigidBody
from .rigid import Inertia, Placement
from .robot import BASE, Frame, Joint, Robot

Base = Literal["fixed", "held", "free"]
"""Base of a robot: as in its file; held where the file lets it float; or itself the reference, for
a robot that floats."""


def assemble(description: Description, tip: str | None, base: Base) -> Robot:
    """Return the robot of a description.

    Bodies that float beside the robot are put where the file has them.

    Args:
        description: of any format.
        tip: frame whose tree is the robot; None takes the tree with the most joints.
        base: see ``Base``.

    Raises:
        ModelFileError: there is no joint, or two joints have one name.
        UnsupportedModel: the robot floats and ``base`` is "fixed".
    """
    return _Assembly(description, tip, base).robot()


class _Assembly:
    def __init__(self, description: Description, tip: str | None, base: Base) -> None:
        self.description, self.bodies = description, description.bodies
        self.roots = _roots(self.bodies)
        self.main = self._main(tip)
        self.base = base
        self.warnings = list(description.warnings)
        self.joints: list[Joint] = []
        self.inertias: list[Inertia] = []
        self.base_inertia = Inertia.zero()
        self.carriers: dict[int, tuple[int, Placement]] = {}

    def robot(self) -> Robot:
        given = self.description
        self._settle_free_bodies()
        for i, body in enumerate(self.bodies):
            self._add(i, body)
        if not self.joints and not self._main_floats:
            raise ModelFileError(given.source, "has no joints")
        joints = tuple(
            replace(joint, inertia=inertia)
            for joint, inertia in zip(self.joints, self.inertias, strict=True)
        )
        frames = self._frames()
        constraints = tuple(self._constraints(frames))
        names = [joint.name for joint in joints]
        home = None
        if any(isinstance(loop, Loop) for loop in constraints) and given.home is not None:
            home = tuple(given.home.get(name, 0.0) for name in names)
        return Robot(
            given.name or Path(given.source).stem,
            joints,
            frames,
            None,
            given.rotor_inertia_sets,
            constraints,
            home,
            given.independent,
            self.base_inertia,
            tendons=given.tendons,
            source=given.source,
            rotors_stated=given.rotors_stated,
            warnings=tuple(dict.fromkeys(self.warnings)),
        )

    def _main(self, tip: str | None) -> int:
        """Root of the tree that is the robot."""
        if tip is not None:
            named = {body.name: i for i, body in enumerate(self.bodies)}
            named |= {site.name: site.joint for site in self.description.sites}
            carrier = named.get(tip, named.get(tip.partition("@")[0]))
            if carrier is not None:
                return self.roots[carrier]
        count: dict[int, float] = {}
        for i, body in enumerate(self.bodies):
            floats = 0.5 * (body.free_joint is not None)  # a thing, where others are robots
            count[self.roots[i]] = count.get(self.roots[i], 0.0) + len(body.joints) + floats
        return max(count, key=lambda root: count[root])

    def _settle_free_bodies(self) -> None:
        beside = []
        for i, body in enumerate(self.bodies):
            if body.free_joint is None:
                continue
            if self.roots[i] != self.main:
                beside.append(body.name)
            elif self.base == "fixed":
                raise UnsupportedModel(
                    self.description.source,
                    f"joint '{body.free_joint}' is a free joint; hold the robot's base "
                    "by --hold-base or hold_base=True, or free it by --floating or floating=True",
                )
        if self.base == "held" and not self._main_floats:
            self.warnings.append("the file holds the base already: hold_base changes nothing")
        if beside:
            names = ", ".join(f"'{name}'" for name in beside)
            self.warnings.append(f"free bodies beside the robot do not count: {names}")

    def _add(self, i: int, body: RigidBody) -> None:
        """Add a body's joints, and its inertia to what carries it."""
        if i == WORLD:
            self.carriers[i] = (BASE, Placement.identity())
            self._add_inertia(i, BASE, body.inertia)
            return
        carrier, pose = self.carriers[body.carrier]
        floats = self.base == "free" and body.free_joint is not None and self.roots[i] == self.main
        pose = Placement.identity() if floats else pose @ body.placement
        for joint in body.joints:
            self.joints.append(replace(joint, parent=carrier, placement=pose @ joint.placement))
            self.inertias.append(Inertia.zero())
            carrier, pose = len(self.joints) - 1, joint.placement.inverse()
        self.carriers[i] = (carrier, pose)
        self._add_inertia(i, carrier, body.inertia.seen_from(pose))

    def _add_inertia(self, i: int, carrier: int, inertia: Inertia) -> None:
        if carrier != BASE:
            self.inertias[carrier] += inertia
        elif self.base != "free" or not self._main_floats or self.roots[i] == self.main:
            self.base_inertia += inertia

    @property
    def _main_floats(self) -> bool:
        return any(
            body.free_joint is not None and self.roots[i] == self.main
            for i, body in enumerate(self.bodies)
        )

    def _frames(self) -> dict[str, Frame]:
        found = {}
        for i, body in enumerate(self.bodies):
            if body.name:
                found[body.name] = Frame(body.name, *self.carriers[i])
        for site in self.description.sites:
            carrier, pose = self.carriers[site.joint]
            found[site.name] = Frame(site.name, carrier, pose @ site.placement)
        return found

    def _constraints(self, frames: Mapping[str, Frame]) -> Iterator[Constraint]:
        """Yield what ties joints; welds to what does not count are named and left out."""
        outside = {
            body.name
            for i, body in enumerate(self.bodies)
            if body.target or (body.free_joint is not None and self.roots[i] != self.main)
        }
        names = {joint.name for joint in self.joints}
        for constraint in self.description.constraints:
            if isinstance(constraint, Coupling | Ball | Through):
                if set(constraint.joints) <= names:
                    yield constraint
                continue
            ends = (constraint.first, constraint.second)
            if any(end.partition("@")[0] in outside for end in ends):
                self.warnings.append(
                    f"'{constraint.name}' ties the robot to what stands beside it: ignored"
                )
            elif isinstance(constraint, Weld) and len({frames[end].joint for end in ends}) == 1:
                continue  # they move as one without it
            else:
                yield constraint


def _roots(bodies: tuple[RigidBody, ...]) -> list[int]:
    """For each body the one of its carriers that stands on the world."""
    roots = [WORLD]
    for i, body in enumerate(bodies[1:], start=1):
        roots.append(i if body.carrier == WORLD else roots[body.carrier])
    return roots
