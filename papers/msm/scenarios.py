# SPDX-License-Identifier: BSD-3-Clause
"""The six impacts of MSM §3.2.2 and §3.3.2."""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from softimpact.simulate import Approach, Controller, ControllerReference
from softimpact.symbolic import (
    ImpactModel,
    Robot,
    approach_velocity,
    configuration_at_rest,
    drives,
    impact_model,
    load_robot,
)
from softimpact.symbolic.robot.rigid import Array

GRID = 12
"""Stiffnesses of a sweep: 4056 and 351 N·m/rad are the 6th and the 4th of twelve on a logarithmic
scale over the robots' ranges, which tells how the paper chose them."""


@dataclass(frozen=True)
class PaperRobot:
    """A robot of MSM with its controller and the joint stiffnesses looked at.

    Attributes:
        robot: name of the built-in robot.
        proportional: k_p [rad/s²].
        derivative: k_d [rad/s].
        integral: k_i [rad/s³].
        softest: least k_s [N·m/rad].
        stiffest: largest k_s [N·m/rad].
        gravity: [m/s²].
    """

    robot: str
    proportional: float
    derivative: float
    integral: float
    softest: float
    stiffest: float
    gravity: tuple[float, float, float]

    def controller(self, reference: ControllerReference) -> Controller:
        """Return the robot's controller."""
        return Controller(self.proportional, self.derivative, self.integral, reference)

    def stiffnesses(self, between: int = 0) -> Array:
        """Return the grid of k_s, with as many more points between any two of it."""
        return np.geomspace(self.softest, self.stiffest, (GRID - 1) * (between + 1) + 1)


@dataclass(frozen=True)
class PaperScenario:
    """A robot in a configuration, and how it moves.

    Attributes:
        name: a to f.
        title: for people.
        arm: the robot.
        tip: contact point.
        motor_angles: of the motors [rad]; springs follow from statics.
        motor_rates: ratio of the motors' speeds; None where the direction is given.
        direction: in which the contact point moves; None where it follows from the rates.
    """

    name: str
    title: str
    arm: PaperRobot
    tip: str
    motor_angles: tuple[float, float]
    motor_rates: tuple[float, float] | None = None
    direction: tuple[float, float, float] | None = None

    def at(self, stiffness: float, speed: float = 1.0) -> tuple[ImpactModel, Approach]:
        """Return the robot with all joint springs of a stiffness [N·m/rad], and its approach."""
        model, approach = _at_rest(self, stiffness)
        return model, replace(approach, speed=speed)

    def motion(self, model: ImpactModel, q: Array) -> tuple[Array, Array]:
        """Return the direction in which the contact point moves, and q̇ per 1 m/s."""
        if self.direction is not None:
            n = np.array(self.direction)
            return n, approach_velocity(model, q, n)
        rates = np.zeros(len(model.independent))
        rates[list(model.actuated)] = self.motor_rates
        moved = np.array(model.jacobian(q)) @ rates
        speed = np.linalg.norm(moved)
        return moved / speed, rates / speed


@lru_cache(maxsize=64)
def _at_rest(scenario: PaperScenario, stiffness: float) -> tuple[ImpactModel, Approach]:
    arm = scenario.arm
    robot = _with_springs(arm.robot, stiffness)
    gains = drives(robot, computed_torque_gain=arm.proportional)
    model = impact_model(robot, scenario.tip, drives=gains, gravity=arm.gravity)
    q = configuration_at_rest(model, scenario.motor_angles)
    n, rates = scenario.motion(model, q)
    return model, Approach(q, n, 1.0, rates)


@lru_cache(maxsize=64)
def _with_springs(name: str, stiffness: float) -> Robot:
    robot = load_robot(name)
    joints = [replace(j, stiffness=stiffness if j.stiffness else 0.0) for j in robot.joints]
    return replace(robot, joints=tuple(joints))


RR = PaperRobot("rr", 6050.0, 121.0, 1.25e5, 5e2, 5e4, (0.0, 0.0, 0.0))
R_MIN = PaperRobot("rmin", 1076.0, 51.0, 9.26e3, 1e2, 1e4, (0.0, 0.0, -9.81))
FOLDED = np.pi / 3
AT_IMPACT = (float(np.radians(-130.6)), float(np.radians(-50.0)))

SCENARIOS = {
    scenario.name: scenario
    for scenario in (
        PaperScenario("a", "RR straight, end effector", RR, "P", (0.0, 0.0), (1.0, 0.0)),
        PaperScenario("b", "RR straight, elbow", RR, "O3", (0.0, 0.0), (1.0, 0.0)),
        PaperScenario("c", "RR folded, end effector", RR, "P", (0.0, FOLDED), (1.0, 0.0)),
        PaperScenario("d", "RR folded, elbow", RR, "O3", (0.0, FOLDED), (-1.0, 0.0)),
        PaperScenario("e", "R-Min, end effector", R_MIN, "P", AT_IMPACT, None, (-1.0, 0.0, 0.0)),
        PaperScenario("f", "R-Min, elbow", R_MIN, "O13", AT_IMPACT, None, (-1.0, 0.0, 0.0)),
    )
}
