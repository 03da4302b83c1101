# SPDX-License-Identifier: BSD-3-Clause
"""What tells configurations apart at which a function has no answer."""

from __future__ import annotations

import casadi as ca
import numpy as np

from softimpact.symbolic import ImpactModel, Matrix, Robot, loop_gaps

from ..inputs.directions import some_configurations
from .description import Guard

IMMOVABLE = 1e3
"""A contact point counts as unable to move where it feels this many times the robot's mass."""

LOOP_OPEN = 1e-3
"""Gap of a loop, over the size of the robot, from which on a configuration is refused."""

FASTEST_APPROACH = 100.0
"""Joint velocity for 1 m/s, times the largest entry of J, from which on an approach is singular."""


def loops_closed(robot: Robot, q: Matrix) -> tuple[Guard, ...]:
    """Guard the loops of a closed chain; an open chain has none."""
    if not robot.loops:
        return ()
    gap = loop_gaps(robot, q)
    lengths = [float(np.linalg.norm(joint.placement.translation)) for joint in robot.joints]
    widest = float(f"{(LOOP_OPEN * sum(lengths)) ** 2:.2g}")
    return (Guard(widest - ca.dot(gap, gap), 0.0, status="LOOP_OPEN"),)


def heaviest(robot: Robot) -> float:
    """Return the mass [kg] that a contact point feels at most before a pose counts as singular."""
    moved = sum(joint.inertia.mass for joint in robot.joints)
    return float(f"{IMMOVABLE * moved:.2g}")


def movable(robot: Robot, mass: Matrix) -> Guard:
    """Guard a mass [kg] that is felt at the contact point: finite, and not of a singular pose."""
    return Guard(mass, 0.0, heaviest(robot))


def movable_in_space(robot: Robot, inertia: Matrix) -> Guard:
    """Guard an operational space inertia [kg], 3×3."""
    return movable(robot, ca.trace(inertia))


def fastest_arrival(model: ImpactModel) -> float:
    """Return the squared joint velocity [rad²/s²] from which on an arrival at 1 m/s is singular."""
    seen = some_configurations(model.robot, seed=3)
    arm = max(float(abs(np.array(model.jacobian(ca.DM(q)))).max()) for q in seen)
    return float(f"{(FASTEST_APPROACH / arm) ** 2:.2g}")
