# SPDX-License-Identifier: BSD-3-Clause
"""The Panda on a rigid wall, as docs/validation.md reports it."""

from __future__ import annotations

import mujoco
import numpy as np
import pytest

from softimpact.papers.measurements.wall import (
    READY,
    ApparentMasses,
    apparent_masses,
    composite_mass,
)
from softimpact.robots import built_in_robots
from softimpact.symbolic import load_robot

STIFF_WALL_STIFF_JOINTS, SOFT_WALL_STIFF_JOINTS, STIFF_WALL_SOFT_JOINTS = 3, 1, 2


@pytest.fixture(scope="module")
def masses() -> ApparentMasses:
    return apparent_masses(count=40)


@pytest.mark.parametrize("direction", [(0.0, 0.0, -1.0), (1.0, 0.0, 0.0)])
def test_composite_body_is_mujocos(direction: tuple[float, float, float]) -> None:
    """The robot on a free joint whose own joints are locked."""
    spec = mujoco.MjSpec.from_file(str(built_in_robots()["panda"]))
    base = spec.worldbody.bodies[0]
    base.add_freejoint()
    base.explicitinertial, base.mass, base.inertia = True, 1e-12, [1e-12] * 3
    model = spec.compile()
    data = mujoco.MjData(model)
    data.qpos[7:] = READY
    mujoco.mj_forward(model, data)
    M, J = np.zeros((model.nv, model.nv)), np.zeros((3, model.nv))
    mujoco.mj_fullM(model, data, M)
    mujoco.mj_jacSite(model, data, J, None, model.site("flange").id)
    n = np.array(direction)
    locked = 1 / (n @ J[:, :6] @ np.linalg.solve(M[:6, :6], J[:, :6].T) @ n)
    assert composite_mass(load_robot("panda"), READY, n) == pytest.approx(locked)


@pytest.mark.slow
def test_the_links_alone_are_too_light(masses: ApparentMasses) -> None:
    assert (masses.links < masses.composite).all()
    assert np.median(masses.links / masses.composite) == pytest.approx(0.38, abs=0.08)


@pytest.mark.slow
def test_rotors_add_to_the_rigid_robot(masses: ApparentMasses) -> None:
    for mass in masses.rotors.values():
        assert (mass > masses.links).all()


@pytest.mark.slow
def test_driven_motors_are_never_lighter_than_free_ones(masses: ApparentMasses) -> None:
    assert (masses.driven > 0.99 * masses.free).all()


@pytest.mark.slow
@pytest.mark.parametrize("case", [STIFF_WALL_STIFF_JOINTS, SOFT_WALL_STIFF_JOINTS])
def test_the_bracket_holds_the_composite_body_where_joints_are_stiff(
    masses: ApparentMasses, case: int
) -> None:
    inside = (masses.free[case] <= masses.composite) & (masses.composite <= masses.driven[case])
    assert inside.mean() > 0.4


@pytest.mark.slow
def test_soft_joints_make_it_too_light(masses: ApparentMasses) -> None:
    assert (masses.driven[STIFF_WALL_SOFT_JOINTS] < masses.composite).all()
