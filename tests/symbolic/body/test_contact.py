# SPDX-License-Identifier: BSD-3-Clause
"""Hertz's law."""

import casadi as ca
import pytest
from symbol_kinds import KINDS

from softimpact.symbolic import Contact, body_region


@pytest.mark.parametrize(
    ("depth", "force"), [(1e-4, 19.0), (4e-4, 152.0), (0.0, 0.0), (-1e-3, 0.0)]
)
def test_force_is_hertz_law_and_never_pulls(depth: float, force: float) -> None:
    contact = Contact(body_region("head"))
    assert float(contact.force(ca.DM(depth))) == pytest.approx(force, rel=1e-12)
    for kind in KINDS:
        x = kind.sym("x")
        assert float(ca.Function("f", [x], [contact.force(x)])(depth)) == pytest.approx(force)


def test_force_has_a_slope_everywhere() -> None:
    """Integrators and solvers differentiate it before, at and after the first touch."""
    x = ca.SX.sym("x")
    slope = ca.Function("s", [x], [ca.jacobian(Contact(body_region("head")).force(x), x)])
    assert float(slope(1e-4)) == pytest.approx(1.5 * 1.9e7 * 1e-2)
    assert float(slope(-1e-4)) == 0.0
    assert float(slope(0.0)) == 0.0


def test_skin_can_be_another() -> None:
    assert float(Contact(body_region("head"), hertz_stiffness=1e6).force(0.01)) == pytest.approx(
        1e3
    )
    assert Contact(body_region("chest")).clamped


def test_a_device_is_named_by_its_spring_and_its_pad() -> None:
    device = body_region("device_75_sh70")
    assert (device.stiffness, device.damping) == (75e3, 0.0)
    assert device.title == "Device, K2 75 N/mm, K1 sh70"
