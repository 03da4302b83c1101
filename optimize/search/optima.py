# SPDX-License-Identifier: BSD-3-Clause
"""Which of many local optima are different ones."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from .solve import Outcome

SAME_FORCE = 1e-3
"""Share of the force within which two optima can be one: searches end no nearer to them."""

SAME_POSTURE = 0.05
"""Angle [rad] of any joint within which their postures count as one."""


@dataclass(frozen=True, eq=False)
class Optimum:
    """A local optimum.

    Attributes:
        best: outcome of least force that ended there.
        starts: names of the poses from which searches ended there.
    """

    best: Outcome
    starts: tuple[str, ...]


def distinct(outcomes: Sequence[Outcome]) -> tuple[Optimum, ...]:
    """Return the local optima that are different in force or posture, the best first.

    Springs do not tell them apart: forces hardly feel some of these.
    """
    groups: list[list[Outcome]] = []
    for outcome in sorted((o for o in outcomes if o.solved), key=lambda o: o.force):
        for group in groups:
            if _same(group[0], outcome):
                group.append(outcome)
                break
        else:
            groups.append([outcome])
    return tuple(Optimum(group[0], tuple(o.name for o in group)) for group in groups)


def _same(first: Outcome, second: Outcome) -> bool:
    near = abs(second.force / first.force - 1) <= SAME_FORCE
    return near and bool(np.abs(first.q - second.q).max() <= SAME_POSTURE)
