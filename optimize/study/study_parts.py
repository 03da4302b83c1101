# SPDX-License-Identifier: BSD-3-Clause
"""The bounds, variables and objective that a study file asks for."""

from __future__ import annotations

from typing import Any

from softimpact.symbolic import ImpactModel, InvalidValue

from .. import bounds, objectives, variables
from ..bounds import Bound, Deflection
from ..bounds.torque import Torque
from ..machine.coordinates import is_plain, loose
from ..members import built, kinds_in
from ..objectives import Objective, WorstForce
from ..variables import JointStiffness, Variable
from ..variables.cover import Cover
from .study_file import HardwareSection


def asked_bounds(tables: dict[str, Any], model: ImpactModel) -> tuple[Bound, ...]:
    """Return the bounds of ``[bounds]``; raises InvalidValue."""
    if Torque.kind in tables and loose(model):
        raise InvalidValue(
            Torque.kind,
            "of a floating robot depends on what it stands on; hold the base, or leave it out",
        )
    kinds = kinds_in(bounds, Bound)
    kinds = {kind: found for kind, found in kinds.items() if found is not Deflection}
    found = tuple(built(kinds, "bound", kind, fields) for kind, fields in tables.items())
    for bound in found:
        if not bound.limit > 0:
            raise InvalidValue(
                f"{bound.kind}.{bound.sense}", f"must be greater than 0 {bound.unit}"
            )
    return found


def asked_variables(section: HardwareSection, model: ImpactModel) -> tuple[Variable, ...]:
    """Return the variables of ``[hardware]`` beside the springs; raises InvalidValue."""
    kinds = kinds_in(variables, Variable)
    kinds = {kind: found for kind, found in kinds.items() if found is not JointStiffness}
    found = []
    for kind, fields in (section.model_extra or {}).items():
        if kind != Cover.kind and kind in kinds and not is_plain(model):
            raise InvalidValue(
                kind, "is for arms in which each joint has a motor with a spring; take springs"
            )
        variable = built(kinds, "variable", kind, fields)
        try:
            variable.range(model)
        except InvalidValue as error:
            raise InvalidValue(f"{kind}.{error.field}", error.reason) from None
        found.append(variable)
    return tuple(found)


def asked_objective(table: dict[str, Any]) -> Objective:
    """Return the objective of ``[objective]``; raises InvalidValue."""
    if not table:
        return WorstForce()
    fields = dict(table)
    kind = fields.pop("kind", WorstForce.kind)
    if not isinstance(kind, str):
        raise InvalidValue("kind", "must be a name")
    found: Objective = built(kinds_in(objectives, Objective), "objective", kind, fields)
    return found


def require_fit(objective: Objective, given: tuple[Bound, ...]) -> None:
    """Raise InvalidValue for a bound on speeds that the objective changes."""
    for bound in given:
        if objective.scales_speed and bound.needs_speed:
            raise InvalidValue(
                "kind",
                f"'{objective.kind}' changes the speeds for which bounds.{bound.kind} holds; "
                "leave one of them out",
            )
