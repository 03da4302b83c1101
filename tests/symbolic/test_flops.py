# SPDX-License-Identifier: BSD-3-Clause
"""How short the Panda's expressions are; the targets are the project's (sines are not counted)."""

from __future__ import annotations

from collections.abc import Callable

import casadi as ca
import pytest
from oracles import example_urdf

from softimpact.symbolic import (
    Matrix,
    count_flops,
    drives,
    giaf,
    impact_model,
    load_robot,
    mass_matrix,
)
from softimpact.symbolic.dynamics.equations_of_motion import _mass_matrix

AXES_OF = 3
"""GIAF comes out shortest in the axes of the fourth joint."""


def expressions() -> dict[str, Matrix]:
    """The four quantities of a 14-coordinate Panda with numeric rotors and symbolic springs."""
    robot = load_robot("panda")
    q, n, k_s = ca.SX.sym("q", 7), ca.SX.sym("n", 3), ca.SX.sym("k_s", 7)
    model = impact_model(robot, drives=drives(robot, joint_stiffness=1.0)).with_springs(k_s)
    triple = model.reduced(q, n)
    return {
        "mass_matrix": model.mass_matrix(q),
        "m_c": model.reflected_mass(q, n),
        "m_c, k_r, m_a": ca.vertcat(triple.m_c, triple.k_r, triple.m_a),
        "giaf": giaf(model.free_mobility(q, AXES_OF), model.mobility(q, AXES_OF)),
    }


@pytest.mark.parametrize(
    ("name", "target"),
    [("mass_matrix", 420), ("m_c", 720), ("m_c, k_r, m_a", 1400), ("giaf", 1400)],
)
def test_flops_of_the_panda_stay_below_target(
    name: str, target: int, record_property: Callable[[str, object], None]
) -> None:
    flops = count_flops(expressions()[name])
    record_property(f"flops of {name}", flops)
    print(f"{name}: {flops} flops (target {target})")
    assert flops <= target


@pytest.mark.parametrize("file", ["panda.urdf", "ur5_robot.urdf", "kinova.urdf"])
def test_customisation_pays(file: str) -> None:
    """Sparse frames and base parameters save a tenth of M(q) at the least."""
    robot = load_robot(example_urdf(file))
    q = ca.SX.sym("q", robot.n)
    plain, customised = count_flops(_mass_matrix(robot, q)), count_flops(mass_matrix(robot, q))
    print(f"{file}: {customised} flops instead of {plain}")
    assert customised < 0.9 * plain
