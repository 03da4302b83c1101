# SPDX-License-Identifier: BSD-3-Clause
"""MJCF files: parsed and resolved by MuJoCo, with nothing in them for its compiler to refuse."""

from __future__ import annotations

import math
import warnings
from collections import Counter
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np

from ..errors import ModelFileError, UnknownName
from .constraints import Ball
from .description import Description, RigidBody
from .mjcf_drives import Actuation, actuation_of
from .mjcf_equalities import constraints_of
from .mjcf_inertia import Rules, body_inertias, placement, scaled, stated_inertia
from .mjcf_joints import require_sound_joints, set_spring_dampers
from .mjcf_paths import BALL, EACH_AXIS, names_of
from .rigid import Array, Inertia, frame_along
from .robot import BASE, Frame, Joint, JointKind

ROTOR_SET = "rotor_inertia:"
"""Prefix of the ``custom/numeric`` elements that hold named sets of rotor inertias."""

SPEED_LIMIT = "speed_limit"
"""Name of the one that holds the joints' largest speeds, for which MJCF has no place."""

NAMELESS = "MuJoCo Model"
"""What MuJoCo calls a model without a name."""

FREE, SLIDE, HINGE = (
    int(getattr(mujoco.mjtJoint, f"mjJNT_{kind}")) for kind in ("FREE", "SLIDE", "HINGE")
)


def read_mjcf(path: Path) -> Description:
    """Read a robot from MJCF.

    Raises:
        ModelFileError: it is not MJCF, or MuJoCo cannot resolve it.
        InvalidInertia: a mass is negative or not finite.
        UnsupportedModel: springs that are not linear, or known by their time constant in a file
            whose masses MuJoCo does not accept.
    """
    with _warnings() as heard:
        spec = _parsed(path)
        keys = [[float(x) for x in key.qpos] for key in spec.keys[:1]]
        require_sound_joints(spec, str(path))
        set_spring_dampers(spec, lambda: _parsed(path), str(path))
        try:
            bodies, stated, measured, rules = body_inertias(spec, lambda: _parsed(path), str(path))
            unread = _cleared(spec)
            if any("NaN" in warning for warning in heard):
                raise ModelFileError(str(path), "a number is NaN")
            model = spec.compile()
        except ValueError as error:
            raise ModelFileError(str(path), one_line(error)) from None
    _require_finite(model, path)
    inertias = _by_compiled_body(model, bodies, stated, measured, rules)
    return _Reader(model, path, inertias, unread, keys).description()


@contextmanager
def _warnings() -> Iterator[list[str]]:
    """Collect MuJoCo's warnings; left alone it appends them to a log in the working directory."""
    heard: list[str] = []
    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(heard.append)
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of the inertias that stand in for the file's
            yield heard
    finally:
        mujoco.set_mju_user_warning(before)


def _parsed(path: Path) -> mujoco.MjSpec:
    try:
        spec = mujoco.MjSpec.from_file(str(path))
    except ValueError as error:
        words = one_line(error)
        if "decoder" in words:  # MuJoCo goes by the name
            words = "it is no XML, nor does its name end in .urdf, .xml or .xacro"
        raise ModelFileError(str(path), f"not a URDF or MJCF: {words}") from None
    spec.compiler.fusestatic = False
    if hasattr(spec.compiler, "alignfree"):  # frames of bodies stay where the file has them
        spec.compiler.alignfree = False
        for joint in spec.joints:
            joint.align = mujoco.mjtAlignFree.mjALIGNFREE_FALSE
    return spec


def one_line(error: Exception) -> str:
    """Return an error's words without line breaks."""
    return " ".join(str(error).split())


def _cleared(spec: mujoco.MjSpec) -> list[str]:
    """Drop what only rendering, contact and sensors need, and with it every file beside it."""
    unread = ["soft bodies (flex) do not count"] if list(spec.flexes) else []
    for item in (*spec.geoms, *spec.sites, *spec.tendons):
        item.material = ""
    for geom in [geom for geom in spec.geoms if geom.meshname or geom.hfieldname]:
        spec.delete(geom)
    files = (spec.skins, spec.flexes, spec.meshes, spec.hfields, spec.materials, spec.textures)
    for group in (
        spec.sensors,
        spec.lights,
        *files,
        spec.pairs,
        spec.excludes,
        spec.tuples,
        spec.keys,
    ):
        for item in list(group):
            spec.delete(item)
    return unread


def _require_finite(model: mujoco.MjModel, path: Path) -> None:
    try:
        model.names.decode()
    except UnicodeDecodeError:
        raise ModelFileError(str(path), "its names are not in UTF-8") from None
    of_bodies = (model.body_pos, model.body_quat, model.body_ipos, model.site_pos)
    of_joints = (model.jnt_pos, model.jnt_axis, model.jnt_stiffness, model.qpos0)
    of_dofs = (model.qpos_spring, model.dof_armature, model.dof_damping, model.dof_frictionloss)
    of_ties = (model.eq_data, model.wrap_prm, model.tendon_lengthspring)
    if not all(np.isfinite(array).all() for array in (*of_bodies, *of_joints, *of_dofs, *of_ties)):
        raise ModelFileError(str(path), "a number is infinite")


def _by_compiled_body(
    model: mujoco.MjModel,
    bodies: list[mujoco.MjsBody],
    stated: Mapping[int, Array],
    measured: Mapping[int, Inertia],
    rules: Rules,
) -> list[Inertia]:
    """Inertias in their bodies' frames, in the compiled order."""
    found = [Inertia.zero()] * model.nbody
    for place, body in enumerate(bodies):
        i = int(body.id)
        if place in measured:
            found[i] = measured[place]
        elif place in stated:
            frame = placement(model.body_ipos[i], model.body_iquat[i])
            found[i] = stated_inertia(stated[place], frame, rules)
    if rules.total_mass > 0:
        factor = rules.total_mass / sum(inertia.mass for inertia in found)
        found = [scaled(inertia, factor) for inertia in found]
    return found


class _Reader:
    """Turns a compiled model's arrays into a description."""

    def __init__(
        self,
        model: mujoco.MjModel,
        path: Path,
        inertias: list[Inertia],
        unread: list[str],
        keys: list[list[float]],
    ) -> None:
        self.model, self.path, self.inertias, self.keys = model, path, inertias, keys
        self.motors: Actuation = actuation_of(model)
        self.ties = constraints_of(model, self.joint_name, self.site_name, self.body_name)
        self.balls: list[Ball] = []
        self.values = self._values_of_joints()
        movable = [j for j in range(model.njnt) if int(model.jnt_type[j]) != FREE]
        speeds = self.values.get(SPEED_LIMIT, (math.inf,) * len(movable))
        self.speed_limits = dict(zip(movable, speeds, strict=True))
        self.warnings = [*unread, *self.motors.warnings, *self.ties.warnings]

    def description(self) -> Description:
        """Walk the bodies, which MuJoCo keeps parents before children."""
        model = self.model
        bodies = tuple(self._body(i) for i in range(model.nbody))
        names = [joint.name for body in bodies for joint in body.joints]
        twice = [name for name, count in Counter(names).items() if count > 1]
        if twice:
            raise ModelFileError(str(self.path), f"two joints go by '{twice[0]}'; name every joint")
        texts = _custom_texts(model)
        name = model.names.split(b"\0")[0].decode()
        return Description(
            str(self.path),
            "" if name == NAMELESS else name,
            bodies,
            (*self._sites(), *self.ties.anchors),
            (*self.ties.constraints, *self.balls, *self.motors.through),
            self.motors.tendons,
            texts.get("tip"),
            {
                key.removeprefix(ROTOR_SET): values
                for key, values in self.values.items()
                if key.startswith(ROTOR_SET)
            },
            self._home(),
            self._independent(texts.get("independent", ""), names),
            texts.get("rotors") == "stated",
            tuple(self.warnings),
        )

    def _body(self, i: int) -> RigidBody:
        model = self.model
        first = int(model.body_jntadr[i])
        indices = range(first, first + int(model.body_jntnum[i]))
        free = next((j for j in indices if int(model.jnt_type[j]) == FREE), None)
        if model.body_gravcomp[i]:
            self.warnings.append(
                f"gravity compensation (gravcomp) of body '{self.body_name(i)}' does not count"
            )
        return RigidBody(
            self.body_name(i) if i else "",
            int(model.body_parentid[i]) if i else BASE,
            placement(model.body_pos[i], model.body_quat[i]),
            self.inertias[i],
            () if free is not None else tuple(j for k in indices for j in self._joints(k)),
            None if free is None else self.joint_name(free),
            int(model.body_mocapid[i]) >= 0,
        )

    def body_name(self, i: int) -> str:
        """Name of a body; one without goes by its number."""
        return str(self.model.body(i).name) or f"body{i}"

    def joint_name(self, i: int) -> str:
        """Name of a joint; one without goes by its number."""
        return str(self.model.joint(i).name) or f"joint{i + 1}"

    def site_name(self, i: int) -> str:
        """Name of a site's frame; a body and a site may have the same name in MJCF."""
        name = str(self.model.site(i).name)
        is_taken = mujoco.mj_name2id(self.model, int(mujoco.mjtObj.mjOBJ_BODY), name) >= 0
        return f"site:{name}" if name and is_taken else name or f"site{i + 1}"

    def _joints(self, i: int) -> Iterator[Joint]:
        """Yield a hinge or slide, or the three hinges that a ball joint is."""
        model, name = self.model, self.joint_name(i)
        if int(model.jnt_type[i]) != BALL:
            yield self._joint(i)
            return
        self.balls.append(Ball(name, names_of(model, i)))
        dof = int(model.jnt_dofadr[i])
        if float(model.jnt_stiffness[i]):
            self.warnings.append(f"the spring of ball joint '{name}' does not count")
        for k, (axis, along) in enumerate(EACH_AXIS):
            yield Joint(
                f"{name}_{axis}",
                JointKind.HINGE,
                BASE,
                frame_along(np.array(along), model.jnt_pos[i]),
                Inertia.zero(),
                armature=float(model.dof_armature[dof + k]),
                actuated=False,
                damping=float(model.dof_damping[dof + k]),
                friction=float(model.dof_frictionloss[dof + k]),
            )

    def _joint(self, i: int) -> Joint:
        model = self.model
        address, dof = int(model.jnt_qposadr[i]), int(model.jnt_dofadr[i])
        limited = bool(model.jnt_limited[i])
        lower, upper = model.jnt_range[i] if limited else (-math.inf, math.inf)
        joint = Joint(
            name=self.joint_name(i),
            kind=JointKind.SLIDE if int(model.jnt_type[i]) == SLIDE else JointKind.HINGE,
            parent=BASE,
            placement=frame_along(model.jnt_axis[i], model.jnt_pos[i]),
            inertia=Inertia.zero(),
            offset=-float(model.qpos0[address]) + 0.0,
            lower=float(lower),
            upper=float(upper),
            armature=float(model.dof_armature[dof]),
            stiffness=float(model.jnt_stiffness[i]),
            spring_reference=float(model.qpos_spring[address]),
            damping=float(model.dof_damping[dof]),
            friction=float(model.dof_frictionloss[dof]),
        )
        for field, words in UNUSED_OF_JOINTS.items():
            if np.any(np.ravel(getattr(model, field, np.zeros(model.njnt))[i]) != 0):
                self.warnings.append(f"{words} of joint '{joint.name}' does not count")
        if np.any(getattr(model, "dof_dampingpoly", np.zeros((model.nv, 1)))[dof]):
            self.warnings.append(
                f"damping of joint '{joint.name}' that grows with speed counts in its linear part"
            )
        drive = self.motors.of_joint(i)
        follows = not self.motors.named and joint.name in self.ties.followers
        return replace(
            joint,
            armature=joint.armature + drive.armature,
            stiffness=joint.stiffness + drive.spring,
            spring_reference=drive.spring_reference if drive.spring else joint.spring_reference,
            actuated=drive.actuated and not follows,
            damping=joint.damping + drive.damping,
            friction=joint.friction + drive.friction,
            position_gain=drive.position_gain,
            velocity_gain=drive.velocity_gain,
            torque_limit=drive.torque_limit,
            speed_limit=self.speed_limits[i],
        )

    def _sites(self) -> Iterator[Frame]:
        model = self.model
        for i in range(model.nsite):
            place = placement(model.site_pos[i], model.site_quat[i])
            yield Frame(self.site_name(i), int(model.site_bodyid[i]), place)

    def _home(self) -> dict[str, float]:
        model = self.model
        fits = bool(self.keys) and len(self.keys[0]) == model.nq
        values = self.keys[0] if fits else model.qpos0
        return {
            self.joint_name(i): float(values[int(model.jnt_qposadr[i])])
            for i in range(model.njnt)
            if int(model.jnt_type[i]) in (SLIDE, HINGE)
        }

    def _independent(self, text: str, joints: list[str]) -> tuple[str, ...]:
        names = tuple(text.split())
        for name in names:
            if name not in joints:
                raise UnknownName("joint (custom text 'independent')", name, joints)
        return names

    def _values_of_joints(self) -> dict[str, tuple[float, ...]]:
        """``custom/numeric`` elements with a value for each joint, by name."""
        model, found = self.model, {}
        joints = int((model.jnt_type != FREE).sum())
        for i in range(model.nnumeric):
            name = model.numeric(i).name
            if not name.startswith(ROTOR_SET) and name != SPEED_LIMIT:
                continue
            first, size = int(model.numeric_adr[i]), int(model.numeric_size[i])
            if size != joints:
                raise ModelFileError(
                    str(self.path), f"numeric '{name}' has {size} values for {joints} joints"
                )
            found[name] = tuple(float(x) for x in model.numeric_data[first : first + size])
        if min(found.get(SPEED_LIMIT, (1.0,))) <= 0:
            raise ModelFileError(str(self.path), f"numeric '{SPEED_LIMIT}' must be greater than 0")
        return found


UNUSED_OF_JOINTS = {
    "jnt_actgravcomp": "gravity compensation by the motor",
    "jnt_springyield": "the yield limit of the spring",
}
"""Fields of a joint that change what it does and that no model of ours knows."""


def _custom_texts(model: mujoco.MjModel) -> dict[str, str]:
    """MJCF ``custom/text`` elements by name."""
    texts = {}
    for i in range(model.ntext):
        first, size = int(model.text_adr[i]), int(model.text_size[i])
        name = mujoco.mj_id2name(model, int(mujoco.mjtObj.mjOBJ_TEXT), i)
        text = bytes(model.text_data[first : first + size]).rstrip(b"\0")
        texts[name] = text.decode(errors="replace")
    return texts
