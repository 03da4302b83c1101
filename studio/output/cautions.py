# SPDX-License-Identifier: BSD-3-Clause
"""What a reader must know before using a result's numbers."""

from __future__ import annotations

from collections.abc import Iterable, Iterator

from softimpact.optimize import Study
from softimpact.optimize.study.study_scenarios import contacts_of
from softimpact.simulate.assessment import unused_of_the_file
from softimpact.symbolic import BodyRegion, ImpactModel
from softimpact.symbolic.impact.floating import base_held, is_floating


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
    beside = any("beside" in variable.moves for variable in study.variables)
    line = (
        "no C package of the design: beside springs of its own, loops, coupled or passive joints "
        "it cannot have springs behind motors"
    )
    return [*study_warnings(study), *([line] if beside or in_c(study.model) is None else [])]


def in_c(model: ImpactModel) -> ImpactModel | None:
    """Return the model of which a design's C is, with its base held; None if springs were lost."""
    from softimpact.codegen.inputs.parameters import lacks_springs

    held = base_held(model) if is_floating(model.robot) else model
    return None if lacks_springs(held.robot, held.drives) else held
