# SPDX-License-Identifier: BSD-3-Clause
"""Every URDF of ``example-robot-data``: it loads, or Pinocchio has no robot in it either."""

from __future__ import annotations

from pathlib import Path

import pinocchio as pin
import pytest
from example_table import FILES, difference, lines
from oracles import TOLERANCE, URDFS

from softimpact.symbolic import ModelFileError, load_robot

PAGE = Path(__file__).parents[2] / "docs/example-robots.md"

NO_ARM = {
    "quadrotor_base.urdf": "has no joints",
    "iris_simple.urdf": "has no joints",
    "ur3.urdf": "has no links",
}
"""Files in which Pinocchio finds no joint, or no robot at all."""


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
def test_the_table_of_all_of_them() -> None:
    """Masses agree with Pinocchio's, and what is said of each file stands in the page."""
    page = PAGE.read_text(encoding="utf-8").splitlines()
    found = list(lines())
    assert found == page, "renew it: python tests/example_table.py > docs/example-robots.md"
    rows = [line for line in found if ".urdf |" in line]
    assert len(rows) == len(FILES)
    assert sum("| the same |" in line for line in rows) == len(FILES) - len(NO_ARM)
    assert sum("| refused: " in line for line in rows) == len(NO_ARM)


def test_a_few_masses_agree_with_pinocchio() -> None:
    some = {"romeo_small.urdf", "baxter.urdf", "icub.urdf", "solo12.urdf", "panda.urdf"}
    for path in FILES:
        if path.name in some:
            assert difference(path) < TOLERANCE
