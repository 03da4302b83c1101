# SPDX-License-Identifier: BSD-3-Clause
"""Whether free and driven motors bound every servo between them: searched for, and not always.

With the release 20 ms after first touch no servo was found beyond the bracket by more than 0.1 %.
With 50 ms there are some, all with gains of several decades on soft and stiff springs mixed: the
worst that hill climbing found lies 31 % above the worse end.
"""

from __future__ import annotations

import numpy as np
import pytest

from softimpact.simulate import Approach
from softimpact.simulate.many import many_peaks
from softimpact.symbolic import (
    Contact,
    ImpactModel,
    Motors,
    approach_velocity,
    body_region,
    drives,
    impact_model,
    load_robot,
)
from softimpact.symbolic.impact.motors import MotorKind
from softimpact.symbolic.robot.rigid import Array

PANDA = load_robot("panda")
CONTACTS = [Contact(body_region(name), clamped=False) for name in ("head", "chest")]
KINDS: tuple[MotorKind, ...] = ("free", "driven", "servo")


def peaks(
    model: ImpactModel, approach: Approach, contact: Contact, reaction_time: float
) -> dict[MotorKind, float]:
    """Return the peak under free, driven and servo motors [N]."""
    return {
        kind: float(
            many_peaks(
                model,
                approach,
                contact,
                [approach.speed],
                motors=Motors(kind, reaction_time),
                horizon=0.3,
            ).peak[0]
        )
        for kind in KINDS
    }


def beyond(found: dict[MotorKind, float]) -> float:
    """Return by which share a servo's peak is above the bracket's worse end."""
    return found["servo"] / max(found["free"], found["driven"]) - 1


class Search:
    """Hill climbing over pose, direction, springs, gains, damping and joint velocities."""

    def __init__(self, seed: int, reaction_time: float) -> None:
        self.random, self.reaction_time = np.random.default_rng(seed), reaction_time

    def value(self, x: Array, contact: Contact) -> float:
        lower, upper = PANDA.limits
        q = lower + (upper - lower) / (1 + np.exp(-x[:7]))
        n = x[7:10] / np.linalg.norm(x[7:10])
        springs = 10 ** np.clip(4 + x[10:17], 2.5, 5)
        gains = 10 ** np.clip(4 + 1.5 * x[17:24], 1, 7)
        damping = min(abs(x[24]), 2) * np.sqrt(gains * PANDA.armature)
        given = drives(PANDA, springs, position_gain=gains, damping_gain=damping)
        model = impact_model(PANDA, drives=given)
        J = np.array(model.jacobian(q))
        if np.linalg.cond(J) > 30:
            return -1.0
        least = approach_velocity(model, q, n)
        idle = (np.eye(7) - np.linalg.pinv(J) @ J) @ x[25:32]
        velocity = least + idle * np.linalg.norm(least) / 6
        approach = Approach(q, n, 0.5, velocity / (n @ J @ velocity))
        return beyond(peaks(model, approach, contact, self.reaction_time))

    def climb(self, steps: int) -> float:
        """Return the largest share found."""
        contact = CONTACTS[self.random.integers(2)]
        starts = [self.random.normal(size=32) for _ in range(4)]
        values = [self.value(x, contact) for x in starts]
        best, x, stride = max(values), starts[int(np.argmax(values))], 0.4
        for _ in range(steps):
            moved = x + stride * self.random.normal(size=32) * (self.random.random(32) < 0.4)
            value = self.value(moved, contact)
            if value > best:
                best, x = value, moved
            else:
                stride = max(0.05, 0.97 * stride)
        return best


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2))
def test_no_servo_is_found_beyond_the_bracket_at_the_default_reaction_time(seed: int) -> None:
    assert Search(seed, 0.02).climb(30) < 5e-3


WORST_FOUND = 0.3135
"""The largest share of one hill climb of three minutes at a reaction time of 50 ms."""

WORST = np.array(
    [
        0.3845,
        -0.1722,
        -0.5482,
        -0.5646,
        1.0506,
        -1.4033,
        -0.4446,
        0.3869,
        2.0543,
        -0.3564,
        -1.3231,
        -0.005,
        0.5278,
        -0.6229,
        1.2465,
        -1.8656,
        1.0532,
        -0.1372,
        -1.7787,
        -0.3714,
        1.6538,
        0.3666,
        1.1422,
        2.377,
        0.2466,
        -0.4778,
        -0.842,
        0.6763,
        -0.3827,
        0.8454,
        -1.0121,
        0.5323,
    ]
)
"""Where: 0.5 m/s on a free chest, k_s from 316 to 1e5, K_p from 21 to 1e7 N·m/rad."""


def test_a_servo_can_be_beyond_the_bracket_where_robots_react_late() -> None:
    """Weak gains beside strong ones let some motors fall behind and others hit harder for it."""
    found = Search(0, 0.05).value(WORST, CONTACTS[1])
    assert found == pytest.approx(WORST_FOUND, abs=2e-3)
    assert Search(0, 0.02).value(WORST, CONTACTS[1]) < 5e-3
