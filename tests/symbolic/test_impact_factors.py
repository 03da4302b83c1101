# SPDX-License-Identifier: BSD-3-Clause
"""The collection of all factors: agreement with its parts, and singular configurations."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest
from oracles import example_urdf

from softimpact.symbolic import (
    ImpactModel,
    InvalidValue,
    LoopCannotClose,
    SingularDirection,
    WrongLength,
    analyse,
    close_loops,
    closed_chain,
    drives,
    floating_model,
    floating_robot,
    impact_factors,
    impact_model,
    load_robot,
    lock_joints,
)

Q = np.array([0.0, 0.3, 0.0, -1.8, 0.1, 2.0, 0.5])
Y = np.array([0.0, 1.0, 0.0])


@pytest.fixture(scope="module")
def model() -> ImpactModel:
    return impact_model(load_robot("panda"))


def test_agrees_with_analyse(model: ImpactModel) -> None:
    found, reference = impact_factors(model, Q, Y), analyse(model, Q, Y)
    assert found.spatial is not None
    assert found.spatial.giaf == reference.giaf
    assert found.spatial.giif == reference.giif
    assert found.spatial.directional_giaf == reference.directional_giaf
    assert found.giaf_movable == pytest.approx(reference.giaf, rel=1e-9)
    assert found.reflected_mass_rigid == pytest.approx(reference.reflected_mass_rigid)
    assert found.mass_ratio == found.reflected_mass_free / found.reflected_mass_rigid
    assert reference.osim is not None
    assert np.array_equal(found.spatial.osim, reference.osim)
    assert found.mitigation is None
    assert found.rank == 3


def test_impulse_of_a_held_wall_is_the_reflected_mass(model: ImpactModel) -> None:
    found = impact_factors(model, Q, 5 * Y, speed=0.5, restitution=0.2)
    expected = 1.2 * 0.5 * found.reflected_mass_rigid
    assert found.impulse.contact == pytest.approx(expected, rel=1e-9)
    push = np.array(model.jacobian(Q)).T @ Y
    np.testing.assert_allclose(found.impulse.joints, -push * expected, atol=1e-12)


def test_struck_body_that_gives_way_takes_less(model: ImpactModel) -> None:
    held, free = (impact_factors(model, Q, Y, other_mass=m).impulse for m in (np.inf, 4.4))
    reduced = 1 / (1 / held.contact + 1 / 4.4)
    assert free.contact == pytest.approx(reduced, rel=1e-9)


def test_planar_robots_have_factors_in_their_plane() -> None:
    """Two directions of motion: three-dimensional factors do not apply, the rest does."""
    model = impact_model(load_robot("rr"))
    q = np.array([0.1, 0.0, 0.7, 0.0])
    found = impact_factors(model, q, [1, 1, 0])
    assert (found.rank, found.spatial) == (2, None)
    assert found.giaf_movable == pytest.approx(1)  # its rotors are bodies, it has no armature
    assert found.measures.manipulability == 0
    assert found.measures.force_measure is None
    with_rotors = impact_model(load_robot("rr").with_armature([0.1, 0.2, 0.3, 0.4]))
    J, M = np.array(with_rotors.jacobian(q))[:2], np.array(with_rotors.mass_matrix(q))
    G_F = J @ np.linalg.solve(M, J.T)
    G = J @ np.linalg.solve(M + np.diag([0.1, 0.2, 0.3, 0.4]), J.T)
    expected = np.linalg.det(G) / np.linalg.det(G_F)
    assert impact_factors(with_rotors, q, [1, 1, 0]).giaf_movable == pytest.approx(expected)
    with pytest.raises(SingularDirection):
        impact_factors(model, q, [0, 0, 1])


def test_two_joints_in_space_are_singular_not_nan() -> None:
    """With all but two joints locked the flange moves in a plane that turns with them."""
    robot = load_robot("panda", "flange")
    locked = dict(zip(robot.joint_names[2:], Q[2:], strict=True))
    model, q = impact_model(lock_joints(robot, locked)), [0.1, 0.2]
    found = impact_factors(model, q, [0, 1, 0])
    assert (found.rank, found.spatial) == (2, None)
    assert 0 < found.giaf_movable < 1
    assert 0 < found.mass_ratio < 1
    normal = np.linalg.svd(np.array(model.jacobian(q)))[0][:, 2]
    with pytest.raises(SingularDirection):
        impact_factors(model, q, normal)


def test_floating_robot_leaves_the_base_out_of_joint_results() -> None:
    robot = load_robot(example_urdf("go2.urdf"))
    free = floating_robot(robot)
    model = floating_model(free, "FL_foot", drives=drives(robot, rotor_inertia=0.01))
    q = np.array(free.coordinates(ca.DM(np.tile([0.0, 0.9, -1.8], 4)))).ravel()
    found = impact_factors(model, q, [0, 0, 1])
    assert found.mitigation is not None
    assert found.spatial is not None
    assert 0 < found.mitigation.imf < found.mitigation.directional_imf < 1
    assert found.impulse.joints.shape == found.impulse.gears.shape == (12,)
    assert found.impulse.velocity_change.shape == (18,)
    assert len(found.spatial.single_joint_giaf) == len(found.spatial.giaf_by_rotor) == 12
    # only the struck leg's rotors matter much
    assert set(np.argsort(found.spatial.single_joint_giaf)[:3]) == {0, 1, 2}


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("restitution", -0.1),
        ("restitution", 1.1),
        ("restitution", np.nan),
        ("speed", 0.0),
        ("speed", np.inf),
        ("other_mass", 0.0),
        ("other_mass", np.nan),
    ],
)
def test_numbers_out_of_range(model: ImpactModel, field: str, value: float) -> None:
    with pytest.raises(InvalidValue, match=field):
        impact_factors(model, Q, Y, **{field: value})


def test_bad_configurations(model: ImpactModel) -> None:
    with pytest.raises(WrongLength, match="q"):
        impact_factors(model, Q[:6], Y)
    with pytest.raises(InvalidValue, match="finite"):
        impact_factors(model, Q * np.nan, Y)


def test_a_planar_closed_chain_has_what_a_plane_leaves() -> None:
    robot = load_robot("rmin")
    q = close_loops(robot, closed_chain(robot).home[list(closed_chain(robot).independent)])
    model = impact_model(robot, "P", drives=drives(robot, rotor_inertia=0.01))
    found = impact_factors(model, q, [1.0, 0.0, 0.0])
    assert found.rank == 2
    assert found.spatial is None
    assert 0 < found.mass_ratio < 1
    assert found.impulse.joints.shape == found.impulse.gears.shape == (robot.n,)
    with pytest.raises(LoopCannotClose):
        impact_factors(model, q + 0.1, [1.0, 0.0, 0.0])
