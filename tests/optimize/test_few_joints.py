# SPDX-License-Identifier: BSD-3-Clause
"""Arms that move in a plane: the posture is sought where the task leaves one to choose."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from studies import InProcess, content, written

from softimpact.optimize import Design, Pose, Study, design, load_study
from softimpact.optimize.posture.tip_pose import tip_pose
from softimpact.symbolic import InvalidValue
from softimpact.symbolic.robot.rigid import Array

LINK = 0.3
"""Length of each link [m]."""


def planar_study(folder: Path, joints: int) -> Study:
    """The Panda's task for an arm of like links in the xy plane."""
    body = (
        "<body pos='{} 0 0'><joint name='j{}' axis='0 0 1' armature='0.3'/>"
        "<inertial mass='2' pos='0.15 0 0' diaginertia='0.02 0.02 0.02'/>"
    )
    links = "".join(body.format(LINK if i else 0.0, i) for i in range(joints))
    arm = f"{links}<site name='tool' pos='{LINK} 0 0'/>{'</body>' * joints}"
    (folder / "planar.xml").write_text(f"<mujoco><worldbody>{arm}</worldbody></mujoco>")
    study = content()
    study["robot"] = {"model": "planar.xml", "tip": "tool"}
    accuracy = {"forces": [[30.0, 0.0, 0.0], [0.0, 30.0, 0.0]], "max_deflection": 3e-3}
    study |= {"accuracy": accuracy, "task": {"pose_of": "bent"}}
    study["poses"] = [{"name": "bent", "q": [0.3] + [0.7] * (joints - 1)}]
    return load_study(written(folder, study))


@pytest.fixture(scope="module", params=[2, 3, 4])
def found(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Design:
    folder = tmp_path_factory.mktemp("planar")
    return design(planar_study(folder, request.param), executor=InProcess())


def test_posture_is_sought_only_where_there_is_a_choice(found: Design) -> None:
    (pose,) = found.poses
    assert pose.table is not None
    assert pose.table.solved
    assert (pose.free is not None) == (found.study.robot.n == 4)
    assert found.gains is not None
    assert found.gains.both == found.winner.force
    if pose.free is None:
        assert found.gains.both == found.gains.springs
        with pytest.raises(InvalidValue, match="no other posture") as caught:
            design(found.study, ["free"], InProcess())
        assert caught.value.field == "mode"
    else:
        assert pose.free.solved
        assert pose.free.force < pose.table.force
        where = (tip_pose(found.study.model, q) for q in (pose.free.q, pose.candidate.q))
        for here, there in zip(*where, strict=True):
            np.testing.assert_allclose(here, there, atol=1e-5)


def postures_of_four(q: Array, count: int) -> Iterator[Array]:
    """Postures of four links that hold the tip where q does, by the law of cosines."""
    angles = np.cumsum(q)
    wrist = LINK * np.exp(1j * angles[:3]).sum()
    for first in np.linspace(-np.pi, np.pi, count, endpoint=False):
        reach = wrist - LINK * np.exp(1j * first)
        if abs(reach) < 2 * LINK:
            half = np.arccos(abs(reach) / (2 * LINK))
            for side in (half, -half):
                bent = [first, np.angle(reach) + side, np.angle(reach) - side, angles[3]]
                turns = np.diff(bent, prepend=0.0)
                yield np.remainder(turns + np.pi, 2 * np.pi) - np.pi


@pytest.mark.slow
def test_a_posture_that_is_sought_is_no_worse_than_any_that_is_held(tmp_path: Path) -> None:
    study = planar_study(tmp_path, 4)
    held = [Pose(f"p{i}", q) for i, q in enumerate(postures_of_four(study.task_pose.q, 60))]
    assert len(held) > 20
    swept = design(replace(study, poses=(study.task_pose, *held)), ["table"], InProcess())
    sought = design(study, executor=InProcess())
    assert sought.winner.force <= swept.winner.force * (1 + 1e-3)
