# SPDX-License-Identifier: BSD-3-Clause
"""What a front trades: objectives, and figures that bounds look at; each as it lies in its file."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from softimpact.symbolic import InvalidValue, UnknownName

from .. import bounds, objectives
from ..bounds import Bound, Deflection
from ..evaluation import figures
from ..members import built, kinds_in
from ..objectives import Objective
from ..robust.certificate import Worst
from ..study.scenarios import Scenarios
from ..study.study import Study

WORDS = {
    "force": "worst_force",
    "accuracy": "deflection",
    "speed": "safe_speed",
    "time": "task_time",
}
"""What people call some of them."""

FEWEST, MOST = 2, 3
"""Objectives of a front."""

LOOSE = 1e3
"""Times the figure of a machine as it is that no design comes near."""


AskedAxis = tuple[Study, Scenarios]
"""A problem."""


class Axis(Protocol):
    """One of the quantities of a front."""

    @property
    def kind(self) -> str:
        """Name of the objective or bound."""

    @property
    def unit(self) -> str:
        """Unit of its values."""

    @property
    def more_is_better(self) -> bool:
        """Whether values are to be large."""

    def held(self, study: Study, scenarios: Scenarios, value: float) -> AskedAxis:
        """Return the problem in which designs are no worse than a value here."""

    def value(self, worst: Worst, held: float) -> float:
        """Return a design's value, which was sought with this one held at a value."""

    def loosest(self, study: Study, scenarios: Scenarios) -> float | None:
        """Return a value that leaves every design free; None where there is none."""


@dataclass(frozen=True)
class BoundAxis:
    """A bound's figure, where it is nearest to its limit.

    Attributes:
        bound: of any limit.
        own: limit that the study gives it; None where it has none.
    """

    bound: Bound
    own: float | None = None

    @property
    def kind(self) -> str:
        """Name of the bound."""
        return self.bound.kind

    @property
    def unit(self) -> str:
        """Unit of the figure."""
        return self.bound.unit

    @property
    def more_is_better(self) -> bool:
        """Whether figures are to be large."""
        return self.bound.sense == "least"

    def held(self, study: Study, scenarios: Scenarios, value: float) -> AskedAxis:
        """Return the problem with another limit."""
        if self.kind == Deflection.kind:
            return replace(study, max_deflection=value), scenarios
        others = tuple(b.at(value) if b.kind == self.kind else b for b in study.other_bounds)
        return replace(study, other_bounds=others), scenarios

    def value(self, worst: Worst, held: float) -> float:
        """Return the figure over all postures that is nearest to the limit."""
        return next(kept.figure for kept in worst.bounds if kept.name == self.bound.name)

    def loosest(self, study: Study, scenarios: Scenarios) -> float | None:
        """Return a thousand times what the machine as it is has, or a thousandth."""
        each = [figures(self.bound, study, pose.q, study.nominal) for pose in scenarios.poses]
        all_ = np.concatenate(each)
        if not all_.size or not (worst := all_.min() if self.more_is_better else all_.max()) > 0:
            raise refused(study, f"{self.bound.name}: nothing of this study moves it")
        return float(worst / LOOSE if self.more_is_better else worst * LOOSE)


@dataclass(frozen=True)
class ObjectiveAxis:
    """An objective, which is sought, or held where it says how."""

    objective: Objective

    @property
    def kind(self) -> str:
        """Name of the objective."""
        return self.objective.kind

    @property
    def unit(self) -> str:
        """Unit of the objective."""
        return self.objective.unit

    @property
    def more_is_better(self) -> bool:
        """Whether values are to be large."""
        return self.objective.more_is_better

    def held(self, study: Study, scenarios: Scenarios, value: float) -> AskedAxis:
        """Return the problem in which this objective has a value."""
        return study, self.objective.held(scenarios, value)

    def value(self, worst: Worst, held: float) -> float:
        """Return the value at which it was held."""
        return held

    def loosest(self, study: Study, scenarios: Scenarios) -> float | None:
        """Return None: what an objective is held at decides about the others."""
        return None


@dataclass(frozen=True)
class Axes:
    """The quantities of a front.

    Attributes:
        sought: the objective that is made best where the others are held.
        held: the others.
        order: place of each quantity as it was asked for; the sought one is number 0.
    """

    sought: ObjectiveAxis
    held: tuple[BoundAxis | ObjectiveAxis, ...]
    order: tuple[int, ...]

    @property
    def all(self) -> tuple[BoundAxis | ObjectiveAxis, ...]:
        """All of them, as they were asked for."""
        found = (self.sought, *self.held)
        return tuple(found[i] for i in self.order)

    def study(self, study: Study) -> Study:
        """Return a study that seeks and bounds what the front needs.

        Raises:
            InvalidValue: a bound on speeds beside an objective that changes them.
        """
        ours = [axis.bound for axis in self.held if isinstance(axis, BoundAxis)]
        kinds = {bound.kind for bound in ours} - {Deflection.kind}
        rest = [bound for bound in study.other_bounds if bound.kind not in kinds]
        others = (*rest, *(bound for bound in ours if bound.kind in kinds))
        fast = [a for a in self.all if isinstance(a, ObjectiveAxis) and a.objective.scales_speed]
        slow = [bound for bound in others if bound.needs_speed]
        if fast and slow:
            raise refused(
                study,
                f"'{fast[0].kind}' changes the speeds for which bounds.{slow[0].kind} holds; leave "
                "one of them out",
            )
        return replace(study, objective=self.sought.objective, other_bounds=others)


def refused(study: Study, why: str) -> InvalidValue:
    """Return the error of objectives that make no front."""
    return InvalidValue(f"{study.source}: pareto.objectives", why)


def asked_axes(study: Study, names: Sequence[str]) -> Axes:
    """Return what a front over some objectives trades.

    Args:
        study: whose own objective and bounds keep their fields.
        names: kinds of objectives and bounds, or words for them.

    Raises:
        InvalidValue: there is no such kind, or they make no front.
    """
    kinds = [WORDS.get(name, name) for name in names]
    if not FEWEST <= len(kinds) <= MOST:
        raise refused(study, f"name two or three, not {len(kinds)}")
    twice = [kind for kind in kinds if kinds.count(kind) > 1]
    if twice:
        raise refused(study, f"'{twice[0]}' is named twice")
    axes = [_axis(study, kind) for kind in kinds]
    sought = _sought(study, [axis for axis in axes if isinstance(axis, ObjectiveAxis)])
    held = tuple(axis for axis in axes if axis is not sought)
    return Axes(sought, held, tuple((sought, *held).index(axis) for axis in axes))


def _axis(study: Study, kind: str) -> BoundAxis | ObjectiveAxis:
    of_objectives, of_bounds = kinds_in(objectives, Objective), kinds_in(bounds, Bound)
    if kind in of_objectives:
        own = study.objective
        return ObjectiveAxis(own if own.kind == kind else of_objectives[kind]())
    if kind == Deflection.kind:
        return BoundAxis(study.deflection, study.max_deflection)
    if kind not in of_bounds:
        known = [*WORDS, *of_objectives, *of_bounds]
        raise refused(study, str(UnknownName("objective or bound", kind, known)))
    own_bounds = [bound for bound in study.other_bounds if bound.kind == kind]
    if own_bounds:
        return BoundAxis(own_bounds[0], own_bounds[0].limit)
    try:
        return BoundAxis(built(of_bounds, "bound", kind, {of_bounds[kind].sense: 1.0}))  # type: ignore[attr-defined]
    except InvalidValue as error:
        raise refused(study, f"needs a table [bounds.{kind}]: {error.reason}") from None


def _sought(study: Study, found: Sequence[ObjectiveAxis]) -> ObjectiveAxis:
    """Return the objective that is sought; another one, of the other sort, can be held."""
    if not found:
        names = ", ".join(kinds_in(objectives, Objective))
        raise refused(study, f"one of them must be an objective: {names}")
    for fast, words in ((True, "how fast impacts are"), (False, "what forces are worth")):
        same = [axis.kind for axis in found if axis.objective.scales_speed == fast]
        if len(same) > 1:
            raise refused(study, f"{same[0]} and {same[1]} both say {words}; leave one of them out")
    unheld = [axis for axis in found if axis.objective.span is None]
    if len(unheld) > 1:
        raise refused(
            study,
            f"{unheld[0].kind} and {unheld[1].kind} cannot be held at a value, only sought; leave "
            "one of them out",
        )
    of_force = [axis for axis in found if not axis.objective.scales_speed]
    return [*unheld, *of_force, *found][0]
