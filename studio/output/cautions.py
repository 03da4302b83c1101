# SPDX-License-Identifier: BSD-3-Clause
"""What a reader must know before using a result's numbers."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from softimpact.optimize import Study
from softimpact.optimize.machine.coordinates import beside_motors
from softimpact.optimize.study.study_scenarios import contacts_of
from softimpact.simulate.assessment import unused_of_the_file
from softimpact.symbolic import BodyRegion


def not_permitted(regions: Iterable[BodyRegion]) -> Iterator[str]:
    """Yield a line for each region with which contact is not permitted."""
    for name in dict.fromkeys(region.name for region in regions if not region.permitted):
        yield (
            f"contact with '{name}' is not permitted, whatever the force; its limits are for "
            "reference"
        )


def study_warnings(study: Study) -> list[str]:
    """Return what was ignored of a study's robot, and what its limits are worth, a line each."""
    return [
        *study.robot.warnings,
        *unused_of_the_file(study.model),
        *not_permitted(contact.region for contact in contacts_of(study)),
    ]


def design_warnings(study: Study) -> list[str]:
    """Return these of a design, of which a C package may be written."""
    beside = beside_motors(study.model).any() or any("beside" in v.moves for v in study.variables)
    line = "no C package of the design: it cannot have springs beside motors and behind them"
    return [*study_warnings(study), *([line] if beside else [])]
