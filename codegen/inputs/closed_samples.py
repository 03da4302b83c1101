# SPDX-License-Identifier: BSD-3-Clause
"""Random configurations of closed chains, the same on every machine."""

from __future__ import annotations

import math
import random

import casadi as ca
import numpy as np

from softimpact.symbolic import Robot, closed_chain, loop_gaps, loop_jacobian
from softimpact.symbolic.robot.rigid import Array

FARTHEST_FROM_HOME = 0.5
"""How far independent joints are sampled from home [rad, m]."""

EXACT_STEPS = 2.0**20
"""Coordinates are multiples of 1/EXACT_STEPS, which ``float`` holds exactly up to 16 rad or m."""

SAMPLED_STEPS = 1024
"""Independent coordinates are sampled in steps of 1/SAMPLED_STEPS."""

NEWTON_STEPS = 15
"""Steps that close the loops of all samples at once."""

LARGEST_GAP = 1e-9
"""Gap [m] above which a sample is dropped."""

NEAREST_DEAD_POINT = 0.1
"""Samples nearer to a dead point than this share of home's distance are dropped."""


def closed_configurations(robot: Robot, source: random.Random, count: int) -> list[Array]:
    """Return random configurations near home at which the loops are closed."""
    found: list[Array] = []
    while len(found) < count:
        found += _attempt(robot, source, count)
    return [np.asarray(np.round(q * EXACT_STEPS) / EXACT_STEPS) for q in found[:count]]


def _attempt(robot: Robot, source: random.Random, count: int) -> list[Array]:
    chain = closed_chain(robot)
    lower, upper = robot.limits
    q = np.tile(chain.home[:, None], count)
    for i in chain.independent:
        low = math.ceil(max(lower[i], chain.home[i] - FARTHEST_FROM_HOME) * SAMPLED_STEPS)
        high = math.floor(min(upper[i], chain.home[i] + FARTHEST_FROM_HOME) * SAMPLED_STEPS)
        q[i] = [
            (low + int(source.random() * (high - low + 1))) / SAMPLED_STEPS for _ in range(count)
        ]
    symbol, bound = ca.SX.sym("q", robot.n), list(chain.dependent)
    gap, jacobian = loop_gaps(robot, symbol), loop_jacobian(robot, symbol)[:, bound]
    step = ca.Function("step", [symbol], [ca.solve(jacobian, gap)])
    look = ca.Function("look", [symbol], [ca.norm_inf(gap), ca.det(jacobian)])
    for _ in range(NEWTON_STEPS):
        q[bound] -= np.clip(
            np.nan_to_num(np.array(step(q))), -FARTHEST_FROM_HOME, FARTHEST_FROM_HOME
        )
    widths, sides = (np.array(values).ravel() for values in look(q))
    side = float(look(chain.home)[1])
    good = (widths < LARGEST_GAP) & (sides / side > NEAREST_DEAD_POINT)
    good &= abs(q - chain.home[:, None]).max(axis=0) < math.pi
    return [q[:, k] for k in np.flatnonzero(good)]
