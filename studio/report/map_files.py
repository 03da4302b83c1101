# SPDX-License-Identifier: BSD-3-Clause
"""What ``softimpact map`` leaves behind: a record, a table, a figure."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import numpy as np

from softimpact.symbolic.record import plain

from ..design.report import versions
from ..figures.safety_map import map_figure
from ..map.safety_map import SafetyMap
from ..output.printed import folded, print_table, say, write_json
from ..output.results_folder import RESULTS

GENERATOR = "softimpact map"


def map_record(found: SafetyMap) -> dict[str, Any]:
    """Return everything that a map depends on, and the map, an entry a posture."""
    model, robot = found.model, found.model.robot
    springs = np.array(model.drives.springs, dtype=float).ravel()
    return {
        "generator": GENERATOR,
        "versions": versions(),
        "arm": found.arm,
        "robot": robot.name,
        "robot_digest": robot.digest(),
        "joints": robot.joint_names,
        "tip": model.tip,
        "over": found.over,
        "plane": None if found.axes is None else "".join("xyz"[k] for k in found.axes),
        "hold": found.hold,
        "joint_stiffness": [
            float(k) if gives else None
            for k, gives in zip(springs, model.drives.elastic, strict=True)
        ],
        "rotor_inertia": model.drives.rotors,
        "motors": found.ends,
        "region": found.body.region.name,
        "clamped": found.body.clamped,
        "cover": found.body.cover,
        "horizon": found.horizon,
        "speed": found.speed,
        "asked_direction": found.asked,
        "begun": found.begun,
        "slowest": moment(found, found.slowest),
        "iso_safe_speed": found.two_body,
        "grid": None if found.grid is None else {"u": found.grid[0], "v": found.grid[1]},
        "cells": found.cells,
        "arc": found.arc,
        "place": found.place,
        "q": found.postures,
        "safe_speed": found.safe_speed,
        "limit": [word or None for word in found.limit],
        "motors_at_limit": [word or None for word in found.motors],
        "peak": found.peak,
        "direction": found.direction,
        "warnings": found.warnings,
    }


def moment(found: SafetyMap, k: int) -> dict[str, Any]:
    """Return one posture's entry."""
    return {
        "place": found.place[k],
        "arc": None if found.arc is None else found.arc[k],
        "q": found.postures[k],
        "direction": found.direction[k],
        "safe_speed": found.safe_speed[k],
        "limit": str(found.limit[k]) or None,
        "motors": str(found.motors[k]) or None,
        "peak": found.peak[k],
    }


def write_map(found: SafetyMap, record: dict[str, Any], folder: Path) -> None:
    """Write a map's results: ``results.json``, ``map.csv`` and ``map.png``."""
    write_json(folder / RESULTS, record)
    map_figure(found, folder / "map.png")
    names = found.model.robot.joint_names
    header = ["x", "y", "z", *(["arc"] if found.arc is not None else []), "safe_speed", "limit"]
    header += ["motors", "peak", "direction_x", "direction_y", "direction_z"]
    header += [f"q_{name}" for name in names]
    with (folder / "map.csv").open("w", newline="", encoding="utf-8") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(header)
        for k in range(len(found.postures)):
            arc = [] if found.arc is None else [found.arc[k]]
            row = [*found.place[k], *arc, found.safe_speed[k], found.limit[k], found.motors[k]]
            row += [found.peak[k], *found.direction[k], *found.postures[k]]
            table.writerow([_cell(value) for value in row])


def _cell(value: Any) -> Any:
    value = plain(value)
    if value is None:
        return ""
    return f"{value:.9g}" if isinstance(value, float) else value


def print_map(found: SafetyMap, out: Path) -> None:
    """Print the slowest, the middle and the fastest posture as a table."""
    order = np.argsort(np.where(np.isnan(found.safe_speed), np.inf, found.safe_speed))
    order = order[: int(np.isfinite(found.safe_speed).sum())]
    chosen = {"slowest": order[0], "middle": order[len(order) // 2], "fastest": order[-1]}
    ground = "plane" if found.over == "plane" else "self-motion"
    print_table(
        f"{found.model.robot.name} against the {found.body.region.title.lower()}: "
        f"{len(order)} postures of a {ground}; the two-body formula allows "
        f"{found.two_body:.3g} m/s everywhere",
        ("", "place", "direction", "safe m/s", "limit", "motors", f"N at\n{found.speed:g} m/s"),
        [
            (
                name,
                folded(_listed(found.place[k])),
                folded(_listed(found.direction[k])),
                float(found.safe_speed[k]),
                folded(str(found.limit[k])),
                str(found.motors[k]),
                float(found.peak[k]),
            )
            for name, k in chosen.items()
        ],
    )
    say(f"wrote {out}")


def _listed(vector: Any) -> str:
    return ", ".join(f"{x + 0.0:.2f}" for x in vector)
