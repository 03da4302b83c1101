# SPDX-License-Identifier: BSD-3-Clause
"""What fronts over two or three objectives say, as a table and sentences."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from softimpact.optimize.front.axes import BoundAxis
from softimpact.optimize.units import ratio_in_words

from ..design.answers_in_words import answers_in_words
from ..design.checks import checks_in_words
from ..design.report import peak_in_words
from ..design.robust import others_in_words
from ..design.scenario_checks import place_in_words
from ..output.printed import Cell
from .trade_off_report import TradeOffReport, View, broken_before
from .words import FrontWords

TABLE = "front.csv"
"""File with the designs."""


def front_words(report: TradeOffReport) -> FrontWords:
    """Return what the front says."""
    return FrontWords(heading(report), columns(report), rows(report), in_words(report), TABLE)


def heading(report: TradeOffReport) -> str:
    """Return what the table is about."""
    names = [view.label for view in report.views]
    return (
        f"{report.study.title}: {', '.join(names[:-1])} and {names[-1]}\n"
        f"{len(report.found.scenarios)} scenarios; {peak_in_words(report.study)}"
    )


def columns(report: TradeOffReport) -> list[str]:
    """Return the table's heads."""
    heads = ["\n".join([*view.label.split(), view.unit]) for view in report.views]
    force = [] if any(view.unit == "N" for view in report.views) else ["worst\nforce\nN"]
    unit = next((price.unit for point in report.points for price in point.prices), "")
    bought = [f"10 % of\n{view.label}\nbuys {unit}" for _, view in _priced(report)]
    return ["", *heads, *force, *bought]


def _priced(report: TradeOffReport) -> list[tuple[str, View]]:
    """Return the bounds that were held, with their views."""
    held = enumerate(report.found.axes.held, 1)
    return [(a.bound.name, report.view_of(i)[1]) for i, a in held if isinstance(a, BoundAxis)]


def rows(report: TradeOffReport) -> list[list[Cell]]:
    """Return a row for each design."""
    shows_force = all(view.unit != "N" for view in report.views)
    found: list[list[Cell]] = []
    for i, (point, values) in enumerate(zip(report.points, report.shown, strict=True)):
        gains = {price.bound: price.gain for price in point.prices}
        bought = (f"{gains.get(name, 0.0):.2g}" for name, _ in _priced(report))
        force = [f"{point.worst.force:.1f}"] if shows_force else []
        mark = "knee" if i == report.found.knee else str(i + 1)
        found.append([mark, *(f"{value:.4g}" for value in values), *force, *bought])
    return found


def in_words(report: TradeOffReport) -> list[str]:
    """Return what the front says, a sentence each."""
    return [
        *_ends(report),
        *_single(report),
        *_knee(report),
        *_before(report),
        _check(report),
        *_levels(report),
    ]


def _ends(report: TradeOffReport) -> Iterator[str]:
    """Yield what the best of each objective that was held costs, the others loose."""
    column, sought = report.view_of(0)
    for place, axis in enumerate(report.found.axes.held, 1):
        if report.found.levels[axis.kind].size < 2:
            continue
        own, view = report.view_of(place)
        ends = best_and_loosest(report, own)
        if ends is None:
            continue
        best, loose = ends
        a, b = (report.points[i].values for i in (loose, best))
        yield (
            f"{view.label.capitalize()}: {view.words(a[own])} → {view.words(b[own])} takes the "
            f"{sought.label} from {sought.words(a[column])} to {sought.words(b[column])}, "
            f"{ratio_in_words(b[column] / a[column], sought.label)}."
        )


def best_and_loosest(report: TradeOffReport, column: int) -> tuple[int, int] | None:
    """Return the points best in an objective and best in the one that was sought.

    Of several that are best in the first, that which is best in the second; None where the two are
    one point.
    """
    sought, _ = report.view_of(0)
    values = np.array([point.values for point in report.points])
    signs = np.array([-1.0 if view.more_is_better else 1.0 for view in report.views])
    costs = values * signs
    loose = int(np.argmin(costs[:, sought]))
    alike = np.isclose(values[:, column], values[np.argmin(costs[:, column]), column], rtol=1e-3)
    best = int(np.argmin(np.where(alike, costs[:, sought], np.inf)))
    return None if best == loose else (best, loose)


def _single(report: TradeOffReport) -> Iterator[str]:
    for place, axis in enumerate(report.found.axes.held, 1):
        if report.found.levels[axis.kind].size > 1:
            continue
        own, view = report.view_of(place)
        value = report.points[0].values[own]
        yield (
            f"{view.label.capitalize()}: nothing to trade; the best there is, "
            f"{view.words(value)} or 1 % from it, costs nothing of the rest."
        )


def _knee(report: TradeOffReport) -> Iterator[str]:
    if report.found.knee is None:
        return
    point = report.points[report.found.knee]
    others = others_in_words(report.study, point.others)
    yield f"The knee, beyond which all costs more: {values_in_words(report.views, point.values)}."
    springs = ", ".join(f"{k:.0f}" for k in point.springs)
    yield f"There: k_s = [{springs}] N·m/rad{'; ' if others else ''}{', '.join(others)}."
    yield f"There at worst {point.worst.force:.1f} N: {place_in_words(point, point.worst.index)}."
    yield from answers_in_words(point.study, point.indifferent, point.prices)


def values_in_words(views: Sequence[View], values: Sequence[float]) -> str:
    """Return a design's objectives in words."""
    pairs = zip(views, values, strict=True)
    return ", ".join(f"{view.label} {view.words(value)}" for view, value in pairs)


def _before(report: TradeOffReport) -> Iterator[str]:
    broken = broken_before(report.found)
    breaks = f"; it breaks {' and '.join(broken)}" if broken else ""
    words = values_in_words(report.views, report.found.before_values)
    yield f"Before, with the nominal springs: {words}{breaks}."


def _check(report: TradeOffReport) -> str:
    return checks_in_words("the worst scenario of", report.checks)


def _levels(report: TradeOffReport) -> Iterator[str]:
    found = report.found
    if found.out_of_reach:
        yield f"{found.out_of_reach} combinations of levels are beyond what any hardware reaches."
    losses = [point.bought.loss for point in found.points if point.bought is not None]
    if losses:
        yield (
            f"All springs are of the catalogue, which costs {100 * max(0.0, *losses):.2g} % of the "
            f"{report.view_of(0)[1].label} at most against springs of any stiffness."
        )
    if found.not_sold:
        yield f"{found.not_sold} combinations of levels are kept by no springs of the catalogue."
    if found.unsolved:
        kinds = ", ".join(sorted(set(found.unsolved)))
        yield f"Ipopt failed at {len(found.unsolved)} combinations within reach ({kinds})."
    else:
        yield f"Ipopt solved all {found.searched} combinations within reach."
