# SPDX-License-Identifier: BSD-3-Clause
"""Laws of contact that are not Hertz's: as packages take them, and what these are held against."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import casadi as ca
import numpy as np

from softimpact.codegen.inputs.law_points import law_points
from softimpact.symbolic import Curve, InvalidValue, Law, PowerLaw, in_series
from softimpact.symbolic.body.contact import HERTZ_STIFFNESS
from softimpact.symbolic.body.pads import PADS
from softimpact.symbolic.robot.rigid import Array

FORCES = np.geomspace(1e-3, 1e5, 3000)
"""At which laws are asked for their depth [N]; straight between, before and behind."""

RANDOM = 12
"""Laws of random points."""


@dataclass(frozen=True, eq=False)
class Tabled:
    """Skin, pads and covers in series.

    Attributes:
        points: as a package takes it, a row each: depth, force and the same of its knee.
        depths: of the law itself [m].
        forces: at these [N].
    """

    points: Array
    depths: Array
    forces: Array

    def stiffness(self, force: float) -> float:
        """Return the largest slope up to a force [N/m]."""
        last = int(np.searchsorted(self.forces, force)) + 1
        return float((np.diff(self.forces[:last]) / np.diff(self.depths[:last])).max())


def depths_at(law: Law, forces: Array) -> Array:
    """Return the depths of forces [m], from what the law says of forces at depths."""
    own = law.depths if isinstance(law, Curve) else ()
    depths = np.unique([0.0, *own, *np.geomspace(1e-9, 10.0, 22_000)])
    known = np.array(law.force(ca.DM(depths))).ravel()
    return np.asarray(np.interp(forces, known, depths))


def made(parts: list[Law]) -> Tabled:
    """Return laws in series."""
    corners = [force for law in parts if isinstance(law, Curve) for force in law.forces]
    forces = np.unique([0.0, *FORCES, *corners])
    depths = sum((depths_at(law, forces) for law in parts), np.zeros(len(forces)))
    rises = np.concatenate([[True], np.diff(depths) > 1e-15])
    return Tabled(law_points(in_series(*parts)), depths[rises], forces[rises])


def drawn(random: np.random.Generator) -> Curve:
    """Return a cover of random points: it may stiffen, soften, and end as if it were solid."""
    count = int(random.integers(2, 8))
    steps = 10 ** random.uniform([-4, 0], [-2.3, 2.3], (count, 2))
    depths, forces = np.cumsum(steps, axis=0).T
    return Curve([0.0, *depths], [0.0, *forces])


@cache
def laws() -> tuple[Tabled, ...]:
    """Return all that the search has."""
    skin, foam = PowerLaw(HERTZ_STIFFNESS), PADS["sh10"].law
    random = np.random.default_rng(12)
    tried: list[list[Law]] = [
        [PowerLaw(5e4, 1.0)], [PowerLaw(3e8, 2.0)], [PowerLaw(5e6, 1.1)], [PowerLaw(1e6, 1.3)],
        [foam], [foam, skin], [PowerLaw(2e4, 1.0), skin], [foam, PowerLaw(2e4, 1.0), skin],
        *([drawn(random), skin] for _ in range(RANDOM)), [drawn(random)],
    ]  # fmt: skip
    found = []
    for parts in tried:
        try:
            found.append(made(parts))
        except InvalidValue:  # too many corners for C, which is told so
            continue
    return tuple(found)
