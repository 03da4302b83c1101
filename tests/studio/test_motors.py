# SPDX-License-Identifier: BSD-3-Clause
"""``softimpact simulate``: what motors do, the whole arm, its load, bodies and verdicts."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from command_line import refusal, run_json

from softimpact.simulate.linear_error import UNSEEN

Q = "[-1.22, 0.84, 0.72, -2.41, 0.79, 1.97, -2.04]"
WHERE = ("panda", "--q", Q, "--direction", "[0, 1, 0]")
CHEST = ("--region", "chest", "--speed", 0.5)


def simulate(*options: object) -> dict[str, Any]:
    return run_json("simulate", *WHERE, *CHEST, *options)


def test_motors_of_which_nothing_is_known_are_a_bracket() -> None:
    both = simulate("--joint-stiffness", 1e4)
    free = simulate("--joint-stiffness", 1e4, "--motors", "free")
    driven = simulate("--joint-stiffness", 1e4, "--motors", "driven")
    assert both["bracket"] == {"free": free["peak"], "driven": driven["peak"]}
    assert both["peak"] == driven["peak"] > free["peak"]
    assert both["motors"] == "driven"
    assert free["bracket"] is None
    assert free["peak"] == pytest.approx(174.6, abs=0.05)  # by an independent integration


def test_gains_are_a_servos_and_never_make_a_robot_look_safer() -> None:
    """Held motors give 129.6 N in the first contact; a reference that moves on does not."""
    stiff = ("--joint-stiffness", 1e4, "--position-gain", 1e6)
    servo = simulate(*stiff, "--reaction-time", 0.05)
    held = simulate(*stiff, "--motors", "held")
    free = simulate("--joint-stiffness", 1e4, "--motors", "free")
    assert servo["motors"] == "servo"
    assert held["first_contact"] == pytest.approx(129.6, abs=0.05)
    assert servo["peak"] > free["peak"] > held["peak"]
    assert servo["peak"] == simulate(*stiff, "--motors", "servo", "--reaction-time", 0.05)["peak"]


def test_a_later_reaction_is_worse() -> None:
    peaks = [simulate("--reaction-time", t)["peak"] for t in (0.0, 0.01, 0.02, 0.05)]
    assert peaks == sorted(peaks)
    assert peaks[0] == simulate("--motors", "free")["peak"]


def test_motors_that_stop_press_on_a_clamped_body() -> None:
    released = simulate("--motors", "driven")
    stopped = simulate("--motors", "driven", "--stopping-time", 0.1)
    assert released["pressing"] == 0
    assert stopped["pressing"] > stopped["limits"]["quasi_static"]
    assert stopped["binding"] == "quasi-static force"
    assert stopped["verdict"] == "exceeded"


def test_safe_speed_keeps_every_limit_at_both_ends() -> None:
    found = simulate("--joint-stiffness", 1e4, "--safe-speed")
    assert found["safe_speed"] == min(found["safe_speeds"].values())
    at = ("--region", "chest", "--speed", found["safe_speed"], "--joint-stiffness", 1e4)
    there = run_json("simulate", *WHERE, *at)
    # the linear robot's share; of a safe speed the nonlinear one is asked, too
    assert 1 - there["linear_error"] - UNSEEN < there["share_of_limit"] <= 1 + 1e-6


def test_unknown_rotors_are_taken_for_the_worst(tmp_path: Path) -> None:
    path = tmp_path / "arm.xml"
    path.write_text(ARM)
    where = (path, "--tip", "tool", "--q", "[0.3, 1.2]", "--direction", "[1, 0, 0]", *CHEST)
    found = run_json("simulate", *where)
    assert found["bracket"] == {"free": None, "driven": found["peak"]}
    assert "rotor inertia of joint 'j1', 'j2' is unknown" in found["warnings"][0]
    assert found["peak"] > run_json("simulate", *where, "--rotor-inertia", 0.3)["peak"]
    assert "rotor_inertia: of joint 'j1'" in refusal("simulate", *where, "--motors", "free")


def test_joints_beyond_the_contact_point_stay() -> None:
    """RR's elbow: MSM prints 6.46 kg, and without the second link it would be 17.6 kg."""
    elbow = ("analyze", "rr", "--tip", "O3", "--direction", "[0, 1, 0]")
    whole = run_json(*elbow, "--q", "[0, 0, 0, 0]")
    assert whole["m_c"] == pytest.approx(6.457, abs=5e-4)
    assert whole == run_json(*elbow, "--q", "[0, 0, 0, 0]", "--end", "P")
    short = run_json(*elbow, "--q", "[0, 0]", "--end", "O3")
    assert short["m_c"] > 17


def test_a_contact_off_the_arm_says_what_is_welded() -> None:
    finger = ("mini_cheetah", "--tip", "shank_fr", "--q", "[0.1, -0.5, 1]")
    found = run_json("analyze", *finger, "--direction", "[0, 0, 1]", "--end", "shank_fr")
    hip = ("--tip", "hip_rotor_fr@0,0,-0.05", "--q", "[0.1]", "--direction", "[0, 1, 0]")
    beyond = run_json("analyze", "mini_cheetah", *hip)
    assert found["joints"] == ["abad_fr", "hip_fr", "knee_fr"]
    assert "joints 'hip_fr', 'knee_fr' are beyond the contact point" in beyond["warnings"][0]
    off = ("analyze", *finger, "--direction", "[0, 0, 1]", "--end", "foot_fl")
    assert "not on the way from the base to 'foot_fl'" in refusal(*off)


def test_locked_joints_are_welded_where_they_are_said_to_be() -> None:
    at = ("analyze", "panda", "--direction", "[0, 1, 0]")
    whole = run_json(*at, "--q", Q)
    welded = run_json(
        *at, "--q", "[-1.22, 0.84, 0.72, -2.41, 0.79, 1.97]", "--lock", "joint7=-2.04"
    )
    assert welded["joints"] == whole["joints"][:-1]
    assert welded["m_c"] >= whole["m_c"]
    assert "unknown joint 'joint8'" in refusal(*at, "--q", Q, "--lock", "joint8=0")
    assert "NAME=X" in refusal(*at, "--q", Q, "--lock", "joint7")


def test_a_payload_weighs(tmp_path: Path) -> None:
    empty, full = simulate(), simulate("--payload", "3")
    assert full["payload"] == 3
    assert full["peak"] > empty["peak"]
    assert full["iso"]["force"] > empty["iso"]["force"]
    tool = tmp_path / "tool.toml"
    tool.write_text("mass = 3.0\ncom = [0.0, 0.0, 0.0]\n")
    assert simulate("--tool", tool)["peak"] == full["peak"]
    tool.write_text("com = [0.0, 0.0, 0.1]\n")
    assert "has no mass" in refusal("simulate", *WHERE, *CHEST, "--tool", tool)


@pytest.mark.parametrize("region", ["head", "face", "temple"])
def test_some_regions_must_not_be_hit(region: str) -> None:
    slow = run_json("simulate", *WHERE, "--region", region, "--speed", 0.01)
    assert slow["verdict"] == "not permitted"
    assert not slow["within_limit"]
    assert "is not permitted, whatever the force" in slow["warnings"][0]


def test_two_body_formula_stands_beside() -> None:
    held = simulate("--model", "one_mass")["iso"]
    assert held["force"] == pytest.approx(229, abs=0.5)
    assert simulate("--free")["iso"]["force"] == pytest.approx(208, abs=0.5)


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        (["--motors", "off"], "unknown kind of motors 'off'; known: free, servo, driven, held"),
        (["--motors", "servo"], "'servo' needs position_gain: the file has no servo"),
        (["--motors", "driven", "--position-gain", "1e3"], "position_gain: is a servo's"),
        (["--motors", "held", "--position-gain", "1", "--safe-speed"], "cannot give a safe speed"),
        (["--position-gain", "-1"], "position_gain: must be finite and ≥ 0"),
        (["--damping-gain", "-1"], "damping_gain: must be finite and ≥ 0"),
        (["--torque-limit", "0"], "torque_limit: must be greater than 0"),
        (["--reaction-time", "-0.1"], "reaction_time: must be ≥ 0 s"),
        (["--stopping-time", "0"], "stopping_time: must be finite and greater than 0 s"),
        (["--horizon", "-1"], "horizon: must be greater than 0 and at most 10 s"),
        (["--payload", "0"], "payload: needs a mass greater than 0"),
        (["--payload", "heavy"], "payload: needs MASS or MASS@x,y,z"),
        (["--payload", "1_0"], "payload: needs MASS or MASS@x,y,z"),
        (["--horizon", "1_0"], "Invalid value for --horizon: is no number; write it without '_'"),
        (["--horizon=1_0"], "Invalid value for --horizon: is no number; write it without '_'"),
        (["--q", "[-70, 48, 41, -138, 45, 113, -117]"], "it takes radians"),
        (["--cover", "none.toml"], "no such file"),
        (["--pid", "[1, 1, 1]", "--motors", "free"], "pid: excludes --motors"),
        (["--reference", "held"], "reference: is of the controller"),
    ],
)
def test_bad_input(options: list[str], reason: str) -> None:
    good = {"--q": Q, "--direction": "[0, 1, 0]", "--region": "chest", "--speed": "0.5"}
    given = [*options]
    for name in good.keys() & set(options):
        del good[name]
    typed = [word for pair in good.items() for word in pair]
    assert reason in refusal("simulate", "panda", *typed, *given)


ARM = """
<mujoco model="two"><compiler angle="radian"/><worldbody>
  <body name="upper"><joint name="j1"/>
    <inertial pos="0.2 0 0" mass="2" diaginertia="0.01 0.02 0.02"/>
    <body name="fore" pos="0.4 0 0"><joint name="j2"/>
      <inertial pos="0.15 0 0" mass="1" diaginertia="0.005 0.01 0.01"/>
      <site name="tool" pos="0.3 0 0"/>
    </body>
  </body>
</worldbody></mujoco>
"""


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        (["--motors", "driven"], "'q1' is 0, which no motor behind a spring has"),
        (["--motors", "driven", "--reaction-time", "inf"], "joint 'q2' is elastic"),
        ([], "'q1' is 0, which no motor behind a spring has"),
    ],
)
def test_motors_of_nothing_behind_springs_are_refused(options: list[str], reason: str) -> None:
    """Motors that let go move by their own inertia; joints without a motor always do."""
    where = ("--q", "0,0.4,0,0.3", "--direction", "0,1,0", "--speed", 0.3, "--region", "chest")
    assert reason in refusal("simulate", "rr", *where, "--joint-stiffness", 1e4, *options)
