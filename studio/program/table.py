# SPDX-License-Identifier: BSD-3-Clause
"""What binds at each sample of a program, as columns: some 100 bytes a sample, whoever found it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from softimpact.simulate.program import Danger, worst_of
from softimpact.simulate.trajectory import time_at_speeds
from softimpact.symbolic.robot.rigid import Array

LIMITS = tuple(
    f"{phase} {quantity}"
    for phase in ("transient", "quasi-static")
    for quantity in ("force", "pressure", "energy")
)
"""Names of limits, by their code."""

NOTHING = -1
"""Code where nothing moves, or what binds is not known."""


@dataclass(frozen=True, eq=False)
class Names:
    """What the codes of columns stand for.

    Attributes:
        points: frames.
        regions: of bodies, one for each body.
        motors: kinds.
    """

    points: tuple[str, ...]
    regions: tuple[str, ...]
    motors: tuple[str, ...]


@dataclass(frozen=True, eq=False)
class ProgramTable:
    """A program slowed down to keep all limits; a row a sample.

    Attributes:
        names: of what is coded.
        time: of the sample [s].
        factor: on the speed there, in (0, 1].
        two_body: factor by the standard's formula, also above one; infinite where nothing moves.
        point: code of the point that is worst there, as the next three.
        body: that it meets.
        limit: that is reached first.
        motors: what they do.
        speed: of the point [m/s].
        safe_speed: that it may have [m/s]; infinite where that is more than it has.
        peak: force at the program's speed [N]; NaN where only the factor was sought.
        share: of the limits that this uses; NaN likewise, −inf where nothing moves.
        direction: in which the point moves, N×3.
    """

    names: Names
    time: Array
    factor: Array
    two_body: Array
    point: NDArray[np.int16]
    body: NDArray[np.int16]
    limit: NDArray[np.int8]
    motors: NDArray[np.int8]
    speed: Array
    safe_speed: Array
    peak: Array
    share: Array
    direction: NDArray[np.float32]

    @staticmethod
    def empty(names: Names, time: Array) -> ProgramTable:
        """Return the table of a program in which nothing moves."""
        count = len(time)
        return ProgramTable(
            names=names,
            time=time,
            factor=np.ones(count),
            two_body=np.full(count, np.inf),
            point=np.full(count, NOTHING, np.int16),
            body=np.full(count, NOTHING, np.int16),
            limit=np.full(count, NOTHING, np.int8),
            motors=np.full(count, NOTHING, np.int8),
            speed=np.zeros(count),
            safe_speed=np.zeros(count),
            peak=np.zeros(count),
            share=np.full(count, -np.inf),
            direction=np.zeros((count, 3), np.float32),
        )

    def __len__(self) -> int:
        return len(self.time)

    @property
    def iso_factor(self) -> Array:
        """Factor by the standard's formula, in (0, 1]."""
        return np.minimum(self.two_body, 1.0)

    @property
    def time_before(self) -> float:
        """That the program takes [s]."""
        return float(self.time[-1] - self.time[0])

    @property
    def time_after(self) -> float:
        """That it takes when slowed down [s]."""
        return time_at_speeds(self.time, self.factor)

    @property
    def time_by_formula(self) -> float:
        """That it takes when slowed down by the standard's formula [s]."""
        return time_at_speeds(self.time, self.iso_factor)

    def worst(self, count: int = 5) -> list[int]:
        """Return the worst samples, some way apart in time while there are others.

        Where nobody knows how much of the limits is used, the standard's formula says which to
        look at.
        """
        share = np.where(np.isnan(self.share), 1 / self.two_body, self.share)
        return worst_of(self.time, self.factor, share, count)

    def put(self, dangers: Sequence[Danger], first: int) -> None:
        """Note what is worse than what is there.

        Args:
            dangers: at samples of the program.
            first: number of the table's first sample.
        """
        for danger in dangers:
            k, factor = danger.sample - first, danger.factor
            np.minimum.at(self.two_body, k, danger.two_body / danger.speed)
            worse = (factor < self.factor[k]) | (
                (factor == self.factor[k]) & (danger.share > self.share[k])
            )
            rows = np.flatnonzero(worse)
            # of two passes of a sample, the worse one last
            rows = rows[np.lexsort((danger.share[rows], -factor[rows]))]
            at = k[rows]
            self.factor[at], self.share[at] = factor[rows], danger.share[rows]
            self.point[at] = self.names.points.index(danger.point)
            self.body[at] = danger.number
            self.limit[at] = [LIMITS.index(name) for name in danger.limit[rows]]
            self.motors[at] = [self.names.motors.index(name) for name in danger.motors[rows]]
            self.speed[at], self.safe_speed[at] = danger.speed[rows], danger.safe_speed[rows]
            self.peak[at], self.direction[at] = danger.peak[rows], danger.direction[rows]

    def forget(self, rows: NDArray[np.intp]) -> None:
        """Take back what was noted at some rows."""
        blank = ProgramTable.empty(self.names, self.time[rows])
        for name, values in vars(blank).items():
            if name not in ("names", "time"):
                getattr(self, name)[rows] = values

    def lower(self, share: float) -> None:
        """Slow down to a share of what is safe, also where the limits' use is not known."""
        used = np.where(np.isfinite(self.share), self.share, np.inf)
        moves = self.two_body < np.inf
        rows = moves & ((self.factor < 1) | (used > share))
        self.factor[rows] *= share
        self.safe_speed[rows] = self.factor[rows] * self.speed[rows]

    def moment(self, row: int) -> dict[str, Any] | None:
        """Return what is worst at a sample, None where nothing moves."""
        if self.point[row] == NOTHING:
            return None
        known = self.safe_speed[row] < np.inf
        return {
            "sample": row,
            "t": self.time[row],
            "factor": self.factor[row],
            "point": self.names.points[self.point[row]],
            "region": self.names.regions[self.body[row]],
            "limit": LIMITS[self.limit[row]],
            "motors": self.names.motors[self.motors[row]],
            "speed": self.speed[row],
            "direction": self.direction[row],
            "safe_speed": self.safe_speed[row] if known else None,
            "peak": self.peak[row],
            "share_of_limit": self.share[row],
        }
