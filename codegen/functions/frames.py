# SPDX-License-Identifier: BSD-3-Clause
"""Where joints are: what the Jacobian of a point anywhere on the robot is made of."""

from __future__ import annotations

import casadi as ca

from softimpact.symbolic.dynamics.kinematics import motions, poses

from .description import CFunction, Output
from .symbols import Symbols, function_over


def frames_of(s: Symbols) -> CFunction:
    """Return the pose of each joint's frame, whose z axis is the joint's."""
    robot = s.robot
    known = poses(robot, motions(robot, s.q))
    rows = [
        ca.horzcat(*[known[i].rotation[k, :] for k in range(3)], known[i].position.T)
        for i in range(robot.n)
    ]
    output = Output(
        "poses", ca.densify(ca.vertcat(*rows)), "1, m", "of each: rotation row by row, then origin"
    )
    return function_over(s, "joint_frames", "Where the joints' frames are.", (output,))
