# SPDX-License-Identifier: BSD-3-Clause
"""The impact inside the NLP: SUNDIALS' forces and exact derivatives, whatever motors do."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np
import pytest
from impact_cases import CHEST, POSE
from studies import study_of

from softimpact.optimize import Study, candidates
from softimpact.optimize.impact.impact_forces import (
    ContactParameters,
    ImpactDynamics,
    contact_forces,
)
from softimpact.optimize.impact.impact_program import ImpactProgram, impact_numbers, impact_program
from softimpact.optimize.impact.motor_laws import MotorLaws
from softimpact.optimize.impact.peaks import hides_a_peak, valley
from softimpact.optimize.impact.timing import MOST_STEPS, Timing, impact_timing
from softimpact.simulate import Approach, ImpactHistory, simulate_impact
from softimpact.symbolic import (
    Contact,
    InvalidValue,
    Motors,
    Robot,
    body_region,
    drives,
    impact_model,
    unit_direction,
    with_load,
)
from softimpact.symbolic.impact.motors import MotorKind
from softimpact.symbolic.robot.rigid import Array
from softimpact.toolchain import c_compiler

POSES = ("q1", "q9", "q18")

FREE: dict[str, Any] = {"kind": "free"}
SERVO: dict[str, Any] = {"position_gain": 2000.0, "damping_gain": 20.0}
DRIVEN: dict[str, Any] = {"kind": "driven"}
NO_REACTION: dict[str, Any] = {"kind": "driven", "reaction_time": inf, "horizon": 0.06}
STOP: dict[str, Any] = {"kind": "driven", "reaction": "stop", "horizon": 0.15}
COMPUTED_TORQUE: dict[str, Any] = {"position_gain": None, "computed_torque_gain": 6050.0}
GAINS = ("position_gain", "computed_torque_gain")


@dataclass(frozen=True, eq=False)
class Impacts:
    """A study's impacts as its NLP sees them."""

    study: Study
    postures: list[Array]
    timing: Timing
    program: ImpactProgram

    @staticmethod
    def of(study: Study) -> Impacts:
        postures = [candidate.q for candidate in candidates(study)]
        timing = impact_timing(study, postures)
        program = impact_program(study.model, timing.nodes, timing.substeps, compiled=False)
        return Impacts(study, postures, timing, program)

    def numbers(self, payload: float = 0.0) -> Array:
        (motors,) = self.study.motors
        study = self.study
        return impact_numbers(
            study.direction, study.speed, study.contact, motors, self.timing.step, payload
        )

    def forces(self, q: Array, springs: Array) -> Array:
        x = np.concatenate([q, np.log10(springs)])
        return np.array(self.program["forces"](x, self.numbers())).ravel()

    def peak(self, q: Array, springs: Array, payload: float = 0.0) -> float:
        x = np.concatenate([q, np.log10(springs)])
        return float(np.array(self.program["peaks"](x, self.numbers(payload), 0)).max())

    def simulated(self, q: Array, springs: Array, **options: Any) -> ImpactHistory:
        study = self.study
        approach = Approach(q, study.direction, study.speed)
        (motors,) = study.motors
        return simulate_impact(
            study.model.with_springs(springs),
            approach,
            study.contact,
            motors=motors,
            horizon=self.timing.duration,
            **options,
        )

    def springs(self, random: np.random.Generator) -> Array:
        return 10 ** random.uniform(np.log10(self.study.lower), np.log10(self.study.upper))

    def near(self, random: np.random.Generator) -> Array:
        """A posture in the neighbourhood that a search explores."""
        lower, upper = self.study.robot.limits
        q = self.postures[random.integers(len(self.postures))]
        return np.clip(q + random.uniform(-0.3, 0.3, q.size), lower, upper)


def case(folder: Path, motors: dict[str, Any], **impact: Any) -> Impacts:
    robot: dict[str, Any] = {k: motors[k] for k in GAINS if k in motors}
    other = {k: v for k, v in motors.items() if k not in robot}
    horizon = {"horizon": 0.12, **other}
    return Impacts.of(
        study_of(folder, {"impact": impact, "robot": robot, "motors": horizon}, POSES)
    )


@pytest.fixture(scope="module")
def head(tmp_path_factory: pytest.TempPathFactory) -> Impacts:
    return case(tmp_path_factory.mktemp("head"), DRIVEN, region="head")


ALL = [
    (region, clamped, motors)
    for region in ("head", "chest")
    for clamped in (True, False)
    for motors in (FREE, SERVO, DRIVEN, NO_REACTION, STOP, COMPUTED_TORQUE)
]
QUICK = (0, 7, 14, 21, 4, 11)
"""Every kind of motors once, on bodies in turn."""


@pytest.mark.parametrize(
    ("region", "clamped", "motors"),
    [pytest.param(*c, marks=[] if i in QUICK else pytest.mark.slow) for i, c in enumerate(ALL)],
)
def test_peaks_are_those_of_sundials(
    tmp_path: Path, region: str, clamped: bool, motors: dict[str, Any]
) -> None:
    impacts = case(tmp_path, motors, region=region, clamped=clamped)
    random = np.random.default_rng(1)
    for _ in range(2):
        q, springs = impacts.near(random), impacts.springs(random)
        peak = impacts.simulated(q, springs).peak
        assert impacts.peak(q, springs) == pytest.approx(peak, rel=1e-3)


def test_peaks_in_any_posture(head: Impacts) -> None:
    lower, upper = head.study.robot.limits
    random = np.random.default_rng(2)
    for _ in range(8):
        q, springs = random.uniform(lower + 0.2, upper - 0.2), head.springs(random)
        peak = head.simulated(q, springs).peak
        assert head.peak(q, springs) == pytest.approx(peak, rel=1e-3)


def test_a_load_at_the_end_counts(head: Impacts) -> None:
    q, springs = head.postures[1], head.study.nominal
    loaded = with_load(head.study.robot, head.study.model.tip, 3.0)
    model = impact_model(loaded, head.study.model.tip, drives=head.study.model.drives)
    peak = simulate_impact(
        model,
        Approach(q, head.study.direction, head.study.speed),
        head.study.contact,
        motors=head.study.motors[0],
        horizon=head.timing.duration,
    ).peak
    assert peak > 1.1 * head.peak(q, springs)
    assert head.peak(q, springs, 3.0) == pytest.approx(peak, rel=1e-3)


def test_soft_springs_at_the_stiffest_bounds_of_a_stiff_study(tmp_path: Path) -> None:
    stiff: dict[str, dict[str, Any]] = {
        "impact": {"region": "head"},
        "stiffness": {"upper": 2e6},
        "motors": {"kind": "free", "horizon": 0.1},
    }
    impacts = Impacts.of(study_of(tmp_path, stiff, POSES))
    random = np.random.default_rng(4)
    for springs in (impacts.study.upper, impacts.study.lower, impacts.springs(random)):
        q = impacts.near(random)
        peak = impacts.simulated(q, springs).peak
        assert impacts.peak(q, springs) == pytest.approx(peak, rel=1e-3)


def test_joints_too_stiff_to_simulate_are_refused(tmp_path: Path) -> None:
    study = study_of(tmp_path, {"stiffness": {"upper": 1e12}}, POSES)
    with pytest.raises(InvalidValue, match=f"stiffness.upper.*more than {MOST_STEPS}"):
        impact_timing(study, [pose.q for pose in study.poses])


@pytest.mark.parametrize("kind", ["free", "driven"])
def test_what_the_file_says_of_joints_counts(panda: Robot, kind: MotorKind) -> None:
    """Damping that stops a wrist within some steps, springs beside the motors, and gravity."""
    joints = tuple(
        replace(joint, damping=damping, stiffness=stiffness)
        for joint, damping, stiffness in zip(
            panda.joints,
            (80.0, 100.0, 50.0, 60.0, 20.0, 90.0, 5.0),
            (0.0, 3e3, 0.0, 5e3, 0.0, 2e3, 0.0),
            strict=True,
        )
    )
    robot = replace(panda, joints=joints)
    model = impact_model(robot, drives=drives(robot, 8e3), gravity=(0.0, 0.0, -9.81))
    q, n, motors = POSE, unit_direction([0.2, 1.0, -0.3]), Motors(kind)
    step, nodes, substeps = 4e-5, 500, 6
    program = impact_program(model, nodes, substeps, compiled=False)
    numbers = impact_numbers(n, 0.5, CHEST, motors, step)
    x = np.concatenate([q, np.full(7, np.log10(8e3))])
    found = float(np.array(program["peaks"](x, numbers, 0)).max())
    horizon = step * nodes * substeps
    approach = Approach(q, n, 0.5)
    expected = simulate_impact(model, approach, CHEST, motors=motors, horizon=horizon).peak
    assert found == pytest.approx(expected, rel=1e-3)
    plain = impact_model(panda, drives=drives(panda, 8e3))
    without = simulate_impact(plain, approach, CHEST, motors=motors, horizon=horizon).peak
    assert abs(expected / without - 1) > 0.02  # else nothing was tested


def test_every_contact_counts(head: Impacts) -> None:
    """Springs that let the tip bounce, and what comes after it hits harder."""
    random = np.random.default_rng(6)
    drawn = ((head.near(random), head.springs(random)) for _ in range(200))

    def bounces(q: Array, springs: Array) -> bool:
        force = head.forces(q, springs)
        return bool((force[: int(force.argmax())] <= 0).any())

    q, springs = next(each for each in drawn if bounces(*each))
    history = head.simulated(q, springs)
    assert history.peak > 1.01 * history.first_contact
    assert head.peak(q, springs) == pytest.approx(history.peak, rel=1e-3)


@pytest.mark.parametrize("motors", [FREE, DRIVEN, COMPUTED_TORQUE])
def test_derivatives_are_exact(tmp_path: Path, motors: dict[str, Any]) -> None:
    impacts = case(tmp_path, motors)
    random = np.random.default_rng(5)
    for _ in range(2):
        x = np.concatenate([impacts.near(random), np.log10(impacts.springs(random))])
        numbers = impacts.numbers()
        boundary = valley(impacts.forces(x[:7], 10 ** x[7:]))

        def peaks(at: Array, numbers: Array = numbers, boundary: int = boundary) -> Array:
            return np.array(impacts.program["peaks"](at, numbers, boundary)).ravel()

        value, exact = impacts.program["slopes"](x, numbers, boundary)
        np.testing.assert_allclose(np.array(value).ravel(), peaks(x), rtol=1e-12)
        steps = 1e-6 * np.eye(x.size)
        differences = np.array([(peaks(x + s) - peaks(x - s)) / 2e-6 for s in steps]).T
        scale = abs(differences).max()
        np.testing.assert_allclose(np.array(exact) / scale, differences / scale, atol=1e-5, rtol=0)


def seconds(function: ca.Function, *arguments: Any) -> float:
    """Processor time of a call, the least of some."""
    function(*arguments)
    best = inf
    for _ in range(7):
        begin = time.process_time()
        for _ in range(30):
            function(*arguments)
        best = min(best, time.process_time() - begin)
    return best


@pytest.mark.skipif(c_compiler() is None, reason="no C compiler")
def test_derivatives_cost_no_more_than_six_times_the_force(head: Impacts) -> None:
    study, timing = head.study, head.timing
    program = impact_program(study.model, timing.nodes, timing.substeps, compiled=True)
    x = np.concatenate([study.task_pose.q, np.log10(study.nominal)])
    at = x, head.numbers(), 60
    assert seconds(program["slopes"], *at) <= 6 * seconds(program["peaks"], *at)


def test_a_valley_parts_two_peaks() -> None:
    t = np.linspace(0, 1, 101)
    one = np.sin(np.pi * t)
    two = one * (1 - 0.5 * np.cos(4 * np.pi * t))
    assert not hides_a_peak(one, valley(one))
    assert valley(two) == 50
    assert hides_a_peak(two, 0)
    assert valley(np.zeros(0)) == 0
    assert valley(t) == 0


def laws(nodes: int = 4, **motors: Any) -> Array:
    """What motors do in intervals of 10 ms, each of one step."""
    return np.array(ca.DM(MotorLaws.of(Motors(**motors)).at_nodes(0.01, 1, nodes)))


@pytest.mark.parametrize(
    ("motors", "moves", "servo"),
    [
        ({"kind": "free"}, [1, 1, 1, 1], [0, 0, 0, 0]),
        ({"kind": "driven", "reaction_time": 0.02}, [0, 0.5, 1, 1], [0, 0, 0, 0]),
        ({"kind": "driven", "reaction_time": inf}, [0, 0, 0, 0], [0, 0, 0, 0]),
        ({"kind": "servo", "reaction_time": 0.025}, [1, 1, 1, 1], [1, 1, 0, 0]),
        ({"kind": "driven", "reaction": "stop"}, [0, 0, 0, 0], [0, 0, 0, 0]),
    ],
)
def test_what_motors_do_at_each_node(
    motors: dict[str, Any], moves: Sequence[float], servo: Sequence[float]
) -> None:
    found = laws(**motors)
    np.testing.assert_allclose(found[0], moves, atol=1e-9)
    np.testing.assert_allclose(found[2], servo, atol=1e-9)


def test_motors_that_stop_slow_down_evenly() -> None:
    speed = laws(kind="driven", reaction_time=0.02, reaction="stop", stopping_time=0.05, nodes=8)[1]
    np.testing.assert_allclose(speed, [1, 0.9, 0.7, 0.5, 0.3, 0.1, 0, 0], atol=1e-9)


def test_a_single_mass_on_a_damped_body() -> None:
    """One joint of inertia 2 at arm 1: m ẍ = −f_c alone, against a fine Runge-Kutta solution."""
    contact = Contact(body_region("chest"))
    steps, step = 6000, 1e-5
    dynamics = ImpactDynamics(
        mobility=ca.MX(0.5),
        jacobian=ca.MX(1.0),
        springs=ca.MX(1e-9),
        rotor_mobility=ca.MX(1.0),
        gains=ca.MX(1, 1),
        damping=ca.MX(0.0),
        velocity=ca.MX(1.0),
    )
    free = MotorLaws.of(Motors("free"))
    forces = contact_forces(dynamics, ContactParameters.of(contact), free, step, 150, steps // 150)
    found = np.array(ca.Function("f", [], [forces])()["o0"]).ravel()

    region = contact.region

    def rate(state: Array) -> Array:
        x, velocity, node = state
        force = contact.hertz_stiffness * max(x - node, 0.0) ** 1.5
        return np.array(
            [velocity, -force / 2.0, (force - region.stiffness * node) / region.damping]
        )

    state, expected = np.array([0.0, 1.0, 0.0]), []
    for i in range(steps):
        a = rate(state)
        b = rate(state + step / 2 * a)
        c = rate(state + step / 2 * b)
        d = rate(state + step * c)
        state = state + step / 6 * (a + 2 * b + 2 * c + d)
        if (i + 1) % 40 == 0:
            expected.append(contact.hertz_stiffness * max(state[0] - state[2], 0.0) ** 1.5)
    until = int(np.argmin(expected))
    np.testing.assert_allclose(found[:until], expected[:until], atol=1e-3 * max(expected))
    assert max(found) == pytest.approx(max(expected), rel=1e-4)
    assert not np.any(found[until + 1 :])
