# SPDX-License-Identifier: BSD-3-Clause
"""Public functions of a robot return the kind of matrix they are given; so a checker says, too."""

from __future__ import annotations

from typing import assert_type

import casadi as ca
import numpy as np

from softimpact.symbolic import (
    Robot,
    bias_torques,
    contact_point_jacobian,
    direction_jacobian,
    frame_jacobian,
    gravity_torques,
    impact_model,
    loop_gaps,
    loop_jacobian,
    loop_tangent,
    mass_matrix,
    potential_energy,
    stiffness_of_potential,
)


def test_kinds_are_kept(panda: Robot) -> None:
    """``make lint`` checks what ``assert_type`` states, this that it is so at run time."""
    x, X, numbers = ca.SX.sym("q", 7), ca.MX.sym("q", 7), np.full(7, 0.3)
    assert isinstance(assert_type(mass_matrix(panda, x), ca.SX), ca.SX)
    assert isinstance(assert_type(mass_matrix(panda, X), ca.MX), ca.MX)
    assert isinstance(assert_type(mass_matrix(panda, numbers), ca.DM), ca.DM)
    assert isinstance(assert_type(mass_matrix(panda, [0.3] * 7), ca.DM), ca.DM)
    assert isinstance(assert_type(gravity_torques(panda, x), ca.SX), ca.SX)
    assert isinstance(assert_type(bias_torques(panda, x, numbers), ca.SX), ca.SX)
    assert isinstance(assert_type(bias_torques(panda, numbers, X), ca.MX), ca.MX)
    assert isinstance(assert_type(bias_torques(panda, numbers, numbers), ca.DM), ca.DM)
    assert isinstance(assert_type(potential_energy(panda, X), ca.MX), ca.MX)
    assert isinstance(assert_type(stiffness_of_potential(panda, numbers), ca.DM), ca.DM)
    assert isinstance(assert_type(frame_jacobian(panda, "hand_tcp", x), ca.SX), ca.SX)
    assert isinstance(assert_type(contact_point_jacobian(panda, "hand", X), ca.MX), ca.MX)
    n = ca.DM([0, 1, 0])
    found = direction_jacobian(panda, "hand", ca.DM(numbers), n)
    assert isinstance(assert_type(found, ca.DM), ca.DM)
    assert isinstance(assert_type(impact_model(panda).jacobian(x), ca.SX), ca.SX)
    assert isinstance(assert_type(impact_model(panda).mass_matrix(X), ca.MX), ca.MX)


def test_kinds_are_kept_by_loops(panda: Robot) -> None:
    x, numbers = ca.SX.sym("q", 7), np.full(7, 0.3)
    assert isinstance(assert_type(loop_gaps(panda, x), ca.SX), ca.SX)
    assert isinstance(assert_type(loop_jacobian(panda, numbers), ca.DM), ca.DM)
    assert isinstance(assert_type(loop_tangent(panda, numbers), ca.DM), ca.DM)
