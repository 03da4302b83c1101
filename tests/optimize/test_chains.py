# SPDX-License-Identifier: BSD-3-Clause
"""Studies of closed chains, coupled joints, passive springs, rigid motors and free bases."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from typing import Any, Literal

import casadi as ca
import numpy as np
import pytest
from mechanisms import FOUR_BAR
from robot_files import many_joints
from studies import InProcess, written

from softimpact.optimize import Study, design, load_study
from softimpact.optimize.bounds.natural_frequency import NaturalFrequency
from softimpact.optimize.evaluation import figures, largest_share
from softimpact.optimize.impact.impact_program import _posture, _pulled_back, impact_program
from softimpact.optimize.impact.timing import Timing
from softimpact.optimize.machine.postures import closure, side_function
from softimpact.optimize.search.problem import peak_force, prepare
from softimpact.optimize.study.poses import leaves_a_choice
from softimpact.simulate import Approach, many_peaks
from softimpact.symbolic import InvalidValue, Motors
from softimpact.symbolic.impact.floating import base_held
from softimpact.symbolic.loops.loops import closed_chain, nearest_to_closed

RMIN: dict[str, Any] = {
    "robot": {"model": "rmin", "tip": "O13"},
    "impact": {"region": "chest", "direction": [1.0, 0.0, 0.0], "speed": 0.5},
    "motors": {"horizon": 0.1},
    "stiffness": {"rigid": ["q11", "q21"], "lower": 20.0, "upper": 2000.0, "nominal": 351.0},
    "accuracy": {"forces": [[5.0, 0.0, 0.0], [0.0, 0.0, 5.0]], "max_deflection": 0.001},
    "bounds.natural_frequency": {"least": 30.0},
    "task": {"pose_of": "impact", "exact": False},
    "poses": [{"name": "impact", "q": [-2.2794, -0.872665]}],
}
LEG: dict[str, Any] = {
    **RMIN,
    "robot": {
        "model": "mini_cheetah",
        "tip": "foot_fl",
        "floating": True,
        "lock": {"hip_hr": -0.8},
    },
    "stiffness": {"lower": 10.0, "upper": 2000.0, "nominal": 500.0},
    "poses": [{"name": "impact", "q": [0.1, -0.8, 1.6]}],
}
PLANAR = """<mujoco><worldbody>{links}</worldbody>{more}</mujoco>"""
LINK = (
    "<body pos='{at} 0 0'><joint name='{name}' axis='0 0 1' armature='{rotor}'/>"
    "<inertial mass='{mass}' pos='0.15 0 0' diaginertia='0.02 0.02 {about}'/>"
)


def study_of(folder: Path, content: dict[str, Any], **changes: dict[str, Any]) -> Study:
    merged = dict(content)
    for section, fields in changes.items():
        merged[section] = {**merged[section], **fields}
    return load_study(written(folder, merged))


def by_the_nlp(study: Study, springs: np.ndarray[Any, Any]) -> float:
    """The peak that a search sees, in CasADi's virtual machine."""
    timing = Timing(study.horizon, 500, 2)
    program = impact_program(study.model, timing.nodes, timing.substeps, compiled=False)
    return peak_force(study, program, timing, study.poses[0].q, springs)


def simulated(study: Study, springs: np.ndarray[Any, Any]) -> float:
    """The same by vibration modes, which share nothing with it but M, K and J."""
    approach = Approach(study.poses[0].q, study.direction, study.speed)
    return max(
        float(
            many_peaks(
                study.with_springs(springs),
                approach,
                study.contact,
                [study.speed],
                motors=motors,
                horizon=study.horizon,
            ).peak[0]
        )
        for motors in study.motors
    )


LAWS: dict[str, dict[str, Any]] = {
    "servo": {"kind": "servo", "position_gain": 3000.0, "damping_gain": 20.0},
    "stop": {"kind": "driven", "reaction": "stop", "stopping_time": 0.05},
}


CASES: dict[str, tuple[dict[str, Any], dict[str, Any]]] = {
    "rmin, servo": (RMIN, {"motors": LAWS["servo"]}),
    "rmin, bracket": (RMIN, {}),
    "leg, stop": (LEG, {"motors": LAWS["stop"]}),
    "leg, two rigid": (LEG, {"stiffness": {"rigid": ["abad_fl", "hip_fl"]}}),
}


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
def test_forces_are_those_of_the_simulation(tmp_path: Path, case: str) -> None:
    content, changes = CASES[case]
    study = study_of(tmp_path, content, **changes)
    for share in (0.1, 0.7):
        springs = study.lower ** (1 - share) * study.upper**share
        assert by_the_nlp(study, springs) == pytest.approx(simulated(study, springs), rel=6e-3)


@pytest.mark.slow
def test_no_springs_of_rmin_are_better(tmp_path: Path) -> None:
    """Brute force over both springs; the best of them by simulation, too."""
    study = study_of(tmp_path, RMIN)
    found = design(study, executor=InProcess()).winner
    assert found.solved
    assert largest_share(study, found.q, found.springs) <= 1 + 1e-5
    assert simulated(study, found.springs) == pytest.approx(found.force, rel=3e-3)
    problem, axis = prepare(study), np.geomspace(60, 2000, 20)
    grid = [np.array([a, b]) for a in axis for b in axis]
    allowed = [k for k in grid if largest_share(study, found.q, k) <= 1]
    assert 20 < len(allowed) < len(grid)
    program, timing = problem.program.impacts[0], problem.timing
    forces = [peak_force(study, program, timing, found.q, k) for k in allowed]
    assert found.force < min(forces) * 1.001
    assert simulated(study, allowed[int(np.argmin(forces))]) > found.force * 0.999


def test_a_leg_swings_against_its_free_trunk(tmp_path: Path) -> None:
    """Its first frequency is that of the whole linear model, the trunk's six motions left out."""
    study = study_of(tmp_path, LEG)
    springs, q = np.array([100.0, 200.0, 300.0]), study.poses[0].q
    own = float(figures(NaturalFrequency(1.0), study, q, springs)[0])
    linear = study.with_springs(springs).linear(q, study.direction, "driven")
    M, K = np.array(linear.mass.matrix), np.array(linear.stiffness)
    squares = np.sort(np.linalg.eigvals(np.linalg.solve(M, K)).real)
    assert abs(squares[:6]).max() < 1e-6 * squares[6]
    assert own == pytest.approx(np.sqrt(squares[6]) / (2 * np.pi), rel=5e-3)
    assert own <= np.sqrt(squares[6]) / (2 * np.pi) * (1 + 1e-9)


def test_a_held_base_is_heavier(tmp_path: Path) -> None:
    study = study_of(tmp_path, LEG)
    q, n = study.poses[0].q, ca.DM(study.direction)
    held = base_held(study.model)
    assert held.robot.n == 3
    assert float(held.reflected_mass(q[6:], n)) > float(study.model.reflected_mass(q, n))


@pytest.mark.parametrize(
    ("changes", "reason"),
    [
        ({"accuracy": {"sag": True}}, "accuracy.sag: of a floating robot depends on"),
        ({"bounds": {"torque": {"most": 1.0}}}, "bounds.torque: of a floating robot depends on"),
        ({"robot": {"hold_base": True}}, "robot.floating: excludes hold_base"),
        ({"stiffness": {"rigid": ["knee"]}}, "unknown joint with a motor 'knee'"),
        ({"stiffness": {"rigid": ["abad_fl", "hip_fl", "knee_fl"]}}, "leaves no joint"),
        ({"robot": {"lock": {"hip": 0.1}}}, "unknown joint (robot.lock) 'hip'"),
        ({"hardware": {"link_mass": {"lower": 0.5, "upper": 1.0}}}, "hardware.link_mass: is for"),
    ],
)
def test_what_a_floating_robot_cannot_have(
    tmp_path: Path, changes: dict[str, dict[str, Any]], reason: str
) -> None:
    content = {**LEG, "bounds": {}, "hardware": {}}
    del content["bounds.natural_frequency"]
    with pytest.raises(InvalidValue) as caught:
        study_of(tmp_path, content, **changes)
    assert reason in str(caught.value)


@pytest.mark.parametrize(
    ("q", "reason"),
    [
        ([0.0] * 6, "loop 'end_point' does not close"),
        ([0.1, 0.2, 0.3], "has 3 values, but 6 are needed, or 2 of the motors alone (q11, q21)"),
        ([3.1416, 0.0], "loop 'end_point' does not close"),
    ],
)
def test_poses_close_their_loops(tmp_path: Path, q: list[float], reason: str) -> None:
    with pytest.raises(InvalidValue) as caught:
        study_of(tmp_path, {**RMIN, "poses": [{"name": "impact", "q": q}]})
    assert reason in str(caught.value)


def test_two_ways_to_assemble_a_chain_differ(tmp_path: Path) -> None:
    """A free search may not end in another one than it began with."""
    study = study_of(tmp_path, RMIN)
    side, q = side_function(study.model), study.poses[0].q
    assert side is not None
    chain, flipped = closed_chain(study.robot), q.copy()
    flipped[list(chain.dependent)] *= -0.3
    flipped = nearest_to_closed(chain, flipped, chain.dependent)
    assert abs(np.array(closure(study.model, ca.DM(flipped)))).max() < 1e-9
    assert abs(flipped - q).max() > 0.5
    assert float(side(q)) * float(side(flipped)) < 0
    (tmp_path / "open").mkdir()
    assert side_function(study_of(tmp_path / "open", LEG).model) is None


def test_springs_of_joints_that_follow_are_refused(tmp_path: Path) -> None:
    usual = {"tilt": "0", "crank": "0.2", "length": "0.5", "lift": "0", "more": "", "equality": ""}
    (tmp_path / "bar.xml").write_text(FOUR_BAR.format(**usual, key="1 -0.4 1.7"))
    with pytest.raises(InvalidValue) as caught:
        study_of(tmp_path, RMIN, robot={"model": "bar.xml", "tip": "tool"})
    assert "joint 'rocker' has a spring of its own, but follows from others" in str(caught.value)


RODS = (
    "<body pos='0.1 0 0'><joint name='j1' axis='0 0 1' armature='0.3'/>{light}"
    "<body pos='0 0.1 0'><joint name='rod' axis='0 0 1'/>{light}<site name='eye' pos='0.2 0 0'/>"
    "</body></body>"
)
"""A crank and a rod that move the second link as a parallelogram."""

Kind = Literal["plain", "coupled", "looped"]


def planar(kind: Kind) -> str:
    """Four links in a plane, the second moved by its motor, by half its angle, or through rods."""
    light = "<inertial mass='1e-9' pos='0 0 0' diaginertia='1e-12 1e-12 1e-12'/>"
    links, ends, more = "", 4, ""
    for i in range(4):
        usual = {"at": 0.3 if i else 0.0, "mass": 2, "about": 0.02}
        if kind == "coupled" and i == 1:
            half = {"at": 0.3, "mass": 1e-9, "about": 1e-12, "rotor": 0.0}
            links += LINK.format(name="half", **half)
            links += LINK.format(name="j1", **(usual | {"at": 0.0, "rotor": 4 * 0.3}))
            ends, more = 5, "<joint joint1='half' joint2='j1'/>"
        elif kind == "looped" and i == 1:
            links += RODS.format(light=light) + LINK.format(name="follows", rotor=0.0, **usual)
            links += "<site name='knuckle' pos='0 0.1 0'/>"
            more = "<connect name='rods' site1='knuckle' site2='eye'/>"
        else:
            links += LINK.format(name=f"j{i}", rotor=0.3, **usual)
    links += "<site name='tool' pos='0.3 0 0'/>" + "</body>" * ends
    motors = "".join(f"<motor joint='j{i}'/>" for i in range(4))
    tied = f"<equality>{more}</equality><actuator>{motors}</actuator>"
    return PLANAR.format(links=links, more=tied)


def planar_study(folder: Path, kind: Kind) -> Study:
    (folder / "arm.xml").write_text(planar(kind))
    ends = np.array([[300.0] * 4, [1e4] * 4, [3e3] * 4])
    if kind == "coupled":
        ends[:, 1] *= 4  # half the angle
    lower, upper, nominal = ends.tolist()
    content = {
        **RMIN,
        "robot": {"model": "arm.xml", "tip": "tool"},
        "impact": {**RMIN["impact"], "direction": [0.0, 1.0, 0.0]},
        "stiffness": {"lower": lower, "upper": upper, "nominal": nominal},
        "accuracy": {"forces": [[30.0, 0.0, 0.0], [0.0, 30.0, 0.0]], "max_deflection": 5e-3},
        "task": {"pose_of": "impact", "exact": True},
        "poses": [{"name": "impact", "q": [0.3, 0.35 if kind == "coupled" else 0.7, 0.7, 0.7]}],
        "bounds.natural_frequency": {"least": 3.0},
    }
    return study_of(folder, content)


@pytest.mark.slow
def test_tied_arms_are_designed_as_the_arm_that_they_are(tmp_path: Path) -> None:
    """Springs and posture sought, couplings and loops kept: as with a motor at the joint."""
    kinds: tuple[Kind, ...] = ("plain", "coupled", "looped")
    forces = []
    for kind in kinds:
        folder = tmp_path / kind
        folder.mkdir()
        study = planar_study(folder, kind)
        assert leaves_a_choice(study)
        found = design(study, executor=InProcess()).winner
        assert found.mode == "free"
        assert abs(np.array(closure(study.model, ca.DM(found.q)))).max(initial=0.0) < 1e-6
        at = replace(study, poses=(replace(study.poses[0], q=found.q),))
        assert simulated(at, found.springs) == pytest.approx(found.force, rel=3e-3)
        forces.append(found.force)
    assert forces == pytest.approx([forces[0]] * 3, rel=2e-3)


@pytest.mark.slow
def test_fourteen_joints_have_derivatives_that_compile(tmp_path: Path) -> None:
    """A row of derivatives takes few operations; all rows at once took 208,000, and minutes."""
    (tmp_path / "arm.urdf").write_text(many_joints(14))
    content = {
        **LEG,
        "robot": {"model": "arm.urdf", "tip": "tool", "rotor_inertia": 0.3},
        "poses": [{"name": "impact", "q": [0.3] * 14}],
    }
    study = study_of(tmp_path, content)
    posture = _posture(study.model, study.model.tip, ("springs",))
    back = _pulled_back(posture)
    assert posture.n_instructions() < 12_000
    assert back.n_instructions() < 4 * posture.n_instructions()
    x, p, rows = np.random.default_rng(0).uniform(0.3, 0.6, (3, 1000))
    x, p, row = x[: back.numel_in(0)], p[: back.numel_in(1)], rows[: back.numel_in(2)]
    step = 1e-6 * np.cos(np.arange(x.size))
    ahead, behind = (np.array(posture(x + s * step, p)).ravel() for s in (1, -1))
    slope = float(np.array(back(x, p, row)).ravel() @ step)
    assert slope == pytest.approx(float(row @ (ahead - behind)) / 2, rel=1e-6)


def test_motors_are_known_by_the_joints_they_drive(tmp_path: Path) -> None:
    """R-Min's file says that its rotors are nothing: they can be free, as they are rigid."""
    assert [motors.kind for motors in study_of(tmp_path, RMIN).motors] == ["free", "driven"]
    driven = study_of(tmp_path, RMIN, motors={"kind": "driven"})
    assert driven.motors == (Motors("driven", 0.02),)
