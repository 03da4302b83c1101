# SPDX-License-Identifier: BSD-3-Clause
"""Arms that move in a plane: the posture is sought where the task leaves one to choose."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from studies import InProcess, content, written

from softimpact.optimize import Design, Study, design, load_study
from softimpact.optimize.posture.tip_pose import tip_pose
from softimpact.symbolic import InvalidValue


def planar_study(folder: Path, joints: int) -> Study:
    """The Panda's task for an arm of like links in the xy plane."""
    body = (
        "<body pos='{} 0 0'><joint name='j{}' axis='0 0 1' armature='0.3'/>"
        "<inertial mass='2' pos='0.15 0 0' diaginertia='0.02 0.02 0.02'/>"
    )
    links = "".join(body.format(0.3 if i else 0.0, i) for i in range(joints))
    arm = f"{links}<site name='tool' pos='0.3 0 0'/>{'</body>' * joints}"
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
        assert pose.free.force < 275.6  # N; searches from elsewhere found 275.25, too
        where = (tip_pose(found.study.model, q) for q in (pose.free.q, pose.candidate.q))
        for here, there in zip(*where, strict=True):
            np.testing.assert_allclose(here, there, atol=1e-5)
