# SPDX-License-Identifier: BSD-3-Clause
"""The paper's figures redrawn, with the models that it did not have."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial
from pathlib import Path
from textwrap import fill

import matplotlib as mpl
import numpy as np
from cycler import cycler
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from softimpact.studio.figures.style import (
    BLACK,
    BLUE,
    GREEN,
    ORANGE,
    PURPLE,
    SKY,
    VERMILLION,
)

from .compute import COMPARED, SPEEDS, Results, SweepPoint
from .ladder import LADDER, REGIONS
from .ladder_figures import COLOURS, error_figure, ladder_figure
from .scenarios import SCENARIOS

PaperFigure = tuple[str, str, Callable[[], Figure]]
"""File name, caption, and how to draw it."""

STYLES = {"full": "-", "two_mass": "--", "chain_controlled": ":"}
MODEL_COLOURS = {"full": "C0", "two_mass": "C3", "chain_controlled": "C2"}
TITLE = 9
"""Size of figures' titles [pt], of which some 12 letters take an inch."""

STIFFNESS_AXIS = "joint stiffness $k_s$ [N·m/rad]"

STYLE = {
    "axes.prop_cycle": cycler(color=[BLUE, ORANGE, GREEN, VERMILLION, SKY, PURPLE, BLACK]),
    "font.size": 9.0,
    "axes.grid": True,
    "grid.alpha": 0.3,
    "grid.linewidth": 0.5,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "legend.frameon": False,
    "lines.linewidth": 1.4,
    "savefig.dpi": 160,
}


def draw(results: Results, folder: Path) -> dict[str, str]:
    """Draw every figure that the results hold; return captions by file name."""
    drawn: dict[str, str] = {}
    with mpl.rc_context(STYLE):
        for name, caption, build in _figures(results):
            figure = build()
            letters = int(12 * figure.get_figwidth())
            figure.suptitle(fill(caption, letters), fontsize=TITLE)
            figure.savefig(folder / name)
            drawn[name] = caption
    return drawn


def _figures(results: Results) -> list[PaperFigure]:
    r_r = [s for s in results.sweeps if SCENARIOS[s].arm.robot == "rr"]
    r_min = [s for s in results.sweeps if SCENARIOS[s].arm.robot == "rmin"]
    wanted: list[PaperFigure] = []
    for numbers, group in (((5, 6, 8), r_r), ((13, 12, 15), r_min)):
        if not group:
            continue
        robot = SCENARIOS[group[0]].arm.robot
        k_r, m_a, peaks = numbers
        chosen = {s: results.sweeps[s] for s in group}
        wanted += [
            (
                f"fig{k_r:02}_{robot}_k_r.png",
                f"Fig. {k_r}: reflected stiffness k_r, and Kishi's static k_c beside it.",
                partial(_stiffness_figure, chosen),
            ),
            (
                f"fig{m_a:02}_{robot}_m_a.png",
                f"Fig. {m_a}: mass m_a on the actuators' side.",
                partial(_mass_figure, chosen),
            ),
            (
                f"fig{peaks:02}_{robot}_peaks.png",
                f"Fig. {peaks}: first peak over joint stiffness at 1 m/s, head and chest.",
                partial(_peak_figure, chosen),
            ),
        ]
    for number, name in ((7, "a"), (14, "f")):
        if results.traces.get(name):
            wanted.append(
                (
                    f"fig{number:02}_{name}_time.png",
                    f"Fig. {number}: contact force on the head over time, ({name}) at 1 m/s.",
                    partial(_time_figure, results, name),
                )
            )
    if r_r:
        caption = "Fig. 9: first peak on the head over speed, k_s = 10⁴ N·m/rad."
        wanted.append(("fig09_rr_speed.png", caption, partial(_speed_figure, results, r_r)))
    caption = "All models' first-contact peak over joint stiffness, head."
    wanted.append(("ladder_peaks.png", caption, partial(ladder_figure, results)))
    caption = (
        "Mean error of each model's first contact against full with controller; bars end at 0.01 %."
    )
    wanted.append(("ladder_errors.png", caption, partial(error_figure, results)))
    return sorted(wanted, key=lambda drawing: drawing[0])


def _figure(columns: int, rows: int = 1, width: float = 3.6, height: float = 2.8) -> Figure:
    figure = Figure(figsize=(width * columns, height * rows), layout="constrained")
    figure.subplots(rows, columns, squeeze=False)
    return figure


def _over_stiffness(axes: Axes, label: str) -> None:
    axes.set_xscale("log")
    axes.set_xlabel(STIFFNESS_AXIS)
    axes.set_ylabel(label)


def _values(
    points: Sequence[SweepPoint], of: Callable[[SweepPoint], float]
) -> tuple[list[float], ...]:
    return [p.stiffness for p in points], [of(p) for p in points]


def _stiffness_figure(sweeps: dict[str, list[SweepPoint]]) -> Figure:
    figure = _figure(1, width=4.6, height=3.2)
    axes = figure.axes[0]
    for name, points in sweeps.items():
        colour = COLOURS[name]
        axes.plot(*_values(points, lambda p: p.k_r), color=colour, label=f"$k_r$ ({name})")
        axes.plot(*_values(points, lambda p: p.k_c), ":", color=colour, label=f"$k_c$ ({name})")
    _over_stiffness(axes, "stiffness at the contact [N/m]")
    axes.set_yscale("log")
    axes.legend(ncols=2)
    return figure


def _mass_figure(sweeps: dict[str, list[SweepPoint]]) -> Figure:
    figure = _figure(1, width=4.6, height=3.2)
    axes = figure.axes[0]
    for name, points in sweeps.items():
        colour = COLOURS[name]
        axes.plot(*_values(points, lambda p: p.m_a), color=colour, label=f"$m_a$ ({name})")
        axes.plot(*_values(points, lambda p: p.m_c), ":", color=colour, label=f"$m_c$ ({name})")
    _over_stiffness(axes, "mass [kg]")
    axes.set_ylim(bottom=0)
    axes.legend(ncols=2)
    return figure


def _peak_figure(sweeps: dict[str, list[SweepPoint]]) -> Figure:
    figure = _figure(2, width=3.8, height=3.6)
    for axes, region in zip(figure.axes, REGIONS, strict=True):
        for name, points in sweeps.items():
            for rung in COMPARED:
                line = _values(points, lambda p: p.peaks[region][rung]["first_peak"])  # noqa: B023
                axes.plot(*line, STYLES[rung], color=COLOURS[name])
        _over_stiffness(axes, "first peak [N]")
        axes.set_ylim(bottom=0)
        axes.set_title(region)
    handles = [Line2D([], [], color=COLOURS[name], label=f"({name})") for name in sweeps]
    handles += [_key(rung, "0.3") for rung in COMPARED]
    figure.legend(handles=handles, loc="outside lower center", ncols=len(COMPARED) + 1)
    return figure


def _key(rung: str, colour: str) -> Line2D:
    return Line2D([], [], color=colour, linestyle=STYLES[rung], label=LADDER[rung].title)


def _time_figure(results: Results, name: str) -> Figure:
    traces = results.traces[name]
    figure = _figure(3, rows=(len(traces) + 2) // 3, width=2.9, height=2.2)
    panels = list(figure.axes)
    highest = max(t.force.max() for models in traces.values() for t in models.values())
    for axes, (stiffness, models) in zip(panels, sorted(traces.items()), strict=False):
        for rung, trace in models.items():
            milliseconds = 1e3 * trace.time
            axes.plot(milliseconds, trace.force, STYLES[rung], color=MODEL_COLOURS[rung])
        axes.set_title(f"$k_s$ = {stiffness:.0f} N·m/rad", fontsize=9)
        axes.set_ylim(0, 1.05 * highest)
        axes.set_xlim(0, 1e3 * max(t.time[-1] for t in models.values()))
    for axes in panels[len(traces) :]:
        axes.remove()
    for axes in figure.axes[-3:]:  # one label of the figure would lie under its legend
        axes.set_xlabel("time since first touch [ms]")
    figure.supylabel("contact force [N]", fontsize=9)
    handles = [_key(rung, MODEL_COLOURS[rung]) for rung in COMPARED]
    figure.legend(handles=handles, loc="outside lower center", ncols=len(handles))
    return figure


def _speed_figure(results: Results, names: Sequence[str]) -> Figure:
    figure = _figure(1, width=5.2, height=3.6)
    axes = figure.axes[0]
    for name in names:
        for rung in COMPARED:
            forces = [peaks[rung] for peaks in results.speeds[name]]
            axes.plot(SPEEDS, forces, STYLES[rung], color=COLOURS[name])
    axes.set_xlim(0, float(np.max(SPEEDS)))
    axes.set_ylim(bottom=0)
    axes.set_xlabel("speed of the contact point [m/s]")
    axes.set_ylabel("first peak [N]")
    handles = [Line2D([], [], color=COLOURS[name], label=f"({name})") for name in names]
    handles += [_key(rung, "0.3") for rung in COMPARED]
    axes.legend(handles=handles)
    return figure
