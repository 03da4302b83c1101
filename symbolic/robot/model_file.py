# SPDX-License-Identifier: BSD-3-Clause
"""URDF and MJCF files through MuJoCo's model compiler, with errors that name file and body."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import mujoco
import numpy as np

from ..errors import InvalidInertia, ModelFileError, UnsupportedModel
from .robot import JointKind

KINDS = {
    int(mujoco.mjtJoint.mjJNT_HINGE): JointKind.HINGE,
    int(mujoco.mjtJoint.mjJNT_SLIDE): JointKind.SLIDE,
}
"""Joints that a robot may have."""

SHAPES = range(int(mujoco.mjtGeom.mjGEOM_SPHERE), int(mujoco.mjtGeom.mjGEOM_MESH))
"""Geoms that need no file and have a volume."""


def compile_model(path: Path, floating: bool) -> tuple[mujoco.MjModel, list[float]]:
    """Return the compiled model and the configuration of its first keyframe or reference.

    Args:
        path: a URDF (``.urdf``) or MJCF file; meshes and textures are dropped.
        floating: drop a free joint at the root.

    Raises:
        ModelFileError: the file is missing or not readable.
        InvalidInertia: a mass or inertia is missing or impossible.
        UnsupportedModel: the model holds what a ``Robot`` cannot.
    """
    if not path.is_file():
        raise ModelFileError(str(path), "no such file")
    with _warnings() as heard:
        model, home = _compile_spec(path, heard, floating)
    _reject_unsupported(model, path)
    return model, home


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
        _check_joint(joint, str(path))
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


def _check_joint(joint: mujoco.MjsJoint, path: str) -> None:
    for field, value in (("armature", joint.armature), ("stiffness", joint.stiffness[0])):
        if value < 0:
            raise ModelFileError(path, f"joint '{joint.name}': {field} is negative")


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
    try:
        model.names.decode()
    except UnicodeDecodeError:
        raise ModelFileError(str(path), "its names are not in UTF-8") from None
    of_bodies = [model.body_pos, model.body_quat, model.body_ipos, model.body_inertia]
    of_joints = [model.jnt_pos, model.jnt_axis, model.dof_armature, model.site_pos]
    of_joints += [model.jnt_stiffness, model.qpos0, model.qpos_spring]
    if not all(np.isfinite(array).all() for array in of_bodies + of_joints):
        raise ModelFileError(str(path), "a number is infinite")
    for i in range(model.njnt):
        name = joint_name(model, i)
        kind = int(model.jnt_type[i])
        if kind not in KINDS:
            free = kind == int(mujoco.mjtJoint.mjJNT_FREE)
            advice = (
                "at the root load the robot with floating=True (softimpact factors --floating)"
                if free
                else "write it as three hinges"
            )
            words = "free" if free else "ball"
            raise UnsupportedModel(str(path), f"joint '{name}' is a {words} joint; {advice}")
    if np.any((model.eq_type == int(mujoco.mjtEq.mjEQ_WELD)) & (model.eq_active0 != 0)):
        raise UnsupportedModel(str(path), "equality weld; close loops with connect")
    if np.any(getattr(model, "jnt_stiffnesspoly", 0.0)):
        raise UnsupportedModel(str(path), "springs whose stiffness depends on the deflection")
    names = [joint_name(model, i) for i in range(model.njnt)]
    twice = [name for name in names if names.count(name) > 1]
    if twice:
        raise ModelFileError(str(path), f"two joints go by '{twice[0]}'; name every joint")


def joint_name(model: mujoco.MjModel, joint: int) -> str:
    """Return a joint's name; one without goes by its number."""
    return str(model.joint(joint).name) or f"joint{joint + 1}"
