# SPDX-License-Identifier: BSD-3-Clause
"""A map of safe speeds: over a plane with the arm in it, or along the self-motion."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from softimpact.studio.map.safety_map import SafetyMap
from softimpact.symbolic import limits_of
from softimpact.symbolic.robot.rigid import Array

from .postures import stick_points
from .style import BLACK, BLUE, LIGHT, LIMIT, SMALL, TEXT, new_figure, save, tidy

ARROWS = 16
"""Directions that are drawn along the longer side."""

MARGIN = 0.12
"""Around the places that the tip reaches [m]."""

SHADES = "viridis"
"""Even steps of lightness, also for the colour-blind and in grey."""


def map_figure(found: SafetyMap, path: Path) -> Path:
    """Draw a map as a PNG."""
    figure = _plane(found) if found.over == "plane" else _along(found)
    figure.suptitle(_message(found), fontsize=TEXT + 1)
    return save(figure, path)


def _message(found: SafetyMap) -> str:
    safe = found.safe_speed
    held = "held" if found.body.clamped else "free to give way"
    way = "in the worst direction" if found.asked is None else f"along {_vector(found.asked)}"
    if not found.body.region.permitted:
        held += "; not permitted, for reference"
    title = found.body.region.title.lower()
    return (
        f"{found.model.robot.name} against the {title} ({held}) {way}: safe up to "
        f"{np.nanmin(safe):.2f} m/s at the worst place, {np.nanmax(safe):.2f} at the best"
    )


def _vector(n: Array) -> str:
    return "(" + ", ".join(f"{x + 0.0:.3g}" for x in n) + ")"


def _plane(found: SafetyMap) -> Figure:
    assert found.grid is not None
    u, v = found.grid
    wide, tall = np.ptp(u) + 2 * MARGIN, np.ptp(v) + 2 * MARGIN
    height = float(np.clip(4.7 * tall / wide, 3.0, 7.0))
    figure = new_figure(12.0, height + 0.9)
    left, right = figure.subplots(1, 2, sharex=True, sharey=True)
    _shade(figure, left, found, found.safe_speed, "largest safe speed [m/s]", SHADES)
    _arrows(left, found)
    label = f"peak force at {found.speed:g} m/s [N]"
    values = _shade(figure, right, found, found.peak, label, f"{SHADES}_r")
    limit = limits_of(found.body.region, found.body.clamped).transient.force
    if np.nanmin(values) < limit < np.nanmax(values):
        lines = right.contour(u, v, values.T, [limit], colors=LIMIT, linewidths=2)
        right.clabel(lines, fmt=f"limit {limit:.0f} N", fontsize=SMALL)
    for axes in (left, right):
        _arm(axes, found)
        axes.set_xlim(u[0] - MARGIN, u[-1] + MARGIN)
        axes.set_ylim(v[0] - MARGIN, v[-1] + MARGIN)
    (other,) = {0, 1, 2} - {*(found.axes or ())}
    turn = "keeps its turn" if found.hold == "pose" else "may turn"
    right.set_title(
        f"plane {'xyz'[other]} = {found.place[found.begun, other] + 0.0:.2f} m; the tip {turn}",
        fontsize=SMALL,
    )
    return figure


def _shade(
    figure: Figure, axes: Any, found: SafetyMap, numbers: Array, label: str, shades: str
) -> Array:
    assert found.grid is not None
    assert found.cells is not None
    assert found.axes is not None
    u, v = found.grid
    values = np.full((len(u), len(v)), np.nan)
    values[tuple(found.cells.T)] = numbers
    step = u[1] - u[0] if len(u) > 1 else v[1] - v[0]
    edges = [u[0] - step / 2, u[-1] + step / 2, v[0] - step / 2, v[-1] + step / 2]
    low, high = np.nanquantile(values, [0.01, 0.99])
    image = axes.imshow(
        values.T, origin="lower", extent=edges, cmap=shades, vmin=low, vmax=max(high, low + 1e-9)
    )
    bar = figure.colorbar(image, ax=axes, shrink=0.85, extend="both")
    bar.set_label(label, fontsize=SMALL)
    bar.ax.tick_params(labelsize=SMALL)
    across, up = ("xyz"[k] for k in found.axes)
    axes.set_xlabel(f"{across} of the tip [m]", fontsize=SMALL)
    axes.set_ylabel(f"{up} of the tip [m]", fontsize=SMALL)
    tidy(axes)
    axes.grid(visible=False)
    return values


def _arrows(axes: Any, found: SafetyMap) -> None:
    """Draw directions as far as they lie in the plane, both ways as forces are the same."""
    assert found.cells is not None
    assert found.axes is not None
    every = max(1, int(np.ptp(found.cells, axis=0).max()) // ARROWS)
    shown = (found.cells % every == every // 2).all(axis=1) & np.isfinite(found.safe_speed)
    if found.asked is not None or not shown.any():
        return
    flat = found.direction[shown][:, list(found.axes)]
    places = found.place[shown][:, list(found.axes)]
    for colour, width in ((BLACK, 0.0042), ("#FFFFFF", 0.0024)):
        axes.quiver(
            *places.T, *flat.T, color=colour, pivot="mid", headwidth=0, headlength=0,
            headaxislength=0, scale=1.25 * ARROWS, width=width,
        )  # fmt: skip
    axes.set_title("strokes: the worst direction, as far as it lies in the plane", fontsize=SMALL)


def _arm(axes: Any, found: SafetyMap) -> None:
    """Draw the arm where the map begins, and the tip where it may go least fast."""
    assert found.axes is not None
    (points,) = stick_points(found.model.robot, found.model.tip, [found.postures[found.begun]])
    flat = points[list(found.axes)]
    axes.plot(*flat, color="#FFFFFF", linewidth=5.5, solid_capstyle="round", zorder=4)
    axes.plot(*flat, color=BLACK, linewidth=2.5, marker="o", markersize=4, zorder=5)
    slowest = found.place[found.slowest][list(found.axes)]
    axes.plot(
        *slowest, "X", color=LIMIT, markeredgecolor="#FFFFFF", markersize=12, zorder=6,
        label="slowest",
    )  # fmt: skip
    axes.annotate(
        f"slowest {found.safe_speed[found.slowest]:.2f} m/s", slowest, xytext=(10, 5),
        textcoords="offset points", fontsize=SMALL, zorder=7,
        bbox={"boxstyle": "round,pad=0.2", "facecolor": "#FFFFFF", "edgecolor": "none"},
    )  # fmt: skip


def _along(found: SafetyMap) -> Figure:
    assert found.arc is not None
    figure = new_figure(9.0, 5.6)
    top, bottom = figure.subplots(2, 1, sharex=True)
    top.plot(found.arc, found.safe_speed, color=BLUE, linewidth=2)
    top.axhline(found.two_body, color=BLACK, linewidth=1.1, linestyle=(0, (1, 2)))
    top.annotate(
        "two-body formula", (found.arc[-1], found.two_body), xytext=(0, 4), ha="right",
        textcoords="offset points", fontsize=SMALL,
    )  # fmt: skip
    k = found.slowest
    top.plot(found.arc[k], found.safe_speed[k], "X", color=LIMIT, markersize=10)
    top.set_ylabel("largest safe speed [m/s]", fontsize=SMALL)
    top.set_ylim(0, 1.12 * max(found.two_body, float(np.nanmax(found.safe_speed))))
    bottom.plot(found.arc, found.peak, color=BLUE, linewidth=2)
    limit = limits_of(found.body.region, found.body.clamped).transient.force
    bottom.axhline(limit, color=LIMIT, linestyle="--", linewidth=1.5)
    bottom.annotate(
        f"limit {limit:.0f} N", (found.arc[0], limit), xytext=(2, 4), color=LIMIT,
        textcoords="offset points", fontsize=SMALL,
    )  # fmt: skip
    bottom.set_ylabel(f"peak at {found.speed:g} m/s [N]", fontsize=SMALL)
    bottom.set_ylim(0, 1.12 * max(limit, float(np.nanmax(found.peak))))
    bottom.set_xlabel("way along the self-motion from where it begins [rad]", fontsize=SMALL)
    for axes in (top, bottom):
        tidy(axes)
        axes.axvline(found.arc[found.begun], color=LIGHT, linewidth=1, zorder=0)
    return figure
