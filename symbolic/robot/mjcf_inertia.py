# SPDX-License-Identifier: BSD-3-Clause
"""Inertias of MJCF bodies as MuJoCo counts them, before anyone judges them.

MuJoCo's compiler refuses a model for the inertia of a body that may be welded to the ground or to
a heavier one. So it never sees what the file says of inertias: it gets stand-ins, and the numbers
are composed here. Where they come from shapes or meshes, it measures these in a second copy.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path

import mujoco
import numpy as np

from ..errors import InvalidInertia
from .rigid import Array, Inertia, Placement, product

MEASURED = range(int(mujoco.mjtGeom.mjGEOM_SPHERE), int(mujoco.mjtGeom.mjGEOM_MESH))
"""Geoms that have a volume and need no file."""

NO_TOTAL = -1.0
"""MuJoCo's ``settotalmass`` where masses are as they are."""

Missing = dict[str, list[str]]
"""By body, what of its inertia is not known."""


@dataclass(frozen=True)
class Rules:
    """How a file wants inertias counted: attributes of MJCF's ``compiler``."""

    always_from_geoms: bool
    never_from_geoms: bool
    groups: tuple[int, int]
    least_mass: float
    least_moment: float
    balance: bool
    total_mass: float

    @staticmethod
    def of(compiler: mujoco.MjsCompiler) -> Rules:
        """Read them."""
        source = int(compiler.inertiafromgeom)
        low, high = (int(group) for group in compiler.inertiagrouprange)
        return Rules(
            source == int(mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_TRUE),
            source == int(mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_FALSE),
            (low, high),
            float(compiler.boundmass),
            float(compiler.boundinertia),
            bool(compiler.balanceinertia),
            float(compiler.settotalmass),
        )

    @property
    def bounds(self) -> bool:
        """Whether every body gets some mass or inertia."""
        return self.least_mass > 0 or self.least_moment > 0

    def counts(self, geom: mujoco.MjsGeom) -> bool:
        """Whether a geom gives its body mass, where geoms do."""
        if not self.groups[0] <= int(geom.group) <= self.groups[1]:
            return False
        has_volume = int(geom.type) in MEASURED or bool(geom.meshname)
        weight = geom.density if math.isnan(geom.mass) else geom.mass
        return has_volume and weight != 0


def body_inertias(
    spec: mujoco.MjSpec, parse: Callable[[], mujoco.MjSpec], source: str
) -> tuple[list[mujoco.MjsBody], Mapping[int, Array], Mapping[int, Inertia], Rules]:
    """Take the inertias out of a spec, so that its compiler has nothing to refuse.

    Args:
        spec: gets a stand-in for every body's inertia.
        parse: reads the same file again, into a copy of which shapes are all that stays.
        source: the file, for messages.

    Returns:
        The spec's bodies; by a body's place among them the tensor that it states, in the axes of
        its inertial frame (principal moments on a diagonal); likewise what its shapes give it,
        in the body's frame; and the rules of the file.

    Raises:
        InvalidInertia: a mass is negative or not finite.
    """
    rules = Rules.of(spec.compiler)
    bodies = list(spec.bodies)
    stated: dict[int, Array] = {}
    from_geoms: set[int] = set()
    for place, body in enumerate(bodies[1:], start=1):
        _require_mass(body, source)
        explicit = bool(body.explicitinertial)
        by_geoms = rules.always_from_geoms or not (explicit or rules.never_from_geoms)
        if by_geoms and any(rules.counts(geom) for geom in body.geoms):
            from_geoms.add(place)
        elif explicit:
            stated[place] = _tensor(body)
        elif rules.bounds:
            stated[place] = np.zeros(10)  # what MuJoCo raises to the bounds, where it puts it
        _stand_in(body, place in stated)
    spec.compiler.inertiafromgeom = mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_FALSE
    spec.compiler.boundmass = spec.compiler.boundinertia = 0.0
    spec.compiler.balanceinertia, spec.compiler.settotalmass = False, NO_TOTAL
    measured = _measured(parse, from_geoms, rules) if from_geoms else {}
    return bodies, stated, measured, rules


def _require_mass(body: mujoco.MjsBody, source: str) -> None:
    if not math.isfinite(body.mass):
        raise InvalidInertia(source, body.name, "mass must be a finite number")
    if body.mass < 0:
        raise InvalidInertia(source, body.name, f"mass is negative ({body.mass:g} kg)")


def _tensor(body: mujoco.MjsBody) -> Array:
    """Mass and tensor that a body's inertial element states, length 10: m, then 3×3."""
    full = np.array(body.fullinertia, dtype=float)
    if math.isnan(full[0]):
        tensor = np.diag(np.array(body.inertia, dtype=float))
    else:
        xx, yy, zz, xy, xz, yz = full
        tensor = np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    return np.array([float(body.mass), *tensor.flat])


def _stand_in(body: mujoco.MjsBody, keeps_its_frame: bool) -> None:
    body.mass, body.inertia, body.fullinertia = 1.0, [1.0, 1.0, 1.0], [math.nan] + [0.0] * 5
    if not keeps_its_frame:
        body.ipos, body.iquat = [0.0] * 3, [1.0, 0.0, 0.0, 0.0]
        body.ialt.type = mujoco.mjtOrientation.mjORIENTATION_QUAT
    body.explicitinertial = True


def _measured(
    parse: Callable[[], mujoco.MjSpec], wanted: set[int], rules: Rules
) -> dict[int, Inertia]:
    """Let MuJoCo weigh the shapes of bodies, by their place in the file."""
    try:
        return _weighed(parse(), wanted, rules)
    except ValueError as error:  # a mesh without volume, or one that it cannot read
        return _weighed(parse(), wanted, rules, " ".join(str(error).split()))


def _weighed(
    spec: mujoco.MjSpec, wanted: set[int], rules: Rules, no_meshes: str = ""
) -> dict[int, Inertia]:
    bodies = list(spec.bodies)
    missing: dict[int, list[str]] = {place: [] for place in wanted}
    _leave_shapes(spec)
    _leave_what_counts(spec, bodies, missing, rules, no_meshes)
    for place, body in enumerate(bodies[1:], start=1):
        body.explicitinertial = False
        if place not in wanted or not list(body.geoms):
            _stand_in(body, False)
    model = spec.compile()
    found = {}
    for place in wanted:
        inertia = Inertia.zero()
        if list(bodies[place].geoms):
            i = bodies[place].id
            frame = placement(model.body_ipos[i], model.body_iquat[i])
            moments = np.diag(model.body_inertia[i])
            inertia = about_frame(float(model.body_mass[i]), moments, frame)
        found[place] = replace(inertia, missing=tuple(missing[place]))
    return found


def _leave_what_counts(
    spec: mujoco.MjSpec,
    bodies: list[mujoco.MjsBody],
    missing: dict[int, list[str]],
    rules: Rules,
    no_meshes: str,
) -> None:
    """Take out geoms that give no inertia, and name meshes that are not there, or not good."""
    meshes = {mesh.name: mesh for mesh in spec.meshes}
    used: set[str] = set()
    for place, geom in [(place, geom) for place, b in enumerate(bodies) for geom in b.geoms]:
        mesh = meshes.get(geom.meshname) if geom.meshname else None
        counts = place in missing and rules.counts(geom)
        if counts and geom.meshname:
            fault = no_meshes or _absence(spec, mesh)
            counts = fault is None
            if fault is not None:
                words = f"takes its inertia from a mesh ('{geom.meshname}', {fault})"
                missing[place].append(f"body '{bodies[place].name}' {words}")
        if not counts:
            spec.delete(geom)
            continue
        geom.material = ""
        if mesh is not None:
            used.add(mesh.name)
    for mesh in list(spec.meshes):
        if mesh.name not in used:
            spec.delete(mesh)


def _leave_shapes(spec: mujoco.MjSpec) -> None:
    """Take out all but bodies, joints, shapes and meshes."""
    users = (spec.sensors, spec.sites, spec.lights)  # of others, or of materials and textures
    groups = (*users, spec.actuators, spec.equalities, spec.tendons, spec.pairs, spec.excludes)
    files = (spec.skins, spec.flexes, spec.hfields, spec.materials, spec.textures)
    for group in (*groups, spec.keys, *files, spec.tuples):
        for item in list(group):
            spec.delete(item)
    spec.compiler.settotalmass, spec.compiler.fusestatic = NO_TOTAL, False
    spec.compiler.balanceinertia = True  # judged later, over whole rigid groups
    spec.compiler.discardvisual = False


def _absence(spec: mujoco.MjSpec, mesh: mujoco.MjsMesh | None) -> str | None:
    """Say why a mesh is not there."""
    if mesh is None:
        return "which is not in the file"
    if not mesh.file:
        return None  # its vertices are in the file
    path = Path(str(spec.modelfiledir)) / str(spec.meshdir) / str(mesh.file)
    return None if path.is_file() else f"file '{mesh.file}' is not there"


def placement(position: Array, quaternion: Array) -> Placement:
    """Return the placement of a frame as MuJoCo writes it."""
    rotation = np.zeros(9)
    mujoco.mju_quat2Mat(rotation, np.asarray(quaternion, dtype=float))
    return Placement(rotation.reshape(3, 3), position)


def about_frame(mass: float, tensor: Array, frame: Placement) -> Inertia:
    """Inertia from a tensor about the centre of mass, in the axes of a frame that lies there."""
    R = frame.rotation
    turned = product(product(R, tensor), R.T)
    return Inertia.from_center_of_mass(mass, frame.translation, turned)


def stated_inertia(numbers: Array, frame: Placement, rules: Rules) -> Inertia:
    """Return what an inertial element states, within the bounds that the file sets."""
    mass, tensor = float(numbers[0]), numbers[1:].reshape(3, 3)
    if rules.least_mass > 0:
        mass = max(mass, rules.least_mass)
    if rules.least_moment > 0 or rules.balance:
        moments, axes = np.linalg.eigh(tensor)
        moments = np.maximum(moments, rules.least_moment) if rules.least_moment > 0 else moments
        if rules.balance and moments[0] + moments[1] < moments[2]:
            moments = np.full(3, moments.mean())
        tensor = product(product(axes, np.diag(moments)), axes.T)
    return about_frame(mass, tensor, frame)


def scaled(inertia: Inertia, factor: float) -> Inertia:
    """Return the inertia of the same body at another density."""
    return Inertia(
        factor * inertia.mass,
        factor * inertia.first_moment,
        factor * inertia.about_origin,
        inertia.missing,
    )
