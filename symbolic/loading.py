# SPDX-License-Identifier: BSD-3-Clause
"""Read a robot from URDF or MJCF through MuJoCo's model compiler."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np

from softimpact.robots import built_in_robots

from .errors import InvalidInertia, ModelFileError, UnknownName, UnsupportedModel
from .rigid import Array, Inertia, Placement, product, rotation_from_axis
from .robot import BASE, Frame, Joint, JointKind, Loop, Robot

KINDS = {
    int(mujoco.mjtJoint.mjJNT_HINGE): JointKind.HINGE,
    int(mujoco.mjtJoint.mjJNT_SLIDE): JointKind.SLIDE,
}

SHAPES = range(int(mujoco.mjtGeom.mjGEOM_SPHERE), int(mujoco.mjtGeom.mjGEOM_MESH))
"""Geoms that need no file and have a volume."""

ROTOR_SET = "rotor_inertia:"
"""Prefix of the MJCF ``custom/numeric`` elements that hold named sets of rotor inertias."""


def load_robot(model: str | Path, tip: str | None = None, *, floating: bool = False) -> Robot:
    """Read a built-in robot, or one from a URDF (``.urdf``) or MJCF (``.xml``) file.

    Meshes are not needed. Every body and every site becomes a frame. The model's gravity is not
    kept, nor are couplings between joints (URDF ``mimic``, MJCF ``equality/joint``, tendons): weld
    such joints with ``chain_to`` or ``lock_joints``. Of MJCF's ``custom`` elements the text ``tip``
    names the contact frame and the numerics ``rotor_inertia:NAME`` hold sets of reflected rotor
    inertias. MJCF ``equality/connect`` closes a loop: ``home`` is then the first keyframe (or the
    model's reference configuration), and the custom text ``independent`` may name the joints whose
    coordinates describe the closed chain, separated by spaces.

    Args:
        model: name of a built-in robot, or path of a file.
        tip: frame taken as the contact point where none is named; default the file's.
        floating: accept a free joint at the root (MJCF) and drop it; the root's frame is the base
            then. ``floating_robot`` frees the base of any robot, however its file attaches it.

    Raises:
        ModelFileError: the file is missing, not readable as URDF or MJCF, or holds no joint.
        InvalidInertia: a mass or inertia is missing or impossible.
        UnsupportedModel: ball or free joints, or welds between bodies.
        FrameNotFound: the robot has no frame ``tip``.
    """
    path = _model_path(model)
    compiled, home = _compile(path, floating)
    _reject_unsupported(compiled, path)
    robot = _RobotBuilder(compiled, path).robot(tip or _custom_texts(compiled).get("tip"))
    if robot.loops:
        robot = _with_loop_data(robot, home, _custom_texts(compiled).get("independent", ""))
    if not robot.joints:
        raise ModelFileError(str(path), "has no joints")
    if robot.tip is not None:
        robot.frame(robot.tip)
    return robot


def _with_loop_data(robot: Robot, home: list[float], independent: str) -> Robot:
    names = tuple(independent.split())
    for name in names:
        if name not in robot.joint_names:
            raise UnknownName("joint (custom text 'independent')", name, robot.joint_names)
    return replace(robot, home=tuple(home), independent=names)


def _model_path(model: str | Path) -> Path:
    path = Path(model)
    if path.suffix in (".urdf", ".xml"):
        return path
    known = built_in_robots()
    if str(model) not in known:
        raise UnknownName("robot (neither built in nor a .urdf or .xml file)", str(model), known)
    return known[str(model)]


def _custom_texts(model: mujoco.MjModel) -> dict[str, str]:
    """MJCF ``custom/text`` elements by name."""
    texts = {}
    for i in range(model.ntext):
        first, size = int(model.text_adr[i]), int(model.text_size[i])
        name = mujoco.mj_id2name(model, int(mujoco.mjtObj.mjOBJ_TEXT), i)
        texts[name] = bytes(model.text_data[first : first + size]).rstrip(b"\0").decode()
    return texts


def _rotor_inertia_sets(model: mujoco.MjModel, path: Path) -> dict[str, tuple[float, ...]]:
    sets = {}
    for i in range(model.nnumeric):
        name = model.numeric(i).name
        if not name.startswith(ROTOR_SET):
            continue
        first, size = int(model.numeric_adr[i]), int(model.numeric_size[i])
        if size != model.njnt:
            raise ModelFileError(
                str(path), f"numeric '{name}' has {size} values for {model.njnt} joints"
            )
        values = model.numeric_data[first : first + size]
        sets[name.removeprefix(ROTOR_SET)] = tuple(float(value) for value in values)
    return sets


def _compile(path: Path, floating: bool) -> tuple[mujoco.MjModel, list[float]]:
    """Return the compiled model and the configuration of its first keyframe or reference."""
    if not path.is_file():
        raise ModelFileError(str(path), "no such file")
    with _warnings() as heard:
        return _compile_spec(path, heard, floating)


@contextmanager
def _warnings() -> Iterator[list[str]]:
    """Collect MuJoCo's warnings; left alone it appends them to a log in the working directory."""
    heard: list[str] = []
    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(heard.append)
    try:
        yield heard
    finally:
        mujoco.set_mju_user_warning(before)


def _compile_spec(
    path: Path, heard: list[str], floating: bool
) -> tuple[mujoco.MjModel, list[float]]:
    try:
        spec = mujoco.MjSpec.from_file(str(path))
    except ValueError as error:
        raise ModelFileError(str(path), f"not a URDF or MJCF: {_one_line(error)}") from None
    spec.compiler.fusestatic = False
    keys = [[float(x) for x in key.qpos] for key in spec.keys[:1]]
    if floating:
        _drop_free_joint(spec)
    hollow = _drop_meshes(spec, keep_shapes=path.suffix != ".urdf")
    for body in spec.bodies[1:]:
        _check_mass(body, str(path))
    for joint in spec.joints:
        if joint.armature < 0:
            raise ModelFileError(str(path), f"joint '{joint.name}': armature is negative")
    if any("NaN" in warning for warning in heard):
        raise ModelFileError(str(path), "a number is NaN")
    try:
        model = spec.compile()
    except ValueError as error:
        raise _compile_error(str(path), _one_line(error)) from None
    for body in hollow:
        if floating or model.body_weldid[body.id] != 0:
            raise InvalidInertia(
                str(path), body.name, "takes its inertia from a mesh; give it an <inertial> element"
            )
    home = keys[0] if keys and len(keys[0]) == model.nq else [float(x) for x in model.qpos0]
    return model, home


def _drop_free_joint(spec: mujoco.MjSpec) -> None:
    """Weld the only body at the root to the world, frame on frame, if a free joint moves it."""
    if len(spec.worldbody.bodies) != 1:
        return
    root = spec.worldbody.bodies[0]
    for joint in root.joints:
        if joint.type == mujoco.mjtJoint.mjJNT_FREE:
            spec.delete(joint)
            root.pos, root.quat = [0, 0, 0], [1, 0, 0, 0]
            root.alt.type = mujoco.mjtOrientation.mjORIENTATION_QUAT


def _drop_meshes(spec: mujoco.MjSpec, keep_shapes: bool) -> list[mujoco.MjsBody]:
    """Drop what only rendering and collision need, and with it every file beside the model.

    In MJCF simple shapes stay: a body without an inertial element takes its inertia from them.
    Returns the bodies that would have taken theirs from a mesh.
    """
    hollow = []
    always = spec.compiler.inertiafromgeom == mujoco.mjtInertiaFromGeom.mjINERTIAFROMGEOM_TRUE
    for geom in list(spec.geoms):
        if keep_shapes and int(geom.type) in SHAPES and not geom.meshname:
            geom.material = ""
            continue
        body = geom.parent
        if keep_shapes and geom.mass != 0 and (always or not body.explicitinertial):
            hollow.append(body)
        spec.delete(geom)
    for site in spec.sites:
        site.material = ""
    files = (spec.meshes, spec.hfields, spec.skins, spec.materials, spec.textures)
    for group in (*files, spec.pairs, spec.sensors, spec.keys):
        for item in list(group):
            spec.delete(item)
    return hollow


def _check_mass(body: mujoco.MjsBody, path: str) -> None:
    if not math.isfinite(body.mass):
        raise InvalidInertia(path, body.name, "mass must be a finite number")
    if body.mass < 0:
        raise InvalidInertia(path, body.name, f"mass is negative ({body.mass:g} kg)")


def _compile_error(path: str, reason: str) -> ModelFileError:
    named = reason.split("Element name '")
    body = named[1].split("'")[0] if len(named) > 1 else "?"
    if "positive eigenvalues" in reason:
        return InvalidInertia(path, body, "inertia has an eigenvalue that is not positive")
    if "A + B >= C" in reason:
        return InvalidInertia(
            path, body, "inertia violates the triangle inequality (A + B ≥ C for its moments)"
        )
    if "mass and inertia of moving bodies" in reason:
        return InvalidInertia(
            path, body, "moves but has no mass and inertia > 0; give it an <inertial> element"
        )
    return ModelFileError(path, reason)


def _one_line(error: Exception) -> str:
    return " ".join(str(error).split())


def _reject_unsupported(model: mujoco.MjModel, path: Path) -> None:
    of_bodies = [model.body_pos, model.body_quat, model.body_ipos, model.body_inertia]
    of_joints = [model.jnt_pos, model.jnt_axis, model.dof_armature, model.site_pos]
    if not all(np.isfinite(array).all() for array in of_bodies + of_joints):
        raise ModelFileError(str(path), "a number is infinite")
    for i in range(model.njnt):
        name = _joint_name(model, i)
        if int(model.jnt_type[i]) not in KINDS:
            raise UnsupportedModel(
                str(path),
                f"joint '{name}' is a ball or free joint; "
                "only hinges and slides on a fixed base are supported",
            )
    if any(int(kind) == int(mujoco.mjtEq.mjEQ_WELD) for kind in model.eq_type):
        raise UnsupportedModel(str(path), "equality weld; close loops with connect")
    if np.any(getattr(model, "jnt_stiffnesspoly", 0.0)):
        raise UnsupportedModel(str(path), "springs whose stiffness depends on the deflection")
    names = [_joint_name(model, i) for i in range(model.njnt)]
    twice = [name for name in names if names.count(name) > 1]
    if twice:
        raise ModelFileError(str(path), f"two joints go by '{twice[0]}'; name every joint")


def _joint_name(model: mujoco.MjModel, joint: int) -> str:
    return str(model.joint(joint).name) or f"joint{joint + 1}"


class _RobotBuilder:
    """Turns a compiled model's arrays into joints, each with all that moves rigidly with it."""

    def __init__(self, model: mujoco.MjModel, path: Path) -> None:
        self.model, self.path = model, path
        self.joints: list[Joint] = []
        self.inertias: list[Inertia] = []
        self.base_inertia = Inertia.zero()
        self.frames: dict[str, Frame] = {}
        self.actuated = _actuated_joints(model)

    def robot(self, tip: str | None) -> Robot:
        """Walk the bodies, parents before children."""
        carriers = {0: (BASE, Placement.identity())}
        for body in range(1, self.model.nbody):
            carriers[body] = self._add_body(body, *carriers[int(self.model.body_parentid[body])])
        for site in range(self.model.nsite):
            joint, pose = carriers[int(self.model.site_bodyid[site])]
            local = _placement(self.model.site_pos[site], self.model.site_quat[site])
            self._add_frame(self.model.site(site).name, joint, pose @ local)
        joints = [
            Joint(**{**vars(joint), "inertia": inertia})
            for joint, inertia in zip(self.joints, self.inertias, strict=True)
        ]
        name = self.model.names.split(b"\0")[0].decode() or self.path.stem
        sets = _rotor_inertia_sets(self.model, self.path)
        loops = tuple(self._loops(carriers))
        return Robot(
            name,
            tuple(joints),
            self.frames,
            tip,
            sets,
            loops,
            base_inertia=self.base_inertia,
        )

    def _loops(self, carriers: Mapping[int, tuple[int, Placement]]) -> Iterator[Loop]:
        """Yield what ``equality/connect`` elements close, between sites or points of bodies."""
        model, sites = self.model, int(mujoco.mjtObj.mjOBJ_SITE)
        for i in range(model.neq):
            if int(model.eq_type[i]) != int(mujoco.mjtEq.mjEQ_CONNECT) or not model.eq_active0[i]:
                continue
            ends = []
            for index, anchor in (
                (int(model.eq_obj1id[i]), model.eq_data[i, :3]),
                (int(model.eq_obj2id[i]), model.eq_data[i, 3:6]),
            ):
                if int(model.eq_objtype[i]) == sites:
                    ends.append(model.site(index).name)
                    continue
                joint, pose = carriers[index]
                place = pose @ Placement(np.eye(3), anchor)
                point = ",".join(f"{round(x, 12) + 0.0:g}" for x in anchor)
                ends.append(f"{model.body(index).name}@{point}")
                self.frames[ends[-1]] = Frame(ends[-1], joint, place)
            name = model.equality(i).name or f"loop{i + 1}"
            yield Loop(name, ends[0], ends[1])

    def _add_body(self, body: int, carrier: int, pose: Placement) -> tuple[int, Placement]:
        """Add a body's joints; return the joint that carries it and its pose in that joint."""
        model = self.model
        pose = pose @ _placement(model.body_pos[body], model.body_quat[body])
        for joint in self._joints_of(body):
            axis_frame = _frame_along(model.jnt_axis[joint], model.jnt_pos[joint])
            self._add_joint(joint, carrier, pose @ axis_frame)
            carrier, pose = len(self.joints) - 1, axis_frame.inverse()
        inertia = _inertia(model, body).seen_from(pose)
        if carrier == BASE:
            self.base_inertia += inertia
        else:
            self.inertias[carrier] += inertia
        self._add_frame(model.body(body).name, carrier, pose)
        return carrier, pose

    def _joints_of(self, body: int) -> Iterator[int]:
        first = int(self.model.body_jntadr[body])
        yield from range(first, first + int(self.model.body_jntnum[body]))

    def _add_joint(self, joint: int, parent: int, placement: Placement) -> None:
        model = self.model
        address = int(model.jnt_qposadr[joint])
        limited = bool(model.jnt_limited[joint])
        lower, upper = model.jnt_range[joint] if limited else (-math.inf, math.inf)
        self.joints.append(
            Joint(
                name=_joint_name(model, joint),
                kind=KINDS[int(model.jnt_type[joint])],
                parent=parent,
                placement=placement,
                inertia=Inertia.zero(),
                offset=-float(model.qpos0[address]) + 0.0,
                lower=float(lower),
                upper=float(upper),
                armature=float(model.dof_armature[model.jnt_dofadr[joint]]),
                stiffness=float(model.jnt_stiffness[joint]),
                spring_reference=float(model.qpos_spring[address]),
                actuated=not self.actuated or joint in self.actuated,
            )
        )
        self.inertias.append(Inertia.zero())

    def _add_frame(self, name: str, joint: int, placement: Placement) -> None:
        if name:
            self.frames.setdefault(name, Frame(name, joint, placement))


def _actuated_joints(model: mujoco.MjModel) -> set[int]:
    """Joints that an actuator drives; a model without actuators has motors everywhere."""
    on_joint = (int(mujoco.mjtTrn.mjTRN_JOINT), int(mujoco.mjtTrn.mjTRN_JOINTINPARENT))
    return {
        int(target[0])
        for kind, target in zip(model.actuator_trntype, model.actuator_trnid, strict=True)
        if int(kind) in on_joint
    }


def _placement(position: Array, quaternion: Array) -> Placement:
    rotation = np.zeros(9)
    mujoco.mju_quat2Mat(rotation, np.asarray(quaternion, dtype=float))
    return Placement(rotation.reshape(3, 3), position)


def _frame_along(axis: Array, position: Array) -> Placement:
    """Frame at ``position`` whose z axis is ``axis``, turned the shortest way."""
    axis = np.asarray(axis, dtype=float) / np.linalg.norm(axis)
    swing = np.cross([0.0, 0.0, 1.0], axis)
    sine = float(np.linalg.norm(swing))
    if sine < np.finfo(float).eps:
        return Placement(np.diag([1.0, np.sign(axis[2]), np.sign(axis[2])]), position)
    return Placement(rotation_from_axis(swing / sine, math.atan2(sine, axis[2])), position)


def _inertia(model: mujoco.MjModel, body: int) -> Inertia:
    principal = _placement(model.body_ipos[body], model.body_iquat[body])
    R = principal.rotation
    tensor = product(product(R, np.diag(model.body_inertia[body])), R.T)
    return Inertia.from_center_of_mass(model.body_mass[body], principal.translation, tensor)
