# SPDX-License-Identifier: BSD-3-Clause
"""Pads that stand for the skin; numbers and sources in ``data/pads.csv``."""

from __future__ import annotations

from dataclasses import dataclass

from .laws import PowerLaw
from .tables import table_rows


@dataclass(frozen=True)
class Pad:
    """A rubber layer on something solid.

    Attributes:
        name: of the pad.
        hardness: Shore A, at the hard end of its tolerance.
        thickness: in m.
        law: of contact under a blunt robot.
    """

    name: str
    hardness: float
    thickness: float
    law: PowerLaw

    @property
    def modulus(self) -> float:
        """Young's modulus E [Pa] of rubber of this hardness."""
        return young_modulus(self.hardness)


def young_modulus(hardness: float) -> float:
    """Return E [Pa] of rubber by its hardness [Shore A] (Gent, Rubber Chem. Technol. 31, 1958)."""
    return 1e6 * 0.0981 * (56 + 7.62336 * hardness) / (0.137505 * (254 - 2.54 * hardness))


def read_pads() -> dict[str, Pad]:
    """Return the pads of the table by name."""
    return {
        row["name"]: Pad(
            row["name"],
            float(row["hardness"]) + float(row["tolerance"]),
            1e-3 * float(row["thickness"]),
            PowerLaw(float(row["stiffness"])),
        )
        for row in table_rows("pads.csv")
    }


PADS = read_pads()
"""Every pad by name."""

HARDEST = PADS["sh70"]
"""The pad that stands for the skin of head, chest, hands: the hardest one, hence the worst."""
