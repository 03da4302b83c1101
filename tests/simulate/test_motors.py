# SPDX-License-Identifier: BSD-3-Clause
"""What motors do in an impact, against an independent integration."""

from __future__ import annotations

from dataclasses import replace

import mujoco
import numpy as np
import pytest
from impact_cases import CHEST, EARTH, FREE_HEAD, HEAD, POSE
from independent_impacts import arm_of, force_by_scipy
from mujoco_impacts import STEP, extrapolated, impact_forces

from softimpact.robots import built_in_robots
from softimpact.simulate import Approach, Fidelity, simulate_impact
from softimpact.simulate.many import many_peaks
from softimpact.symbolic import (
    Contact,
    ImpactModel,
    Motors,
    Robot,
    approach_velocity,
    drives,
    impact_model,
    unit_direction,
)
from softimpact.symbolic.impact.motors import MotorKind
from softimpact.symbolic.robot.rigid import Array

SPRINGS = np.array([2e4, 1e4, 8e3, 1.5e4, 5e3, 3e3, 4e3])
SOME_RIGID = np.array([np.inf, 1e4, 8e3, np.inf, 5e3, 3e3, np.inf])
GAINS = np.array([3e3, 4e3, 2e3, 3e3, 1.5e3, 1e3, 800.0])
DAMPING_GAINS = np.array([60.0, 80.0, 40.0, 50.0, 20.0, 10.0, 8.0])
ASKEW = np.array([0.4, 1.0, -0.3])

KINDS = [
    Motors("free"),
    Motors("servo", 0.012),
    Motors("servo", np.inf),
    Motors("servo", 0.01, "stop", 0.03),
    Motors("driven", 0.012),
    Motors("driven", np.inf),
    Motors("driven", 0.01, "stop", 0.03),
    Motors("free", 0.015, "stop", 0.02),
    Motors("held"),
]


def panda_with(robot: Robot, springs: object, **options: object) -> ImpactModel:
    given = drives(robot, springs, position_gain=GAINS, damping_gain=DAMPING_GAINS, **options)  # type: ignore[arg-type]
    return impact_model(robot, drives=given, gravity=EARTH)


def damped(robot: Robot) -> Robot:
    """The robot with dampers at its joints."""
    joints = [replace(j, damping=3.0 + i) for i, j in enumerate(robot.joints)]
    return replace(robot, joints=tuple(joints))


def agrees(
    model: ImpactModel,
    approach: Approach,
    contact: Contact,
    motors: Motors,
    fidelity: Fidelity,
    until: float = 0.06,
) -> float:
    """Return how far the force is from SciPy's up to a time, over its largest one."""
    ours = simulate_impact(model, approach, contact, fidelity, motors=motors, horizon=until)
    seen = ours.time <= until
    times = ours.time[seen][::4]
    arm = arm_of(model, approach, full=fidelity == "full")
    theirs = force_by_scipy(arm, contact, motors, times)
    assert theirs.max() > 20
    return float(abs(ours.force[seen][::4] - theirs).max() / theirs.max())


@pytest.mark.parametrize(
    "contact",
    [HEAD, *(pytest.param(other, marks=pytest.mark.slow) for other in (FREE_HEAD, CHEST))],
    ids=["head", "free head", "chest"],
)
@pytest.mark.parametrize("motors", KINDS, ids=str)
def test_linearised(panda: Robot, motors: Motors, contact: Contact) -> None:
    for robot, springs in ((panda, SPRINGS), (damped(panda), SOME_RIGID)):
        model = panda_with(robot, springs)
        assert agrees(model, Approach(POSE, ASKEW, 0.6), contact, motors, "linearised") < 1e-5


QUICK = (1, 6)
"""Of the kinds, those whose nonlinear impacts are always tested."""


@pytest.mark.parametrize(
    "motors",
    [pytest.param(k, marks=[] if i in QUICK else pytest.mark.slow) for i, k in enumerate(KINDS)],
    ids=str,
)
def test_full(panda: Robot, motors: Motors) -> None:
    for robot, springs in ((panda, SPRINGS), (damped(panda), SOME_RIGID)):
        model = panda_with(robot, springs)
        assert agrees(model, Approach(POSE, ASKEW, 0.6), HEAD, motors, "full", 0.05) < 1e-4


def test_full_torques_saturate(panda: Robot) -> None:
    """A servo that may add little is nearly free; the linear models report what it would need."""
    model = panda_with(panda, SPRINGS, torque_limit=[8.0, 8.0, 8.0, 8.0, 2.0, 2.0, 2.0])
    approach, motors = Approach(POSE, ASKEW, 0.6), Motors("servo", 0.03)
    assert agrees(model, approach, HEAD, motors, "full") < 1e-4
    limited = simulate_impact(model, approach, HEAD, "full", motors=motors, horizon=0.05)
    unlimited = simulate_impact(
        panda_with(panda, SPRINGS), approach, HEAD, "full", motors=motors, horizon=0.05
    )
    assert limited.peak < 0.99 * unlimited.peak
    linear = simulate_impact(model, approach, HEAD, motors=motors, horizon=0.05)
    assert linear.largest_torque is not None
    assert model.drives.torque_limits is not None
    assert np.any(linear.largest_torque > 1.5 * model.drives.torque_limits)


@pytest.mark.parametrize("motors", KINDS, ids=str)
def test_many_impacts_at_once_are_single_ones(panda: Robot, motors: Motors) -> None:
    for contact, springs in ((CHEST, SPRINGS), (FREE_HEAD, SOME_RIGID)):
        model, approach = panda_with(damped(panda), springs), Approach(POSE, ASKEW, 0.6)
        speeds = [0.1, 0.6]
        many = many_peaks(model, approach, contact, speeds, motors=motors, horizon=0.12)
        for i, speed in enumerate(speeds):
            at_speed = replace(approach, speed=speed)
            one = simulate_impact(model, at_speed, contact, motors=motors, horizon=0.12)
            assert many.peak[i] == pytest.approx(one.peak, rel=1e-3)
            assert many.first_contact[i] == pytest.approx(one.first_contact, rel=1e-3)
            if one.first_peak is not None:  # else the force rises to the end
                assert many.first_peak[i] == pytest.approx(one.first_peak, rel=1e-3)
            assert many.pressing[i] == pytest.approx(one.pressing, rel=1e-3, abs=1e-3 * one.peak)


def moved_by_mujoco(robot: Robot, approach: Approach, until: float, *, driven: bool) -> Array:
    """Let MuJoCo's position actuators follow a moving reference, or heavy rotors go on."""
    spec = mujoco.MjSpec.from_file(str(built_in_robots()["panda"]))
    spec.option.gravity = [0, 0, 0]
    gains = zip(robot.joint_names, GAINS, DAMPING_GAINS, SPRINGS, strict=True)
    for name, k_p, k_d, k_s in gains:
        joint = spec.joint(name)
        joint.actfrclimited = mujoco.mjtLimited.mjLIMITED_FALSE  # LIMIT is the servo's own
        spring = joint.parent.add_joint(name=f"{name}_spring", axis=joint.axis)
        spring.pos, spring.stiffness = joint.pos, [k_s, 0, 0]
        if driven:
            joint.armature = 1e9
            continue
        servo = spec.add_actuator(name=f"{name}_servo", target=name)
        servo.trntype = mujoco.mjtTrn.mjTRN_JOINT
        servo.set_to_position(kp=k_p, kv=k_d)
        servo.forcerange, servo.forcelimited = [-LIMIT, LIMIT], True
        servo.ctrllimited = False
    compiled = spec.compile()
    compiled.opt.disableflags |= int(mujoco.mjtDisableBit.mjDSBL_CONSTRAINT)
    n = unit_direction(approach.direction)
    rates = approach.speed * approach_velocity(impact_model(robot), approach.q, n)

    def forces(step: float) -> Array:
        data = mujoco.MjData(compiled)
        data.qpos[::2], data.qvel[::2] = approach.q, rates

        def torques(time: float) -> float:
            if not driven:  # kv acts on the whole speed, so the reference leads by q̇0 kv / kp
                data.ctrl[:] = approach.q + rates * (time + DAMPING_GAINS / GAINS)
            return 0.0

        return impact_forces(compiled, data, "hand_tcp", n, HEAD, until, step, torques)

    return extrapolated(forces)


LIMIT = 25.0
"""Of each motor's added torque [N·m]; it binds."""


@pytest.mark.parametrize("kind", ["servo", "driven"])
def test_full_agrees_with_mujoco(panda: Robot, kind: MotorKind) -> None:
    until, approach = 0.03, Approach(POSE, ASKEW, 1.2)
    given = drives(panda, SPRINGS, None, GAINS, damping_gain=DAMPING_GAINS, torque_limit=LIMIT)
    model = impact_model(panda, "hand_tcp", drives=given)
    theirs = moved_by_mujoco(panda, approach, until + 1e-4, driven=kind == "driven")
    motors = Motors(kind, np.inf)
    ours = simulate_impact(model, approach, HEAD, "full", motors=motors, horizon=until)
    seen = ours.time <= until
    expected = np.interp(ours.time[seen], STEP * np.arange(len(theirs)), theirs)
    assert abs(ours.force[seen] - expected).max() < 1e-3 * expected.max()
    if kind == "servo":  # otherwise saturation is not tested
        free = simulate_impact(model, approach, HEAD, motors=motors, horizon=until)
        assert free.largest_torque is not None
        assert free.largest_torque.max() > LIMIT
