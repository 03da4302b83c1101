# SPDX-License-Identifier: BSD-3-Clause
"""How far a program must slow down, over time, and what binds."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from softimpact.simulate.program import SafeProgram
from softimpact.simulate.trajectory import Trajectory

from .style import (
    BLACK,
    BLUE,
    GREEN,
    LIGHT,
    ORANGE,
    PURPLE,
    SKY,
    SMALL,
    TEXT,
    VERMILLION,
    new_figure,
    save,
    tidy,
)

COLOURS = (BLUE, ORANGE, GREEN, VERMILLION, PURPLE, SKY)
MARKS = ("o", "s", "^", "D", "v", "P")


def program_figure(motion: Trajectory, safe: SafeProgram, robot: str, path: Path) -> Path:
    """Draw the speed factor over time, marked by the point and region that bind.

    Args:
        motion: of the joints.
        safe: the program slowed down.
        robot: its name.
        path: of the PNG.
    """
    binding = [
        (worst[0].point, worst[0].region) if worst and factor < 1 else None
        for worst, factor in zip(safe.worst, safe.factor, strict=True)
    ]
    pairs = [*dict.fromkeys(pair for pair in binding if pair)]
    pairs.sort(key=lambda pair: -binding.count(pair))
    figure = new_figure(9, 4)
    axes = figure.subplots()
    axes.plot(motion.time, safe.two_body, color=BLACK, linewidth=1.1, linestyle=(0, (1, 2)))
    axes.plot(motion.time, safe.factor, color=LIGHT, linewidth=1.6)
    for i, (point, region) in enumerate(pairs):
        rows = np.array([pair == (point, region) for pair in binding])
        axes.plot(
            motion.time[rows],
            safe.factor[rows],
            MARKS[i % len(MARKS)],
            color=COLOURS[i % len(COLOURS)],
            markersize=4,
            label=f"{point} on {region}",
        )
    axes.plot([], [], color=BLACK, linewidth=1.1, linestyle=(0, (1, 2)), label="two-body formula")
    axes.set_ylim(0, 1.05)
    axes.set_xlim(motion.time[0], motion.time[-1])
    axes.set_xlabel("time in the program [s]", fontsize=SMALL)
    axes.set_ylabel("factor on the speed that keeps all limits", fontsize=SMALL)
    axes.legend(fontsize=SMALL, frameon=False, loc="lower right", bbox_to_anchor=(1, 1.0), ncols=3)
    tidy(axes)
    figure.suptitle(_message(safe, robot), fontsize=TEXT + 1)
    return save(figure, path)


def _message(safe: SafeProgram, robot: str) -> str:
    if not (safe.factor < 1).any():
        return f"{robot}: the program keeps all limits at its own speed, {safe.time_before:.3g} s"
    slow = float(safe.factor.min())
    return (
        f"{robot}: {safe.time_before:.3g} s become {safe.time_after:.3g} s, "
        f"as it must slow down to {slow:.0%} at worst"
    )
