# SPDX-License-Identifier: BSD-3-Clause
"""Read a robot from a URDF or MJCF file."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from dataclasses import replace
from pathlib import Path

import mujoco
import numpy as np

from softimpact.robots import built_in_robots

from ..errors import ModelFileError, UnknownName
from .model_file import KINDS, compile_model, joint_name
from .rigid import Array, Inertia, Placement, product, rotation_from_axis
from .robot import BASE, Frame, Joint, Loop, Robot

ROTOR_SET = "rotor_inertia:"
"""Prefix of the MJCF ``custom/numeric`` elements that hold named sets of rotor inertias."""

SPEED_LIMIT = "speed_limit"
"""Name of the one that holds the joints' largest speeds, for which MJCF has no place."""

NAMELESS = "MuJoCo Model"
"""What MuJoCo calls a model without a name."""


def load_robot(model: str | Path, tip: str | None = None, *, floating: bool = False) -> Robot:
    """Read a built-in robot, or one from a URDF (``.urdf``) or MJCF (``.xml``) file.

    Meshes are not needed. Every body and every site becomes a frame; a site that shares its name
    with a body is ``site:NAME``. The model's gravity is not kept, nor are damping and friction of
    joints, nor couplings between them (URDF ``mimic``, MJCF ``equality/joint``, tendons): weld
    such joints with ``chain_to`` or ``lock_joints``. Of MJCF's ``custom`` elements the text ``tip``
    names the contact frame, the numerics ``rotor_inertia:NAME`` hold sets of reflected rotor
    inertias, and the numeric ``speed_limit`` the joints' largest speeds; the text ``rotors`` with
    the value ``stated`` says that joints without armature have no rotor, or that rotors are bodies
    of their own. MJCF ``equality/connect`` closes a loop: ``home`` is then the first keyframe (or
    the model's reference configuration), and the custom text ``independent`` may name the joints
    whose coordinates describe the closed chain, separated by spaces.

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
    compiled, home = compile_model(path, floating)
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
        text = bytes(model.text_data[first : first + size]).rstrip(b"\0")
        texts[name] = text.decode(errors="replace")
    return texts


def _values_of_joints(model: mujoco.MjModel, path: Path) -> dict[str, tuple[float, ...]]:
    """MJCF ``custom/numeric`` elements with a value for each joint, by name."""
    found = {}
    for i in range(model.nnumeric):
        name = model.numeric(i).name
        if not name.startswith(ROTOR_SET) and name != SPEED_LIMIT:
            continue
        first, size = int(model.numeric_adr[i]), int(model.numeric_size[i])
        if size != model.njnt:
            raise ModelFileError(
                str(path), f"numeric '{name}' has {size} values for {model.njnt} joints"
            )
        found[name] = tuple(float(value) for value in model.numeric_data[first : first + size])
    if min(found.get(SPEED_LIMIT, (1.0,))) <= 0:
        raise ModelFileError(str(path), f"numeric '{SPEED_LIMIT}' must be greater than 0")
    return found


class _RobotBuilder:
    """Turns a compiled model's arrays into joints, each with all that moves rigidly with it."""

    def __init__(self, model: mujoco.MjModel, path: Path) -> None:
        self.model, self.path = model, path
        self.joints: list[Joint] = []
        self.inertias: list[Inertia] = []
        self.base_inertia = Inertia.zero()
        self.frames: dict[str, Frame] = {}
        self.actuated = _actuated_joints(model)
        self.values = _values_of_joints(model, path)

    def robot(self, tip: str | None) -> Robot:
        """Walk the bodies, parents before children."""
        carriers = {0: (BASE, Placement.identity())}
        for body in range(1, self.model.nbody):
            carriers[body] = self._add_body(body, *carriers[int(self.model.body_parentid[body])])
        for site in range(self.model.nsite):
            joint, pose = carriers[int(self.model.site_bodyid[site])]
            local = _placement(self.model.site_pos[site], self.model.site_quat[site])
            self._add_frame(self._site_name(site), joint, pose @ local)
        joints = [
            Joint(**{**vars(joint), "inertia": inertia})
            for joint, inertia in zip(self.joints, self.inertias, strict=True)
        ]
        name = self.model.names.split(b"\0")[0].decode()
        name = self.path.stem if name in ("", NAMELESS) else name
        sets = {
            key.removeprefix(ROTOR_SET): values
            for key, values in self.values.items()
            if key.startswith(ROTOR_SET)
        }
        loops = tuple(self._loops(carriers))
        return Robot(
            name,
            tuple(joints),
            self.frames,
            tip,
            sets,
            loops,
            base_inertia=self.base_inertia,
            rotors_stated=_custom_texts(self.model).get("rotors") == "stated",
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
                    ends.append(self._site_name(index))
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
                name=joint_name(model, joint),
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
                damping=float(np.ravel(model.dof_damping[model.jnt_dofadr[joint]])[0]),
                friction=float(model.dof_frictionloss[model.jnt_dofadr[joint]]),
                torque_limit=_torque_limit(model, joint),
                speed_limit=self.values.get(SPEED_LIMIT, (math.inf,) * model.njnt)[joint],
            )
        )
        self.inertias.append(Inertia.zero())

    def _add_frame(self, name: str, joint: int, placement: Placement) -> None:
        if name:
            self.frames[name] = Frame(name, joint, placement)

    def _site_name(self, site: int) -> str:
        """Name of a site's frame; a body and a site may have the same name in MJCF."""
        name = str(self.model.site(site).name)
        is_taken = mujoco.mj_name2id(self.model, int(mujoco.mjtObj.mjOBJ_BODY), name) >= 0
        return f"site:{name}" if name and is_taken else name


def _torque_limit(model: mujoco.MjModel, joint: int) -> float:
    """Largest of what a joint's motors may exert together (``actuatorfrcrange``)."""
    return (
        float(abs(model.jnt_actfrcrange[joint]).max())
        if model.jnt_actfrclimited[joint]
        else math.inf
    )


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
