# SPDX-License-Identifier: BSD-3-Clause
"""URDF files, link by link and joint by joint.

MuJoCo's own reader of URDF forgets mimic joints and speed limits, renames what occurs twice, and
stops at visuals; so a URDF is read here, and nothing in it but links and joints can stop it.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np

from ..errors import InvalidInertia, ModelFileError, UnknownName
from .constraints import Constraint, Coupling
from .description import WORLD, Description, RigidBody
from .rigid import Array, Inertia, Placement, frame_along, rotation_about_z, rotation_from_axis
from .robot import BASE, Joint, JointKind
from .xml_file import Element

MOVING = {
    "revolute": JointKind.HINGE,
    "continuous": JointKind.HINGE,
    "prismatic": JointKind.SLIDE,
}
"""Types of joints with one coordinate."""

TYPES = (*MOVING, "fixed", "floating", "planar")

READ = {
    "joint": {
        "origin", "parent", "child", "axis", "limit", "dynamics", "mimic", "safety_controller",
        "calibration",
    },
    "link": {
        "inertial", "visual", "collision", "contact", "collision_checking", "self_filter",
        "self_collision_checking", "origin", "sensor", "surface", "kinematic", "gravity",
    },
    "robot": {"link", "joint", "material", "gazebo", "transmission", "sensor", "self_filter"},
    "dynamics": {"damping", "friction", "armature"},
}  # fmt: skip
"""Elements (of dynamics: attributes) that are read, or that change no number of the robot."""

SPRINGS = {"springStiffness", "springReference", "implicitSpringDamper"}
"""Gazebo's words for springs at joints."""


def describe_urdf(root: Element, source: str) -> Description:
    """Return what a URDF describes.

    Args:
        root: its ``robot`` element.
        source: the file, for messages.

    Raises:
        ModelFileError: names that occur twice or not at all, links that do not form a tree,
            numbers that are not, reversed limits.
        InvalidInertia: a mass is negative or not finite.
    """
    return _Reader(root, source).description()


@dataclass(eq=False)
class _Reader:
    root: Element
    source: str
    warnings: list[str] = field(default_factory=list)

    def description(self) -> Description:
        links = self._named("link")
        joints = self._named("joint")
        self._name_unread()
        children: dict[str, list[Element]] = {name: [] for name in links}
        carried: dict[str, str] = {}
        for name, joint in joints.items():
            parent, child = self._ends(joint, name, links)
            if child in carried:
                raise self._error(
                    f"link '{child}' hangs on two joints, '{carried[child]}' and '{name}'; a URDF "
                    "is a tree, and MJCF closes loops with equality/connect"
                )
            carried[child] = name
            children[parent].append(joint)
        roots = [name for name in links if name not in carried]
        if not links:
            raise self._error("has no links")
        if not roots:
            raise self._error("has no root: its joints form a ring")
        if len(roots) > 1:
            self.warnings.append(f"has {len(roots)} roots: {', '.join(roots)}")
        bodies = [RigidBody("", BASE, Placement.identity(), Inertia.zero())]
        bodies += self._bodies(roots, children, links)
        if len(bodies) <= len(links):
            reached = {body.name for body in bodies}
            ring = next(name for name in links if name not in reached and name != "world")
            raise self._error(f"link '{ring}' is part of a ring of joints")
        mimics = tuple(self._mimics(joints))
        return Description(
            self.source,
            self.root.get("name") or "",
            tuple(bodies),
            constraints=mimics,
            warnings=tuple(self.warnings),
        )

    def _error(self, reason: str) -> ModelFileError:
        return ModelFileError(self.source, reason)

    def _named(self, tag: str) -> dict[str, Element]:
        found: dict[str, Element] = {}
        for element in self.root.all(tag):
            name = element.get("name")
            if not name:
                raise self._error(f"line {element.line}: a {tag} has no name")
            if name in found:
                raise self._error(
                    f"line {element.line}: two {tag}s go by '{name}'; the first is in line "
                    f"{found[name].line}"
                )
            found[name] = element
        return found

    def _name_unread(self) -> None:
        """Name elements that may change the robot and that nobody here reads."""
        unread: Counter[str] = Counter()
        for element in self.root.children:
            if element.tag not in READ["robot"]:
                unread[element.tag] += 1
            for child in element.children if element.tag in ("link", "joint") else ():
                if child.tag not in READ[element.tag]:
                    unread[f"{element.tag}/{child.tag}"] += 1
                for name in child.attributes if child.tag == "dynamics" else ():
                    if name not in READ["dynamics"]:
                        unread[f"dynamics {name}"] += 1
        for name, count in unread.items():
            often = f" ({count} times)" if count > 1 else ""
            self.warnings.append(f"'{name}' is not read{often}")
        if self.root.all("transmission"):
            self.warnings.append("transmissions are not read: every joint counts as having a motor")
        if any(_holds(element, SPRINGS) for element in self.root.all("gazebo")):
            self.warnings.append("Gazebo's springs at joints are not read")

    def _ends(self, joint: Element, name: str, links: Mapping[str, Element]) -> tuple[str, str]:
        ends = []
        for tag in ("parent", "child"):
            element = joint.first(tag)
            link = element.get("link") if element else None
            if link is None:
                raise self._error(f"joint '{name}' has no {tag} link")
            if link not in links:
                raise self._error(f"joint '{name}': its {tag} link '{link}' is not in the file")
            ends.append(link)
        return ends[0], ends[1]

    def _bodies(
        self,
        roots: list[str],
        children: Mapping[str, list[Element]],
        links: Mapping[str, Element],
    ) -> Iterator[RigidBody]:
        """Yield links depth first, as often nested as they may be."""
        index = {"": WORLD}
        waiting: list[tuple[str, str, Element | None]] = [("", root, None) for root in roots]
        waiting.reverse()
        count = WORLD
        while waiting:
            carrier, name, joint = waiting.pop()
            count += 1
            index[name] = count
            yield self._body(index[carrier], name, links[name], joint)
            for below in reversed(children[name]):
                child = below.first("child")
                waiting.append((name, str(child.get("link") if child else ""), below))

    def _body(self, carrier: int, name: str, link: Element, joint: Element | None) -> RigidBody:
        inertia = self._inertia(link, name)
        if joint is None:  # the world is the base itself and no frame of its own
            shown = "" if name == "world" else name
            return RigidBody(shown, carrier, Placement.identity(), inertia)
        joint_name = str(joint.get("name"))
        where = self._origin(joint, f"joint '{joint_name}'")
        kind = joint.get("type")
        if kind not in TYPES:
            raise UnknownName(f"type of joint '{joint_name}'", str(kind), TYPES)
        free = joint_name if kind == "floating" else None
        joints = tuple(self._joints(joint, joint_name, kind))
        return RigidBody(name, carrier, where, inertia, joints, free)

    def _joints(self, joint: Element, name: str, kind: str) -> Iterator[Joint]:
        if kind in MOVING:
            yield self._joint(joint, name, kind)
        elif kind == "planar":
            self.warnings.append(
                f"planar joint '{name}' counts as slides '{name}_x', '{name}_y' and hinge "
                f"'{name}_yaw', without motors"
            )
            R = frame_along(self._axis(joint, name), np.zeros(3)).rotation
            for suffix, part, axis in (
                ("x", JointKind.SLIDE, R[:, 0]),
                ("y", JointKind.SLIDE, R[:, 1]),
                ("yaw", JointKind.HINGE, R[:, 2]),
            ):
                place = frame_along(axis, np.zeros(3))
                yield Joint(f"{name}_{suffix}", part, BASE, place, Inertia.zero(), actuated=False)

    def _joint(self, joint: Element, name: str, kind: str) -> Joint:
        where = f"joint '{name}'"
        lower, upper = self._limits(joint, name, kind)
        limit, dynamics = joint.first("limit"), joint.first("dynamics")
        numbers = {}
        for tag in ("damping", "friction", "armature"):
            numbers[tag] = self._number(dynamics, tag, where, 0.0)
            if numbers[tag] < 0:
                raise self._error(f"{where}: {tag} is negative")
        return Joint(
            name,
            MOVING[kind],
            BASE,
            frame_along(self._axis(joint, name), np.zeros(3)),
            Inertia.zero(),
            lower=lower,
            upper=upper,
            armature=numbers["armature"],
            actuated=joint.first("mimic") is None,
            damping=numbers["damping"],
            friction=numbers["friction"],
            torque_limit=abs(self._number(limit, "effort", where, 0.0)) or math.inf,
            speed_limit=abs(self._number(limit, "velocity", where, 0.0)) or math.inf,
        )

    def _limits(self, joint: Element, name: str, kind: str) -> tuple[float, float]:
        limit = joint.first("limit")
        if kind == "continuous":
            return -math.inf, math.inf
        if limit is None or not {"lower", "upper"} & set(limit.attributes):
            self.warnings.append(f"{kind} joint '{name}' has no limits")
            return -math.inf, math.inf
        where = f"joint '{name}'"
        lower = self._number(limit, "lower", where, 0.0, unbounded=True)
        upper = self._number(limit, "upper", where, 0.0, unbounded=True)
        if lower > upper:
            raise self._error(f"{where}: its lower limit {lower:g} is above its upper {upper:g}")
        return lower, upper

    def _axis(self, joint: Element, name: str) -> Array:
        element = joint.first("axis")
        text = element.get("xyz") if element else None
        axis = np.array([1.0, 0.0, 0.0]) if text is None else self._three(text, f"joint '{name}'")
        if not np.linalg.norm(axis) > 0:
            raise self._error(f"joint '{name}': its axis has no direction")
        return axis

    def _mimics(self, joints: Mapping[str, Element]) -> Iterator[Constraint]:
        leaders: dict[str, str] = {}
        for name, joint in joints.items():
            mimic = joint.first("mimic")
            if mimic is None:
                continue
            if joint.get("type") not in MOVING:
                self.warnings.append(f"mimic of joint '{name}', which does not move, is ignored")
                continue
            leader = mimic.get("joint") or ""
            if leader not in joints or joints[leader].get("type") not in MOVING:
                self.warnings.append(
                    f"joint '{name}' mimics '{leader}', which does not move: it counts as its own"
                )
                continue
            leaders[name] = leader
            where = f"mimic of joint '{name}'"
            ratio = self._number(mimic, "multiplier", where, 1.0)
            offset = self._number(mimic, "offset", where, 0.0)
            yield Coupling(f"mimic {name}", ((name, 1.0),), ((leader, 1.0),), (offset, ratio))
        for name, leader in leaders.items():
            seen, at = {name}, leader
            while at in leaders:
                if at in seen:
                    raise self._error(f"joint '{name}' mimics itself")
                seen.add(at)
                at = leaders[at]

    def _inertia(self, link: Element, name: str) -> Inertia:
        inertial = link.first("inertial")
        if inertial is None:
            return Inertia.zero()
        where = f"link '{name}'"
        place = self._origin(inertial, where)
        weight, tensor = inertial.first("mass"), inertial.first("inertia")
        if weight is None or weight.get("value") is None:
            raise InvalidInertia(self.source, name, "its <inertial> has no <mass value=…>")
        mass = self._float(str(weight.get("value")), f"mass of {where}")
        if not math.isfinite(mass):
            raise InvalidInertia(self.source, name, "mass must be a finite number")
        if mass < 0:
            raise InvalidInertia(self.source, name, f"mass is negative ({mass:g} kg)")
        if tensor is None:
            self.warnings.append(f"{where} has a mass and no <inertia>: it counts as a point mass")
        xx, yy, zz, xy, xz, yz = (
            self._number(tensor, key, where, 0.0)
            for key in ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
        )
        about_com = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
        R = place.rotation
        return Inertia.from_center_of_mass(mass, place.translation, R @ about_com @ R.T)

    def _origin(self, element: Element, where: str) -> Placement:
        origin = element.first("origin")
        xyz = self._three(origin.get("xyz") or "0 0 0", where) if origin else np.zeros(3)
        rpy = self._three(origin.get("rpy") or "0 0 0", where) if origin else np.zeros(3)
        pitch = rotation_from_axis(np.array([0.0, 1.0, 0.0]), rpy[1])
        roll = rotation_from_axis(np.array([1.0, 0.0, 0.0]), rpy[0])
        return Placement(rotation_about_z(rpy[2]) @ pitch @ roll, xyz)

    def _three(self, text: str, where: str) -> Array:
        numbers = np.array([self._float(word, where) for word in text.split()])
        if numbers.shape != (3,):
            raise self._error(f"{where}: needs three numbers, not '{text}'")
        if not np.isfinite(numbers).all():
            kind = "NaN" if np.isnan(numbers).any() else "infinite"
            raise self._error(f"a number is {kind} ({where})")
        return numbers

    def _number(
        self,
        element: Element | None,
        name: str,
        where: str,
        default: float,
        *,
        unbounded: bool = False,
    ) -> float:
        text = element.get(name) if element else None
        if text is None:
            return default
        value = self._float(text, f"{where}: {name}")
        if math.isnan(value) or (math.isinf(value) and not unbounded and name not in UNLIMITED):
            kind = "NaN" if math.isnan(value) else "infinite"
            raise self._error(f"a number is {kind} ({where}: {name})")
        return value

    def _float(self, text: str, where: str) -> float:
        try:
            return float(text)
        except ValueError:
            raise self._error(f"{where}: '{text[:40]}' is not a number") from None


UNLIMITED = {"effort", "velocity"}
"""Numbers that may be infinite."""


def _holds(element: Element, tags: set[str]) -> bool:
    waiting = [element]
    while waiting:
        at = waiting.pop()
        if at.tag in tags:
            return True
        waiting += at.children
    return False
