# SPDX-License-Identifier: BSD-3-Clause
"""What becomes of each URDF of ``example-robot-data``, as docs/example-robots.md shows it.

python tests/example_table.py > docs/example-robots.md
"""

from __future__ import annotations

from collections.abc import Iterator
from importlib.metadata import version
from pathlib import Path

import numpy as np
import pinocchio as pin
from oracles import TOLERANCE, URDFS

from softimpact.symbolic import ModelFileError, load_robot, mass_matrix

FILES = sorted(URDFS.rglob("*.urdf"))

HEAD = """# Robots that others described

Written by `tests/example_table.py`, which CI compares with what it finds. Every URDF of
`example-robot-data` {version}: how many joints it has here, whether its mass matrix is that of
Pinocchio (to {tolerance:g} of the largest entry, at a random configuration with all joints loose),
and what of the file is not used or looks wrong. Packages of ten of them are generated, compiled and
tested (`tests/codegen/test_example_packages.py`).

| file | joints | mass matrix | said |
|---|---|---|---|
"""


def difference(path: Path) -> float:
    """Largest difference of the mass matrices over the largest entry."""
    robot = load_robot(path)
    q = np.random.default_rng(1).uniform(-1, 1, robot.n)
    M = by_pinocchio(path, robot.joint_names, q)
    return float(abs(np.array(mass_matrix(robot, q)) - M).max() / abs(M).max())


def by_pinocchio(path: Path, names: tuple[str, ...], q: np.ndarray) -> np.ndarray:
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


def row(path: Path) -> str:
    """Return a file's line of the table."""
    name = path.relative_to(URDFS).as_posix()
    try:
        robot = load_robot(path)
    except ModelFileError as refusal:
        said = str(refusal).rpartition(f"{path.name}: ")[2]
        return f"| {name} | – | – | refused: {said} |"
    found = difference(path)
    agrees = "the same" if found < TOLERANCE else f"{found:.1e} apart"
    said = "; ".join(" ".join(line.split()) for line in robot.warnings).replace("|", "\\|")
    return f"| {name} | {robot.n} | {agrees} | {said} |"


def lines() -> Iterator[str]:
    """Yield the page's lines."""
    release = version("example-robot-data")
    yield from HEAD.format(version=release, tolerance=TOLERANCE).splitlines()
    yield from map(row, FILES)


if __name__ == "__main__":
    print("\n".join(lines()))
