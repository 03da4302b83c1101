# SPDX-License-Identifier: BSD-3-Clause
"""What an optimum means: which numbers matter, and what each bound costs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import partial

import numpy as np

from softimpact.symbolic.robot.rigid import Array

from .nlp import POSE, Program
from .solve import Found, Instance
from .study import Study

INDIFFERENT = 0.005
"""Share of the force that counts as no loss."""

HALVINGS = 7
"""Bisections of the logarithm of a range: its ends are then right to 5 % or better."""

WORTHLESS = 1e-3
"""Price [N] below which a bound is not named."""


@dataclass(frozen=True)
class Price:
    """What a bound costs: how much force a little more room buys.

    Attributes:
        bound: its name.
        newtons: force saved [N] by that room, to first order.
        room: in words, such as "0.1 mm more".
    """

    bound: str
    newtons: float
    room: str


def indifferent_ranges(
    study: Study,
    springs: Array,
    force: Callable[[Array], float],
    keeps: Callable[[Array], bool],
) -> Array:
    """Return the range of each joint's stiffness that costs less than 0.5 %, n×2 [N·m/rad].

    One group of joints is changed at a time, the others held; the ranges do not hold together.

    Args:
        study: whose bounds on the stiffness count, and which joints share a spring.
        springs: the optimum, length n [N·m/rad].
        force: what is minimised, of springs.
        keeps: whether springs keep all other bounds.
    """
    least = force(springs) * (1 + INDIFFERENT)
    groups, ranges = np.array(study.groups), np.empty((springs.size, 2))

    def good(group: int, value: float) -> bool:
        changed = np.where(groups == group, value, springs)
        return keeps(changed) and force(changed) <= least

    for group in range(groups.max() + 1):
        joints = groups == group
        own = float(springs[joints][0])
        for side, end in enumerate((study.lower[joints].max(), study.upper[joints].min())):
            ranges[joints, side] = _farthest(partial(good, group), own, float(end))
    return ranges


def _farthest(good: Callable[[float], bool], own: float, end: float) -> float:
    """Return how far towards an end a value may go, by bisection of its logarithm."""
    if own == end or good(end):
        return end
    near, far = np.log(own), np.log(end)
    for _ in range(HALVINGS):
        middle = (near + far) / 2
        near, far = (middle, far) if good(float(np.exp(middle))) else (near, middle)
    return float(np.exp(near))


def prices_of(
    study: Study, instance: Instance, found: Found, unit: float, program: Program
) -> tuple[Price, ...]:
    """Return what each binding bound costs, the dearest first.

    Args:
        study: whose bounds they are.
        instance: the NLP that was solved.
        found: its optimum.
        unit: force that its objective counts as one [N].
        program: its functions.
    """
    tasks = found.multipliers[: instance.shape.postures * program.rows]
    accuracy = float(tasks.reshape(-1, program.rows)[:, POSE:].sum())
    # each row is |deflection|²/bound² − 1, whose slope by the bound is −2/bound where it binds
    room = 0.1 * study.max_deflection
    prices = [
        Price("accuracy.max_deflection", 2 * accuracy * 0.1 * unit, f"{1e3 * room:g} mm more")
    ]
    for group, multiplier in enumerate(found.spring_multipliers):
        joints = [
            n for n, g in zip(study.robot.joint_names, study.groups, strict=True) if g == group
        ]
        end = "upper" if multiplier > 0 else "lower"
        gain = abs(float(multiplier)) * float(np.log10(1.1)) * unit
        room_in_words = "10 % stiffer" if multiplier > 0 else "10 % softer"
        prices.append(Price(f"stiffness.{end} of {', '.join(joints)}", gain, room_in_words))
    kept = [price for price in prices if price.newtons > WORTHLESS]
    return tuple(sorted(kept, key=lambda price: -price.newtons))
