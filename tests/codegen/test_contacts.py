# SPDX-License-Identifier: BSD-3-Clause
"""Bodies and covers that are built into a package."""

from __future__ import annotations

import ctypes
from pathlib import Path

import numpy as np
import pytest
from command_line import refusal
from compiled_impacts import OK, OUT_OF_RANGE, Impacts
from compiled_packages import Generated

from softimpact.codegen import generate_package, region_parameters
from softimpact.symbolic import Contact, Curve, body_region, load_robot

FOAM = Curve([0, 5e-3, 15e-3, 20e-3], [0, 12, 60, 900])
CONTACTS = {
    "padded": Contact(body_region("chest"), cover=FOAM),
    "device": Contact(body_region("device_25_sh30")),
}


@pytest.mark.slow
def test_contacts_are_built_in_and_tested(tmp_path: Path) -> None:
    robot, folder, real = load_robot("rr"), tmp_path / "package", "float"
    manifest = generate_package(robot, folder, name="rr", contacts=CONTACTS)
    package = Generated(robot, str(robot.tip), folder, manifest)
    assert "all passed" in package.run_own_test("gcc", real, tmp_path / "own")
    assert "12, " in (folder / "test/golden.c").read_text()  # a golden impact of the first
    compiled = Impacts(package, real)
    for i, contact in enumerate(CONTACTS.values()):
        region, right = compiled.region("head", clamped=True), region_parameters(contact)
        entry = compiled.entry("contact_region")
        assert entry(i, 0, ctypes.byref(region)) == OK
        assert region.clamped == 0
        for name in ("stiffness", "damping", "force_limit", "quasi_static_limit"):
            assert getattr(region, name) == pytest.approx(right[name], rel=1e-7)
        law = right["law"]
        if law is None:
            assert region.law is None
            assert region.hertz_stiffness == pytest.approx(right["hertz_stiffness"], rel=1e-7)
            continue
        built = ctypes.cast(region.law, ctypes.POINTER(ctypes.c_float))[: 4 * region.law_points]
        assert np.allclose(np.reshape(built, (-1, 4)), law, rtol=1e-6, atol=0)
    assert entry(2, 0, ctypes.byref(region)) == OUT_OF_RANGE
    assert entry(-1, 0, ctypes.byref(region)) == OUT_OF_RANGE


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("pad", "contact: needs NAME=BODY[+COVER], each name once, not 'pad'"),
        ("pad=", "contact: needs NAME=BODY[+COVER]"),
        ("pad=hand+", "contact: needs NAME=BODY[+COVER]"),
        ("pad=nose", "unknown body region 'nose'"),
        ("pad=hand+nothing", "nothing: no such file, nor a pad"),
        ("a b=hand", "contacts: 'a b' is no name of one contact in C"),
    ],
)
def test_contacts_that_are_none(text: str, reason: str, tmp_path: Path) -> None:
    told = refusal("generate", "rr", "--out", tmp_path / "x", "--contact", text)
    assert reason in told
    assert not (tmp_path / "x").exists()
