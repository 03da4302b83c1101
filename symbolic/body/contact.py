# SPDX-License-Identifier: BSD-3-Clause
"""The contact between robot and body: what the robot wears, skin, and the region behind it."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property

from ..errors import InvalidValue
from ..matrices import Matrix
from .laws import HERTZ_EXPONENT, Law, PowerLaw, in_series
from .regions import BodyRegion

HERTZ_STIFFNESS = 1.9e7
"""k_f of the skin [N/m^1.5], measured on 7 mm foam of 70 ShA (MSM §3.1.2)."""


@dataclass(frozen=True)
class Contact:
    """What the robot's contact point hits.

    Attributes:
        region: the region of the body.
        clamped: True if it is held against something rigid, False if it can give way with its
            effective mass.
        hertz_stiffness: k_f of the skin [N/m^1.5], unless the region has a skin of its own.
        cover: law of what the robot wears at its contact point, if anything.
    """

    region: BodyRegion
    clamped: bool = True
    hertz_stiffness: float = HERTZ_STIFFNESS
    cover: Law | None = None

    @property
    def skin(self) -> Law:
        """Law of the body's surface: the region's own, or Hertz's."""
        return self.region.skin or PowerLaw(self.hertz_stiffness)

    @cached_property
    def law(self) -> Law:
        """All that the robot presses on before it moves the region: cover and skin in series."""
        return self.skin if self.cover is None else in_series(self.cover, self.skin)

    @property
    def series_stiffness(self) -> float:
        """k_f [N/m^1.5] of the whole, for consumers that know Hertz's law only.

        Raises:
            InvalidValue: the law is another one, or the body has a plate.
        """
        law = self.law
        if self.region.plate_mass:
            raise InvalidValue("plate_mass", "must be 0 here: only simulations take a plate")
        if isinstance(law, PowerLaw) and law.exponent == HERTZ_EXPONENT:
            return law.stiffness
        raise InvalidValue(
            "contact", "must follow Hertz's law here, skin and cover: only simulations take others"
        )

    def check(self) -> None:
        """Raise InvalidValue if a number of the body cannot be."""
        region = self.region
        positive = {
            "hertz_stiffness": self.hertz_stiffness,
            "region.stiffness": region.stiffness,
            "region.effective_mass": region.effective_mass,
        }
        for field, value in positive.items():
            if not 0 < value < math.inf:
                raise InvalidValue(field, f"must be finite and greater than 0, not {value}")
        for field, value in {
            "region.damping": region.damping,
            "region.plate_mass": region.plate_mass,
        }.items():
            if not 0 <= value < math.inf:
                raise InvalidValue(field, f"must be finite and ≥ 0, not {value}")
        for name, law in {"cover": self.cover, "skin": region.skin}.items():
            if law is not None:
                with naming(name):
                    law.check()

    def force(self, depth: Matrix) -> Matrix:
        """Return f_c [N] for a penetration δ [m] of cover and skin together."""
        return self.law.force(depth)


@contextmanager
def naming(part: str) -> Iterator[None]:
    """Let errors say which part of a body a field belongs to."""
    try:
        yield
    except InvalidValue as error:
        raise InvalidValue(f"{part}.{error.field}", error.reason) from None
