# SPDX-License-Identifier: BSD-3-Clause
"""What all figures share: colours, sizes, words, and how they are written.

Figures are made through Matplotlib's object-oriented interface: no window, no global state.
"""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any, Protocol

from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter

from softimpact.optimize import Study
from softimpact.studio.design.report import DesignReport, limit_kind

# Okabe and Ito's colours, told apart by the colour-blind too
BLACK, BLUE, ORANGE = "#000000", "#0072B2", "#E69F00"
GREEN, VERMILLION, SKY, PURPLE = "#009E73", "#D55E00", "#56B4E9", "#CC79A7"

BEFORE, SPRINGS, BOTH, LIMIT = ORANGE, GREEN, BLUE, VERMILLION
"""Nominal stiffness, springs designed, springs and posture designed, the region's force limit."""

FAINT, LIGHT = "#E6E6E6", "#B8B8B8"

TEXT = 10
SMALL = 9
"""Sizes of text [pt]; nothing is smaller."""

DPI = 150

MODE_COLOURS = {"table": SPRINGS, "free": BOTH}
MODE_WORDS = {"table": "springs designed, posture held", "free": "springs and posture designed"}


class Reported(Protocol):
    """What any report of a study has."""

    @property
    def study(self) -> Study:
        """The problem."""

    @property
    def limit(self) -> float:
        """Force limit of the body region [N]."""


def new_figure(width: float, height: float) -> Figure:
    """Return an empty figure [in] that leaves room for legends outside of its axes."""
    figure = Figure(figsize=(width, height), dpi=DPI, layout="constrained")
    FigureCanvasAgg(figure)
    return figure


def tidy(axes: Any, grid: str = "both") -> None:
    """Give flat axes a faint grid behind the data, and no frame above and to the right."""
    axes.set_axisbelow(True)
    axes.grid(axis=grid, color=FAINT, linewidth=0.8)
    axes.spines[["top", "right"]].set_visible(False)
    axes.tick_params(labelsize=SMALL)


def plain_log_ticks(axes: Any) -> None:
    """Label a logarithmic horizontal axis with plain numbers at 1, 2 and 5 of each decade."""
    axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
    axes.xaxis.set_major_formatter("{x:g}")
    axes.xaxis.set_minor_formatter(NullFormatter())


def legend_below(figure: Figure, handles: Sequence[Any], columns: int) -> None:
    """Explain marks and lines below the axes, outside of the data."""
    figure.legend(
        handles=list(handles),
        loc="outside lower center",
        ncols=columns,
        fontsize=SMALL,
        frameon=False,
    )


def save(figure: Figure, path: Path) -> Path:
    """Write a figure as PNG; the same figure gives the same bytes."""
    figure.savefig(path, dpi=DPI, metadata={"Software": None})
    return path


def setting(report: Reported) -> str:
    """Return which robot hits what, how that is held and how fast, for titles."""
    study = report.study
    held = "clamped" if study.contact.clamped else "free to give way"
    region = study.contact.region.title.lower()
    return f"{study.robot.name} against {region} ({held}) at {study.speed:g} m/s"


def winner_in_words(report: DesignReport) -> str:
    """Return which pose won, or which one the search that won began with."""
    winner = report.design.winner
    return f"winner: {winner.name}" if winner.mode == "table" else f"winner: from {winner.name}"


def limit_in_words(report: Reported) -> str:
    """Return the force limit with its kind and source, for legends and labels."""
    kind = limit_kind(report.study).replace("_", "-")
    return f"{kind} limit {report.limit:g} N (ISO/TS 15066)"
