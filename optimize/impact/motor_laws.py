# SPDX-License-Identifier: BSD-3-Clause
"""What the motors do over the time steps of an impact, as numbers that an expression takes."""

from __future__ import annotations

from math import inf
from typing import NamedTuple

import casadi as ca

from softimpact.symbolic import Matrix, Motors

LAW = 3
"""Numbers that say what the motors do from one node to the next."""

NEVER = 1e6
"""A time [s] beyond any impact, in place of infinity."""


class MotorLaws(NamedTuple):
    """When motors follow a servo, and when their motion is given, whatever the torque [s].

    Attributes:
        servo_until: end of the servo.
        given_from, given_until: while the motion is given.
        full_until: when the given speed begins to fall.
        stopping_time: in which it falls to zero.
    """

    servo_until: Matrix
    given_from: Matrix
    given_until: Matrix
    full_until: Matrix
    stopping_time: Matrix

    @staticmethod
    def of(motors: Motors) -> MotorLaws:
        """Return the times of motors that are not held."""
        reaction = NEVER if motors.reaction_time == inf else motors.reaction_time
        stops = motors.reaction == "stop" and reaction < NEVER
        servo = reaction if motors.kind == "servo" else 0.0
        begin = 0.0 if motors.kind == "driven" else reaction if stops else NEVER
        until = NEVER if stops else reaction if motors.kind == "driven" else begin
        return MotorLaws(servo, begin, until, reaction, motors.stopping_time)

    def at_nodes(self, step: Matrix, substeps: int, nodes: int) -> Matrix:
        """Return what the motors do from each node to the next, 3×nodes.

        The leapfrog's velocities are half a step ahead of its angles, so that the torques which
        change them in an interval act from half a step after its begin to half a step after its
        end.

        The rows are the share of the interval in which torques move the motors, the given speed
        over that at first touch, and the share in which the servo acts.
        """
        begin = step * (substeps * ca.DM(range(nodes)).T + 0.5)
        end = begin + step * substeps
        given = _overlap(begin, end, self.given_from, self.given_until)
        falling = ((begin + end + step) / 2 - self.full_until) / self.stopping_time
        speed = ca.fmin(ca.fmax(1 - falling, 0), 1)
        return ca.vertcat(1 - given, speed, _overlap(begin, end, 0, self.servo_until))


def _overlap(begin: Matrix, end: Matrix, first: Matrix, last: Matrix) -> Matrix:
    """Share of each interval that lies between two times."""
    return ca.fmax(ca.fmin(end, last) - ca.fmax(begin, first), 0) / (end - begin)
