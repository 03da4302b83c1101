# SPDX-License-Identifier: BSD-3-Clause
"""What GIAF's figures say about the Panda, and where its factors meet the peak force.

No number is printed for any figure; statements in words are checked for every set of rotors that
is in use and for flange and hand.
"""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np
import pytest
from studies import PANDA_24

from softimpact.optimize import Study, candidates, load_study
from softimpact.optimize.posture.tip_pose import tip_pose
from softimpact.papers.factor_study.agreement import spearman
from softimpact.papers.factor_study.functions import factor_functions
from softimpact.papers.factor_study.heavy_base import MASSES, on_heavy_base
from softimpact.papers.factor_study.poses import ANGLES, PoseFactors, pose_factors
from softimpact.simulate import Approach, simulate_impact
from softimpact.symbolic import Contact, body_region, impact_model
from softimpact.symbolic.robot.rigid import Array

SETS = ("drake_fr3", "menagerie_fr3", "menagerie_panda")


@pytest.fixture(scope="module")
def study() -> Study:
    return load_study(PANDA_24)


@pytest.fixture(scope="module")
def poses(study: Study) -> list[Array]:
    return [candidate.q for candidate in candidates(study)]


@pytest.fixture(scope="module", params=["hand_tcp", "flange"])
def by_set(
    request: pytest.FixtureRequest, study: Study, poses: list[Array]
) -> dict[str, PoseFactors]:
    model = replace(study.model, tip=request.param)
    functions, axes = factor_functions(model), tip_pose(model, poses[0])[1]
    return {
        name: pose_factors(
            functions, poses, study.robot.rotor_inertia_set(name), study.direction, axes
        )
        for name in SETS
    }


@pytest.mark.parametrize("name", SETS)
def test_giaf_falls_with_rotors_and_gears(by_set: dict[str, PoseFactors], name: str) -> None:
    """Fig. 2."""
    for sweep in (by_set[name].inertia_sweep, by_set[name].gear_sweep):
        assert (np.diff(sweep, axis=1) < 0).all()
        np.testing.assert_allclose(sweep[:, 2], by_set[name].giaf)


@pytest.mark.parametrize("name", SETS)
def test_remark_on_directions_holds_in_the_tips_axes(
    by_set: dict[str, PoseFactors], name: str
) -> None:
    """Fig. 4: in the xy plane more is absorbed at 150° than at 90°. Not so in the base's axes."""
    at_90, at_150 = (int(np.argmin(abs(ANGLES - np.radians(angle)))) for angle in (90, 150))
    in_tip, in_base = by_set[name].polar["tip_xy"], by_set[name].polar["base_xy"]
    assert in_tip[at_150] > in_tip[at_90]
    assert in_base[at_150] < in_base[at_90]


@pytest.mark.parametrize("name", SETS)
def test_polar_plots_repeat_after_half_a_turn(by_set: dict[str, PoseFactors], name: str) -> None:
    for curve in by_set[name].polar.values():
        np.testing.assert_allclose(curve[:180], curve[180:360], rtol=1e-9)
        assert ((curve > 0) & (curve <= 1)).all()


def forces(study: Study, poses: list[Array], n: Array, stiffness: float) -> Array:
    rigid = impact_model(study.robot)
    model = rigid if np.isinf(stiffness) else study.model.with_springs(ca.DM(7 * [stiffness]))
    contact = Contact(body_region("head"))
    runs = [simulate_impact(model, Approach(q, n, 1.0), contact) for q in poses]
    return np.array([run.first_contact for run in runs])


@pytest.mark.parametrize("axis", [*(pytest.param(i, marks=pytest.mark.slow) for i in (0, 1)), 2])
def test_masses_order_forces_at_both_ends_and_giaf_does_not(
    study: Study, poses: list[Array], axis: int
) -> None:
    """Soft joints: m_c puts the poses in the order of their forces. Rigid joints: (nᵀΛ⁻¹n)⁻¹."""
    n = np.eye(3)[axis]
    functions = factor_functions(study.model)
    found = [functions.at(q, study.robot.armature, n) for q in poses]
    soft, rigid = (forces(study, poses, n, k) for k in (100.0, np.inf))
    assert spearman(np.array([f.mass_free for f in found]), soft) > 0.99
    assert spearman(np.array([f.mass_rigid for f in found]), rigid) > 0.99
    zeta = np.array([f.giaf for f in found])
    # of the soft robot's order ζ knows nothing, of the rigid one's only along z
    assert abs(spearman(zeta, soft)) < 0.2
    expected = {0: 0.08, 1: 0.27, 2: -0.96}
    assert spearman(zeta, rigid) == pytest.approx(expected[axis], abs=0.05)


@pytest.mark.slow
def test_fixed_base_as_a_heavy_floating_one(study: Study, poses: list[Array]) -> None:
    """ξ → 1 in every pose for every set of rotors, while ζ goes to the fixed robot's."""
    sets = {name: study.robot.rotor_inertia_set(name) for name in SETS}
    few = poses[::8]
    functions = factor_functions(study.model)
    for name, found in on_heavy_base(study.model, few, sets).items():
        assert (np.diff(found.not_mitigated, axis=1) < 0).all()
        assert found.not_mitigated[:, -1].max() < 1e-6
        share = found.not_mitigated[:, -1] * MASSES[-1]
        np.testing.assert_allclose(found.not_mitigated[:, -5] * MASSES[-5], share, rtol=1e-3)
        fixed = [functions.at(q, sets[name], study.direction).giaf for q in few]
        np.testing.assert_allclose(found.giaf[:, -1], fixed, rtol=1e-5)
