# SPDX-License-Identifier: BSD-3-Clause
"""Inputs of impacts, many at once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import NDArray

from softimpact.symbolic.body.contact import HERTZ_STIFFNESS
from softimpact.symbolic.robot.rigid import Array

WHOLE = ("motors", "steps", "law", "frame")
"""Fields that are whole numbers."""


@dataclass(frozen=True, eq=False)
class Cases:
    """Inputs of safe speeds and what else is asked, one a row.

    Attributes:
        q: joint coordinates.
        n: direction; of ``dq``, where that is not 0.
        dq: joint velocities, or 0 where the contact point is to move along n.
        springs: of the joints [N·m/rad].
        rotors: reflected inertias [kg·m²].
        gains: of servos [N·m/rad].
        damping_gains: of servos [N·m·s/rad].
        motors: what they do, as in C.
        steps: budget.
        reaction: time after which motors are let go [s].
        horizon: until which forces count [s].
        stiffness: of the body [N/m].
        damping: of the body [N·s/m].
        mass: of the body [kg]; 0 where it is held.
        skin: Hertz's stiffness [N/m^1.5].
        law: of contact, from 1 on of ``laws``; 0 for Hertz's.
        limit: of force [N].
        pressing: limit of what presses after 0.5 s [N].
        speed: for functions that take one [m/s].
        frame: in which the contact point is given; -1 for the package's own.
        place: of the contact point in that frame [m].
    """

    q: Array
    n: Array
    dq: Array
    springs: Array
    rotors: Array
    gains: Array
    damping_gains: Array
    motors: NDArray[np.int32]
    steps: NDArray[np.int32]
    reaction: Array
    horizon: Array
    stiffness: Array
    damping: Array
    mass: Array
    skin: Array
    law: NDArray[np.int32]
    limit: Array
    pressing: Array
    speed: Array
    frame: NDArray[np.int32]
    place: Array

    def __len__(self) -> int:
        """Return the number of inputs."""
        return len(self.limit)

    def take(self, rows: Any) -> Cases:
        """Return some of them: by numbers, a mask or a slice."""
        return Cases(**{f.name: getattr(self, f.name)[rows] for f in fields(self)})

    def rounded(self) -> Cases:
        """Return them exact in float, so that both builds and the integrator read the same."""
        exact = {
            name: x.astype(np.float32).astype(float) if x.dtype == float else x
            for name, x in vars(self).items()
        }
        return Cases(**exact)

    def row(self, k: int) -> dict[str, Any]:
        """Return one input, as it is printed."""
        return {name: x[k].tolist() for name, x in vars(self).items()}


def stacked(rows: Sequence[Mapping[str, Any]]) -> Cases:
    """Return inputs from rows as they are printed; what a row leaves out is as usual."""
    columns: dict[str, list[Any]] = {f.name: [] for f in fields(Cases)}
    for row in rows:
        usual = {
            "dq": [0.0] * len(row["q"]),
            "skin": HERTZ_STIFFNESS,
            "steps": 8000,
            "law": 0,
            "pressing": row["limit"],
            "speed": 0.5,
            "frame": -1,
            "place": [0.0] * 3,
        }
        for name, column in columns.items():
            column.append(row.get(name, usual.get(name)))
    return Cases(**{k: np.array(v, np.int32 if k in WHOLE else float) for k, v in columns.items()})
