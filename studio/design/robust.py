# SPDX-License-Identifier: BSD-3-Clause
"""What a robust design found, checked by simulation, as plain data and in words."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

from softimpact.optimize import Study
from softimpact.optimize.answers import by_name
from softimpact.optimize.evaluation import Kept
from softimpact.optimize.robust.catalogue import Bought
from softimpact.optimize.robust.certificate import Worst
from softimpact.optimize.robust.robust import RobustDesign
from softimpact.optimize.units import figure_in_words
from softimpact.symbolic.robot.rigid import Array

from ..output.cautions import design_warnings
from .answers_in_words import answers_in_words
from .report import GENERATOR, inputs, versions
from .scenario_checks import (
    CheckedScenario,
    Designed,
    doubts_in_words,
    place_in_words,
    scenario_record,
)

ROUNDING = 1e-6
"""Share of a limit by which a design that is as fast as it allows may pass it."""


def share_of_limit(design: Designed) -> float:
    """Return the largest force over its limit, all of it where scenarios allow a share alone."""
    return design.worst.share * design.scenarios.allowed


def meets_limit(design: Designed) -> bool:
    """Return whether every scenario keeps its limit."""
    return share_of_limit(design) <= 1 + ROUNDING


def robust_record(design: RobustDesign, checks: Sequence[CheckedScenario]) -> dict[str, Any]:
    """Return a robust design as plain data, for ``results.json``; its checks worst first."""
    study, scenarios, worst = design.study, design.scenarios, design.worst
    equal, equal_springs = design.equal
    names = study.range.names[max(study.groups) + 1 :]
    return {
        "generator": GENERATOR,
        "versions": versions(),
        "study": inputs(study),
        "peak_definition": "peak",
        "warnings": [*design_warnings(study), *doubts_in_words(design, checks)],
        "objective": {
            "kind": study.objective.kind,
            "unit": study.objective.unit,
            "value": worst.value,
        },
        "winner": {
            "springs": design.springs,
            "others": dict(zip(names, design.others.tolist(), strict=True)),
            "postures": {
                pose.pose.name: q for pose, q in zip(scenarios.poses, design.postures, strict=True)
            },
            "deflection": worst.deflection,
            "speed_factors": worst.factors,
            "meets_limit": meets_limit(design),
        },
        "worst_force": worst.force,
        "worst_share": worst.share,
        "worst_scenario": scenario_record(design, worst.index),
        "check": checks[0].check,
        "checks": [{**scenario_record(design, each.index), **vars(each.check)} for each in checks],
        "bounds": worst.bounds,
        "before": _other(design, design.before, study.nominal),
        "equal": _other(design, equal, equal_springs),
        "catalogue": catalogue_record(design.bought),
        "indifferent": by_name(study, design.indifferent),
        "prices": design.prices,
        "conflicts": [],
        "certificate": {
            "scenarios": len(scenarios),
            "worst_share": worst.share,
            "bound": design.bound,
            "exchanges": design.rounds,
            "active": [scenarios.describe(scenarios[i]) for i in design.active],
        },
        "solver": {
            "compiled": design.compiled,
            "impact_duration": design.timing.duration,
            "impact_steps": design.timing.steps,
        },
    }


def catalogue_record(bought: Bought | None) -> dict[str, Any] | None:
    """Return what springs of a catalogue cost, as plain data; None without one."""
    if bought is None:
        return None
    return {"ideal_springs": bought.ideal, "loss": bought.loss, "tried": bought.tried}


def _other(design: RobustDesign, worst: Worst, springs: Array) -> dict[str, Any]:
    return {
        "springs": springs,
        "worst_force": worst.force,
        "worst_share": worst.share,
        "worst_scenario": scenario_record(design, worst.index),
        "value": worst.value,
        "deflection": worst.deflection,
        "keeps_bounds": worst.keeps,
    }


def robust_in_words(design: RobustDesign) -> list[str]:
    """Return what was found, a sentence each."""
    study, worst, objective = design.study, design.worst, design.study.objective
    equal, springs = design.equal
    saved = 100 * (1 - worst.value / equal.value) * (-1 if objective.more_is_better else 1)
    gain = "gains" if objective.more_is_better else "saves"
    named = ", ".join(others_in_words(study, design.others))
    lines = [
        f"{study.title}: {len(design.scenarios)} scenarios",
        f"k_s = [{', '.join(f'{k:.0f}' for k in design.springs)}] N·m/rad",
        *([named] if named else []),
        *_bought_in_words(design.bought),
        f"{objective.kind.replace('_', ' ').capitalize()}: {worst.value:.4g} {objective.unit}",
        f"Worst: {worst.force:.1f} N, {worst.share:.2f} times its limit: "
        f"{place_in_words(design, worst.index)}",
        *(_kept(each) for each in worst.bounds),
        f"Equal proportions, just accurate (k_s = {_range(springs)}): {equal.force:.1f} N, "
        f"{equal.value:.4g} {objective.unit}{_broken(equal)}; the design {gain} {saved:.1f} %",
        f"Before: {design.before.force:.1f} N, {design.before.value:.4g} {objective.unit}, "
        f"{1e3 * design.before.deflection:.4g} mm" + _broken(design.before),
    ]
    lines += answers_in_words(study, design.indifferent, design.prices)
    lines.append(
        f"Certificate: all {len(design.scenarios)} scenarios evaluated, none above "
        f"{worst.share:.4f} times its limit; the {len(design.active)} that decide allow no less "
        f"than {design.bound:.4f} (a local optimum)"
    )
    return lines


def others_in_words(study: Study, others: Array) -> list[str]:
    """Return the values of the hardware beside the springs, with their names and units."""
    springs = max(study.groups) + 1
    names, units = study.range.names[springs:], study.units[springs:]
    return [
        f"{name} {figure_in_words(value, unit)}"
        for name, unit, value in zip(names, units, others.tolist(), strict=True)
    ]


def _bought_in_words(bought: Bought | None) -> list[str]:
    if bought is None:
        return []
    ideal = ", ".join(f"{k:.0f}" for k in bought.ideal)
    return [
        f"of the catalogue, the best of {bought.tried} combinations; it costs "
        f"{100 * bought.loss:.2g} % against springs of any stiffness, k_s = [{ideal}]"
    ]


def _kept(bound: Kept) -> str:
    words = "at most" if bound.sense == "most" else "at least"
    allowed = "allowed" if bound.sense == "most" else "asked"
    return (
        f"{bound.name}: {figure_in_words(bound.figure, bound.unit)} {words}, of "
        f"{figure_in_words(bound.limit, bound.unit)} {allowed}"
    )


def _broken(worst: Worst) -> str:
    broken = [each.name for each in worst.bounds if each.broken]
    return f", which breaks {' and '.join(broken)}" if broken else ""


def _range(springs: Array) -> str:
    low, high = float(springs.min()), float(springs.max())
    return f"{low:.0f}" if high - low < 1 else f"{low:.0f}–{high:.0f}"
