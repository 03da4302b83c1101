# SPDX-License-Identifier: BSD-3-Clause
"""``softimpact simulate``: one impact, from typed options to force and verdict."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import scipy.integrate
from command_line import refusal, run, run_json

from softimpact.simulate import Approach, Controller, simulate_impact
from softimpact.symbolic import REGIONS, Contact, body_region, impact_model, load_robot

Q = "[0.2, 0.3, -0.4, -1.8, 0.1, 2, 0.5]"
WHERE = ("panda", "--q", Q, "--direction", "[0, 1, 0]", "--joint-stiffness", "1e4")
MODELS = ("one_mass", "two_mass", "chain", "linearised", "full")


def simulate(*options: object) -> dict[str, Any]:
    return run_json("simulate", *WHERE, *options)


def single_mass_peak(mass: float, speed: float, k_h: float, c_h: float) -> float:
    """Peak of f = k_f δ^1.5 on a body held by a spring and damper, with SciPy."""

    def force(state: np.ndarray) -> np.ndarray:
        return np.asarray(1.9e7 * np.maximum(state[0] - state[2], 0) ** 1.5)

    def rates(_: float, state: np.ndarray) -> list[float]:
        f = force(state)
        return [state[1], -f / mass, (f - k_h * state[2]) / c_h]

    start, grid = [0.0, speed, 0.0], np.linspace(0, 0.04, 40001)
    found = scipy.integrate.solve_ivp(
        rates, (0, 0.04), start, "LSODA", grid, rtol=1e-10, atol=1e-12
    )
    return float(force(found.y).max())


@pytest.mark.parametrize("region", ["head", "chest"])
def test_one_mass_against_scipy(region: str) -> None:
    result = simulate("--region", region, "--speed", 0.7, "--model", "one_mass")
    m_c = run_json("analyze", *WHERE)["m_c"]
    body = REGIONS[region]
    peak = single_mass_peak(m_c, 0.7, body.stiffness, body.damping)
    assert result["peak_force"] == pytest.approx(peak, rel=1e-6)


@pytest.mark.parametrize("model", MODELS)
def test_every_model_answers_in_one_form(model: str) -> None:
    result = simulate("--region", "chest", "--speed", 1, "--model", model)
    assert result["model"] == model
    assert result["peak_definition"] == "peak"
    time, force = np.array(result["time"]), np.array(result["force"])
    assert time.shape == force.shape
    assert (np.diff(time) > 0).all()
    assert force.min() >= 0
    assert force.max() == pytest.approx(result["peak_force"], rel=1e-3)
    assert result["limit"] == REGIONS["chest"].force_limit
    assert (result["verdict"] == "kept") == (result["peak"] <= result["limits"]["transient"])
    assert result["safe_speed"] is None


def test_models_converge_up_the_ladder() -> None:
    impact = ("--region", "chest", "--speed", 1)
    force = {model: simulate(*impact, "--model", model)["peak_force"] for model in MODELS}
    long_chain = simulate(*impact, "--model", "chain", "--order", 14)["peak_force"]
    assert long_chain == pytest.approx(force["linearised"], rel=1e-4)
    assert force["linearised"] == pytest.approx(force["full"], rel=0.01)
    assert abs(force["one_mass"] / force["full"] - 1) > 0.2


def test_a_region_that_gives_way_is_hit_less_hard() -> None:
    impact = ("--region", "hand", "--speed", 1)
    held, free = simulate(*impact), simulate(*impact, "--free")
    assert held == simulate(*impact, "--clamped")
    assert (held["clamped"], free["clamped"]) == (True, False)
    assert free["peak_force"] < held["peak_force"]


def test_peak_by_either_definition() -> None:
    where = (*WHERE[:3], "--direction", "[1, 0, 0]", "--joint-stiffness", 1e3, "--motors", "free")
    impact = ("simulate", *where, "--region", "head", "--speed", 1)
    whole, first = run_json(*impact), run_json(*impact, "--peak", "first_peak")
    assert whole["peak_force"] == whole["first_contact"]
    assert first["peak_force"] == first["first_peak"] == whole["first_peak"]
    assert first["first_peak"] < whole["first_contact"]  # a light tip bounces on the skull
    assert first["peak_definition"] == "first_peak"


def test_without_a_speed_an_impact_is_at_the_safe_one() -> None:
    found = simulate("--region", "chest", "--model", "chain", "--safe-speed")
    assert found["speed"] == found["safe_speed"]
    assert found["peak_force"] == pytest.approx(found["limit"], rel=1e-6)


def test_safe_speed_meets_the_limit() -> None:
    impact = ("--region", "chest", "--model", "chain")
    safe = simulate(*impact, "--speed", 1, "--safe-speed")["safe_speed"]
    there = simulate(*impact, "--speed", safe)
    assert there["peak_force"] == pytest.approx(there["limit"], rel=1e-6)


def test_joint_velocities_count_by_their_direction() -> None:
    """Held motors: others would move the contact point at a steady speed whatever they do."""
    impact = ("--region", "chest", "--speed", 1, "--position-gain", 2e4, "--motors", "held")
    slow = simulate(*impact, "--joint-velocity", "[0.1, 0, 0, 0, 0, 0, 0]")
    fast = simulate(*impact, "--joint-velocity", "[3, 0, 0, 0, 0, 0, 0]")
    assert slow["peak_force"] == pytest.approx(fast["peak_force"], rel=1e-9)
    assert slow["peak_force"] != pytest.approx(simulate(*impact)["peak_force"], rel=1e-3)


def test_table_for_people() -> None:
    outcome = run("simulate", *WHERE, "--region", "chest", "--speed", "1", "--safe-speed")
    assert (outcome.code, outcome.err) == (0, "")
    for word in ("largest force", "limit", "chest", "m/s", "ms"):
        assert word in outcome.out


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        (["--region", "knee"], "unknown body region 'knee'; known: kneecap, head, face, neck"),
        (["--model", "exact"], "unknown impact model 'exact'; known: one_mass, two_mass"),
        (["--peak", "second"], "unknown peak definition 'second'; known: peak, first_contact"),
        (["--speed", "0"], "speed: must be greater than 0"),
        (["--speed", "-1"], "speed: must be greater than 0"),
        (["--speed", "nan"], "speed: must be greater than 0"),
        (["--speed", "inf"], "speed: must be greater than 0"),
        (["--speed", "fast"], "--speed"),
        (["--joint-velocity", "[1, 0]"], "joint_velocity: has 2 values, but 7 are needed"),
        (["--joint-velocity", "[-1, 0, 0, 0, 0, 0, 0]"], "joint_velocity: must move"),
        (["--joint-velocity", "[0, 0, 0, 0, 0, 0, 0]"], "joint_velocity: must move"),
        (["--q", "[0]"], "q: has 1 values, but 7 are needed"),
        (["--direction", "[0, 0, 0]"], "direction: must not be zero"),
    ],
)
def test_bad_input(options: list[str], reason: str) -> None:
    good = {"--q": Q, "--direction": "[0, 1, 0]", "--joint-stiffness": "1e4"}
    good |= {"--region": "chest", "--speed": "1"} | {options[0]: options[1]}
    typed = [word for pair in good.items() for word in pair]
    assert reason in refusal("simulate", "panda", *typed)


def test_two_masses_need_a_spring() -> None:
    rigid = (*WHERE[:5], "--region", "chest", "--speed", "1", "--model", "two_mass")
    assert "two_mass" in refusal("simulate", *rigid)


def test_robot_that_cannot_move_that_way() -> None:
    where = ("rr", "--q", "[0, 0, 1, 0]", "--direction", "[0, 0, 1]")
    assert "cannot move" in refusal("simulate", *where, "--region", "chest", "--speed", "1")


RR = ("simulate", "rr", "--q", "[0, 0, 0, 0]", "--direction", "[0, 1, 0]", "--region", "head")


def test_controller_is_msms() -> None:
    """Scenario a with the printed gains; the reference moves on, or is held."""
    arriving = (*RR, "--speed", 1, "--joint-velocity", "[1, 0, 0, 0]", "--model", "full")
    pid = ("--pid", "[6050, 121, 1.25e5]")
    moving = run_json(*arriving, *pid)
    held = run_json(*arriving, *pid, "--reference", "held")
    model = impact_model(load_robot("rr"))
    approach = Approach(np.zeros(4), np.array([0.0, 1.0, 0.0]), 1.0, np.array([1.0, 0, 0, 0]))
    contact, controller = Contact(body_region("head")), Controller(6050, 121, 1.25e5)
    expected = simulate_impact(model, approach, contact, "full", motors=controller)
    assert moving["peak_force"] == pytest.approx(expected.first_contact, rel=1e-6)
    assert moving["controller"]["reference"] == "moving"
    assert held["peak_force"] != pytest.approx(moving["peak_force"], rel=1e-2)


def test_controllers_that_cannot_be_are_refused() -> None:
    arriving = (*RR, "--speed", 1)
    assert "pid" in refusal(*arriving, "--pid", "[6050, 121]")
    assert "--pid, k_p: must be" in refusal(*arriving, "--pid", "[-1, 121, 0]")
    assert "moving, held" in refusal(*arriving, "--pid", "[1, 1, 1]", "--reference", "lost")
    assert "--pid: needs motors" in refusal(*arriving, "--pid", "[1, 1, 1]", "--model", "one_mass")
