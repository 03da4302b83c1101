# SPDX-License-Identifier: BSD-3-Clause
"""What was measured beside what is foretold, as figures."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from softimpact.studio.figures.style import (
    BLACK,
    BLUE,
    LIGHT,
    ORANGE,
    SKY,
    SMALL,
    TEXT,
    VERMILLION,
    new_figure,
    save,
    tidy,
)

from .foretold import ForceBand, two_body_force
from .setups import Measurement
from .wall import ApparentMasses

DRAWN = (2.5, 50.0, 97.5)
"""Percentiles of a bar's ends and its mark."""


def device_figure(
    found: Mapping[Measurement, Sequence[ForceBand]], times: Sequence[float], title: str, path: Path
) -> Path:
    """Draw foretold forces over the time for which motors drive on, and the measured ones.

    Args:
        found: bands of each measured impact, one for each time.
        times: [s].
        title: the message.
        path: of the PNG.
    """
    figure = new_figure(10, 4.2)
    panels = figure.subplots(1, len(found), sharex=True)
    ms = 1e3 * np.array(times)
    for axes, (measured, bands) in zip(panels, found.items(), strict=True):
        low, middle, high = (
            np.array([getattr(b, x) for b in bands]) for x in ForceBand.__annotations__
        )
        axes.fill_between(ms, low, high, color=SKY, alpha=0.45, linewidth=0)
        axes.plot(ms, middle, color=BLUE, linewidth=1.6)
        axes.axhline(measured.force, color=VERMILLION, linewidth=1.8)
        iso = two_body_force(measured)
        axes.axhline(iso, color=BLACK, linewidth=1.2, linestyle=(0, (1, 2)))
        top = 1.05 * float(high.max())
        axes.set_ylim(0, top)
        axes.set_xlim(0, ms[-1])
        _label(axes, ms[-1], measured.force, f"measured {measured.force:g} N", VERMILLION, top)
        _label(axes, ms[-1], iso, f"two-body formula {iso:.0f} N", BLACK, top)
        axes.set_title(measured.title, fontsize=TEXT)
        axes.set_xlabel("motors drive on for [ms]", fontsize=SMALL)
        tidy(axes)
    panels[0].set_ylabel("largest force on the device [N]", fontsize=SMALL)
    first = next(iter(found.values()))
    _note(panels[0], (16, first[3].middle), (0, -3), "median", "top")
    spread = "band: 95 of 100\ndraws of rotors,\nsprings, pad\nand payload"
    _note(panels[0], (1.5, first[-1].high), (0, 0), spread, "top")
    figure.suptitle(title, fontsize=TEXT + 1)
    return save(figure, path)


def _label(axes: Any, x: float, y: float, text: str, colour: str, top: float) -> None:
    axes.annotate(
        text,
        (x, y),
        xytext=(-4, 3),
        textcoords="offset points",
        ha="right",
        va="bottom",
        color=colour,
        fontsize=SMALL,
        bbox={"boxstyle": "round,pad=0.1", "facecolor": "white", "alpha": 0.7, "edgecolor": "none"},
    )


def _note(
    axes: Any, at: tuple[float, float], moved: tuple[float, float], text: str, side: str
) -> None:
    axes.annotate(
        text,
        at,
        xytext=moved,
        textcoords="offset points",
        va=side,
        color=BLUE,
        fontsize=SMALL,
    )


def wall_figure(masses: ApparentMasses, names: Sequence[str], title: str, path: Path) -> Path:
    """Draw how heavy the arm seems at its flange, as a share of the composite body's mass.

    Args:
        masses: apparent ones.
        names: of the pairs of wall and wind-up.
        title: the message.
        path: of the PNG.
    """
    rows = [("links alone, joints free", masses.links, BLACK)]
    rows += [(f"rigid joints, rotors {name}", m, BLACK) for name, m in masses.rotors.items()]
    for i, name in enumerate(names):
        rows.append((f"{name}: motors free", masses.free[i], ORANGE))
        rows.append((f"{name}: motors drive on 20 ms", masses.driven[i], BLUE))
    figure = new_figure(9, 4.6)
    axes = figure.subplots()
    for place, (_, mass, colour) in enumerate(rows):
        low, middle, high = np.percentile(mass / masses.composite, DRAWN)
        axes.plot([low, high], [place, place], color=colour, linewidth=5, alpha=0.45)
        axes.plot([middle], [place], "o", color=colour, markersize=6)
    axes.axvline(1, color=VERMILLION, linewidth=1.8)
    axes.set_xscale("log")
    axes.set_xticks([0.2, 0.5, 1, 2, 5], ["0.2", "0.5", "1", "2", "5"])
    axes.minorticks_off()
    axes.set_yticks(range(len(rows)), [name for name, _, _ in rows], fontsize=SMALL)
    axes.invert_yaxis()
    axes.annotate(
        "measured: the composite\nrigid body fits best",
        (1, 0),
        xytext=(6, 0),
        textcoords="offset points",
        va="center",
        color=VERMILLION,
        fontsize=SMALL,
    )
    axes.axhline(len(masses.rotors) + 0.5, color=LIGHT, linewidth=0.8)
    axes.set_xlabel("apparent mass at the flange over the composite rigid body's", fontsize=SMALL)
    tidy(axes, grid="x")
    figure.suptitle(title, fontsize=TEXT + 1)
    return save(figure, path)
