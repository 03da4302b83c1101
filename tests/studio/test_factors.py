# SPDX-License-Identifier: BSD-3-Clause
"""``softimpact factors`` on fixed and floating robots, and what it refuses."""

from __future__ import annotations

import numpy as np
import pytest
from command_line import refusal, run, run_json
from oracles import example_urdf

Q = "[0, 0.3, 0, -1.8, 0.1, 2, 0.5]"
PANDA = ("factors", "panda", "--q", Q, "--direction", "[0, 1, 0]")
STANCE = str([0.0, 0.9, -1.8] * 4)
GO2 = example_urdf("go2.urdf")
LEGGED = ("factors", GO2, "--tip", "FL_foot", "--q", STANCE, "--direction", "[0, 0, 1]")


def test_agrees_with_analyze() -> None:
    found = run_json(*PANDA)
    reference = run_json("analyze", *PANDA[1:])
    for name in ("giaf", "giif", "directional_giaf", "osim", "osim_free", "reflected_mass_rigid"):
        assert found[name] == reference[name]
    assert found["floating"] is False
    assert found["imf"] is None
    assert found["other_mass"] is None
    assert len(found["single_joint_giaf"]) == len(found["impulse"]["joints"]) == 7


def test_gear_ratio_counts_squared() -> None:
    reflected = run_json(*PANDA, "--rotor-inertia", "0.4")
    geared = run_json(*PANDA, "--rotor-inertia", "0.0001", "--gear-ratio", f"{4000**0.5}")
    assert geared["giaf"] == pytest.approx(reflected["giaf"], rel=1e-9)


def test_named_rotor_inertias() -> None:
    found = [
        run_json(*PANDA, "--rotor-inertia", name)["giaf"] for name in ("drake_fr3", "menagerie_fr3")
    ]
    assert found[0] < found[1]


def test_restitution_adds_impulse() -> None:
    plastic = run_json(*PANDA)["impulse"]
    elastic = run_json(*PANDA, "--restitution", "1")["impulse"]
    np.testing.assert_allclose(elastic["joints"], 2 * np.array(plastic["joints"]))
    light = run_json(*PANDA, "--other-mass", "0.6", "--speed", "2")["impulse"]
    expected = 2 / (1 / plastic["contact"] + 1 / 0.6)
    assert light["contact"] == pytest.approx(expected)


def test_quadruped_on_its_feet() -> None:
    found = run_json(*LEGGED, "--floating", "--rotor-inertia", "0.01")
    assert found["floating"] is True
    assert len(found["joints"]) == len(found["q"]) == 12
    assert 0.6 < found["imf"] < 0.7
    assert 0.85 < found["directional_imf"] < 0.9
    assert 0.1 < found["giaf"] < 0.15
    held = run_json(
        "factors",
        GO2,
        "--tip",
        "FL_foot",
        "--q",
        "[0, 0.9, -1.8]",
        "--direction",
        "[0, 0, 1]",
        "--rotor-inertia",
        "0.01",
    )
    assert held["imf"] is None
    assert held["giaf"] != found["giaf"]


def test_planar_robot_has_null_where_nothing_applies() -> None:
    found = run_json("factors", "rr", "--q", "[0.1, 0, 0.7, 0]", "--direction", "[0, 1, 0]")
    assert found["rank"] == 2
    assert found["giaf"] is None
    assert found["single_joint_giaf"] is None
    assert found["giaf_movable"] == pytest.approx(1)


@pytest.mark.parametrize(
    ("arguments", "warnings"),
    [
        (PANDA, []),
        ((*LEGGED, "--floating"), ["rotor inertia of joint 'FL_hip_joint'"]),  # its file has none
        (("factors", "rr", "--q", "[0,0,1,0]", "--direction", "[0,1,0]"), []),
    ],
)
def test_tables(arguments: tuple[str, ...], warnings: list[str]) -> None:
    outcome = run(*arguments)
    assert outcome.code == 0
    assert "GIAF" in outcome.out
    lines = outcome.err.splitlines()
    assert len(lines) == len(warnings)
    assert all(warning in line for warning, line in zip(warnings, lines, strict=True))


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--restitution", "1.5"), "restitution: must be from 0 to 1"),
        (("--restitution", "nan"), "restitution"),
        (("--speed", "0"), "speed: must be finite and greater than 0"),
        (("--other-mass", "-1"), "other_mass: must be greater than 0"),
        (("--rotor-inertia", "[1, 2]"), "rotor_inertia: has 2 values, but 7 are needed"),
        (("--rotor-inertia", "nobody"), "unknown rotor inertia set 'nobody'"),
        (("--gear-ratio", "100"), "gear_ratio: needs rotor_inertia"),
        (("--tip", "nose"), "unknown frame 'nose'"),
        (("--floating",), "its base has no mass"),
    ],
)
def test_bad_options(options: tuple[str, ...], words: str) -> None:
    assert words in refusal(*PANDA, *options)


def test_floating_takes_all_joints() -> None:
    message = refusal(
        "factors",
        GO2,
        "--tip",
        "FL_foot",
        "--floating",
        "--q",
        "[0, 0.9, -1.8]",
        "--direction",
        "[0, 0, 1]",
    )
    assert "q: has 3 values, but 12 are needed" in message


def test_floating_needs_a_tip() -> None:
    message = refusal("factors", GO2, "--floating", "--q", STANCE, "--direction", "[0, 0, 1]")
    assert "tip" in message
    assert "FL_foot" in message


def test_direction_that_cannot_be() -> None:
    message = refusal("factors", "rr", "--q", "[0, 0, 1, 0]", "--direction", "[0, 0, 1]")
    assert "cannot move along direction" in message
