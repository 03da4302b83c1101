# SPDX-License-Identifier: BSD-3-Clause
"""Safe speeds that are none: what a search looks at, and what it found."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from compiled_impacts import BOUNDED, OK
from numpy.typing import NDArray

from softimpact.symbolic.robot.rigid import Array

from .cases import Cases
from .draw import Draw
from .forces import both_forces
from .impacts import Robot
from .questions import QUESTIONS, Question

TURNS = 40
"""Of a climb."""

NEAR = 0.997
"""Share of a limit from which on a force is integrated in finer steps."""

FINER = 5.0
"""By what those are shorter."""

KEPT = 5
"""How many of the worst inputs are written down."""


@dataclass(frozen=True)
class Found:
    """What a search found.

    Attributes:
        inputs: that were looked at.
        answered: of these, how many had a safe speed.
        bounded: of these, how many one from a bound.
        integrated: impacts integrated.
        above: inputs with a force above its limit at the safe speed or below it.
        lost: inputs answered though motors cannot move the contact point along n at all.
        worst: largest force over its limit.
        below: the same at speeds below the safe one.
        slower: largest force at a speed below the safe one, over that at the safe one.
        hardest: inputs with the largest forces over their limits, and these.
    """

    inputs: int = 0
    answered: int = 0
    bounded: int = 0
    integrated: int = 0
    above: int = 0
    lost: int = 0
    worst: float = 0.0
    below: float = 0.0
    slower: float = 0.0
    hardest: Sequence[Mapping[str, Any]] = ()

    def joined(self, other: Found) -> Found:
        """Return both together."""
        sums = ("inputs", "answered", "bounded", "integrated", "above", "lost")
        most = ("worst", "below", "slower")
        mine, theirs = vars(self), vars(other)
        hardest = sorted([*self.hardest, *other.hardest], key=lambda row: -row["share"])
        return Found(
            **{name: mine[name] + theirs[name] for name in sums},
            **{name: max(mine[name], theirs[name]) for name in most},
            hardest=hardest[:KEPT],
        )


class Search:
    """Looks at inputs, many at a time."""

    def __init__(self, robot: Robot, real: str, draw: Draw) -> None:
        self.robot, self.real, self.draw = robot, real, draw
        self.found = Found()

    def tried(self, count: int) -> Array:
        """Return the speeds that are tried over the safe one: it, and slower ones."""
        slower, random = self.draw.question.slower, self.draw.random
        near = (2 * slower + 1) // 3
        parts = [np.ones((count, 1)), random.uniform(0.5, 1, (count, near))]
        return np.hstack([*parts, 10 ** random.uniform(-2, -0.3, (count, slower - near))])

    def shares(self, cases: Cases) -> Array:
        """Return the largest force over its limit up to the safe speed of each input.

        Where that is looked for, only of speeds below it.
        """
        question = self.draw.question
        told = self.robot.answers(question, cases, self.real)
        answered = np.flatnonzero((told.status == OK) | (told.status == BOUNDED))
        out = np.zeros(len(cases))
        if len(answered) == 0:
            self.found = self.found.joined(Found(inputs=len(cases)))
            return out
        asked, limits = cases.take(answered), told.limit[answered]
        speeds, status = told.speed[answered], told.status[answered]
        over, forces = self.over(asked, speeds, limits)
        lost = np.isinf(over[:, 0])
        over[lost] = forces[lost] = 0.0
        worst, slower = over.max(axis=1), over[:, 1:].max(axis=1, initial=0.0)
        out[answered] = slower if question.climbs else worst
        hardest = [
            {"share": float(worst[k]), "status": int(status[k]), "answer": float(speeds[k]),
             "at": float(self.at[k]), **asked.row(k)}
            for k in np.argsort(-worst)[:KEPT]
        ]  # fmt: skip
        ratio = forces[:, 1:].max(axis=1, initial=0.0) / np.maximum(forces[:, 0], 1e-3 * limits)
        self.found = self.found.joined(
            Found(
                inputs=len(cases),
                answered=len(answered),
                bounded=int((status == BOUNDED).sum()),
                integrated=over.size,
                above=int((worst > 1).sum()),
                lost=int(lost.sum()),
                worst=float(worst.max()),
                below=float(slower.max()),
                slower=float(ratio.max()),
                hardest=hardest,
            )
        )
        return out

    def over(self, asked: Cases, speeds: Array, limits: Array) -> tuple[Array, Array]:
        """Return forces at a speed and below it, over their limits, and these forces."""
        presses = self.draw.question.presses
        shares = self.tried(len(asked))
        tried = speeds[:, None] * shares
        forces, late = both_forces(self.robot, asked, tried, late=presses)
        held = asked.pressing[:, None]

        def most() -> Array:
            return np.maximum(forces / limits[:, None], late / held if presses else 0.0)

        near = most().max(axis=1) > NEAR
        if near.any():
            forces[near], late[near] = both_forces(
                self.robot, asked.take(near), tried[near], FINER, late=presses
            )
        found = most()
        self.at = shares[np.arange(len(asked)), found.argmax(axis=1)]
        return found, forces

    def climb(self, cases: Cases, best: Array) -> None:
        """Climb from each input, by whatever brings its force nearer to its limit."""
        for _ in range(TURNS):
            others = self.draw.changed(cases)
            found = self.shares(others)
            better = found > best
            best = np.where(better, found, best)
            cases = pick(better, others, cases)


def pick(which: NDArray[np.bool_], those: Cases, others: Cases) -> Cases:
    """Return rows of one where a mask says so, else of the other."""
    return replace(
        others,
        **{
            name: np.where(which.reshape(-1, *[1] * (x.ndim - 1)), x, getattr(others, name))
            for name, x in vars(those).items()
        },
    )


def look(
    robot: Robot,
    real: str,
    seed: int,
    count: int,
    climbs: int,
    *,
    wide: bool,
    question: Question = QUESTIONS["limit"],
) -> Found:
    """Look at some random inputs and climb from the worst of them."""
    random = np.random.default_rng([seed, int(wide), int(real == "float")])
    search = Search(robot, real, Draw(robot, random, wide=wide, question=question))
    cases = search.draw.cases(count)
    shares = search.shares(cases)
    first = np.argsort(-shares)[:climbs]
    search.climb(cases.take(first), shares[first])
    return search.found
