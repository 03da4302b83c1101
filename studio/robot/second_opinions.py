# SPDX-License-Identifier: BSD-3-Clause
"""A robot's mass matrix by MuJoCo and Pinocchio, which read its file themselves."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np

from softimpact.symbolic import Robot, mass_matrix
from softimpact.symbolic.robot.rigid import Array
from softimpact.symbolic.robot.xml_file import root_tag, text_of

MOST_JOINTS = 300
"""Above, our symbolic mass matrix takes many seconds and gigabytes."""

SEED = 1
"""Of the configuration at which mass matrices are compared."""


def second_opinions(robot: Robot, path: Path) -> dict[str, float | str]:
    """Return, by library, by how much its mass matrix differs from ours, or why it has none.

    Differences are relative to the largest entry.

    Args:
        robot: whole, as its file describes it.
        path: the file.
    """
    if robot.n > MOST_JOINTS:
        return dict.fromkeys(OPINIONS, f"not asked about more than {MOST_JOINTS} joints")
    q = np.random.default_rng(SEED).uniform(-0.5, 0.5, robot.n)
    ours = np.array(mass_matrix(robot, q))
    found: dict[str, float | str] = {}
    for name, matrix_of in OPINIONS.items():
        try:
            theirs = matrix_of(robot, path, q)
        except ImportError:
            found[name] = "not installed"
            continue
        except Exception as error:  # whatever a reader of files runs into
            words = " ".join(str(error).split()) or type(error).__name__
            found[name] = f"does not read it: {words[:80]}"
            continue
        mine = ours + np.diag(robot.armature) if name == "MuJoCo" else ours
        scale = max(float(abs(theirs).max(initial=0.0)), np.finfo(float).tiny)
        found[name] = float(abs(mine - theirs).max(initial=0.0) / scale)
    return found


def _by_mujoco(robot: Robot, path: Path, q: Array) -> Array:
    """M with rotors and tendons, by the compiler's own reading of the file."""
    import mujoco

    heard: list[str] = []
    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(heard.append)
    try:
        spec = mujoco.MjSpec.from_file(str(path))
        model = spec.compile()
        data = mujoco.MjData(model)
        dofs = []
        for name, value in zip(robot.joint_names, q, strict=True):
            joint = _joint(model, name)
            data.qpos[model.jnt_qposadr[joint]] = value
            dofs.append(int(model.jnt_dofadr[joint]))
        mujoco.mj_forward(model, data)
        full = np.zeros((model.nv, model.nv))
        mujoco.mj_fullM(model, data, full)
    finally:
        mujoco.set_mju_user_warning(before)
    return full[np.ix_(dofs, dofs)]


def _joint(model: object, name: str) -> int:
    import mujoco

    found = int(mujoco.mj_name2id(model, int(mujoco.mjtObj.mjOBJ_JOINT), name))
    if found < 0 and name.startswith("joint") and name[5:].isdigit():
        return int(name[5:]) - 1
    if found < 0:
        raise ValueError(f"has no joint '{name}'")
    return found


def _by_pinocchio(robot: Robot, path: Path, q: Array) -> Array:
    """M without rotors."""
    import pinocchio

    urdf = root_tag(text_of(path)) == "robot"
    build = pinocchio.buildModelFromUrdf if urdf else pinocchio.buildModelFromMJCF
    model = build(str(path))
    if not hasattr(model, "joints"):
        model = model[0]
    data, whole, dofs = model.createData(), pinocchio.neutral(model), []
    for name, value in zip(robot.joint_names, q, strict=True):
        if not model.existJointName(name):
            raise ValueError(f"has no joint '{name}'")
        joint = model.joints[model.getJointId(name)]
        turn = [value] if joint.nq == 1 else [np.cos(value), np.sin(value)]
        whole[joint.idx_q : joint.idx_q + joint.nq] = turn
        dofs.append(joint.idx_v)
    upper = np.triu(pinocchio.crba(model, data, whole))
    full = upper + np.triu(upper, 1).T - (0 if urdf else np.diag(model.armature))
    return np.asarray(full[np.ix_(dofs, dofs)])


OPINIONS: dict[str, Callable[[Robot, Path, Array], Array]] = {
    "MuJoCo": _by_mujoco,
    "Pinocchio": _by_pinocchio,
}
