# SPDX-License-Identifier: BSD-3-Clause
"""Every URDF of ``example-robot-data``: it loads, or Pinocchio has no robot in it either."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pinocchio as pin
import pytest
from oracles import TOLERANCE, URDFS

from softimpact.symbolic import ModelFileError, load_robot, mass_matrix

FILES = sorted(URDFS.rglob("*.urdf"))

NO_ARM = {
    "quadrotor_base.urdf": "has no joints",
    "iris_simple.urdf": "has no joints",
    "ur3.urdf": "has no links",
}
"""Files in which Pinocchio finds no joint, or no robot at all."""


def theirs(path: Path, names: tuple[str, ...], q: np.ndarray) -> np.ndarray:
    """Pinocchio's mass matrix, in our order of joints."""
    model = pin.buildModelFromUrdf(str(path))
    whole, dofs = pin.neutral(model), []
    for name, value in zip(names, q, strict=True):
        joint = model.joints[model.getJointId(name)]
        turn = [value] if joint.nq == 1 else [np.cos(value), np.sin(value)]
        whole[joint.idx_q : joint.idx_q + joint.nq] = turn
        dofs.append(joint.idx_v)
    upper = np.triu(pin.crba(model, model.createData(), whole))
    return np.asarray((upper + np.triu(upper, 1).T)[np.ix_(dofs, dofs)])


def difference(path: Path) -> float:
    """Largest difference of the mass matrices over the largest entry, of all joints loose."""
    robot = load_robot(path)
    q = np.random.default_rng(1).uniform(-1, 1, robot.n)
    M = theirs(path, robot.joint_names, q)
    return float(abs(np.array(mass_matrix(robot, q)) - M).max() / abs(M).max())


def test_all_of_them_are_there() -> None:
    assert len(FILES) >= 66
    assert set(NO_ARM) <= {path.name for path in FILES}


@pytest.mark.parametrize("name", NO_ARM)
def test_files_without_an_arm(name: str) -> None:
    (path,) = URDFS.rglob(name)
    with pytest.raises(ModelFileError, match=NO_ARM[name]):
        load_robot(path)
    if NO_ARM[name] == "has no joints":
        assert pin.buildModelFromUrdf(str(path)).nq == 0
        return
    with pytest.raises(ValueError, match="not contain a valid URDF"):
        pin.buildModelFromUrdf(str(path))


@pytest.mark.slow
@pytest.mark.parametrize("path", [p for p in FILES if p.name not in NO_ARM], ids=lambda p: p.name)
def test_masses_agree_with_pinocchio(path: Path) -> None:
    assert difference(path) < TOLERANCE


def test_a_few_masses_agree_with_pinocchio() -> None:
    some = {"romeo_small.urdf", "baxter.urdf", "icub.urdf", "solo12.urdf", "panda.urdf"}
    for path in FILES:
        if path.name in some:
            assert difference(path) < TOLERANCE
