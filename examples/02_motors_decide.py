# SPDX-License-Identifier: BSD-3-Clause
"""What the motors do until someone notices decides the force: the picture of the README.

python examples/02_motors_decide.py [FILE]
"""

from __future__ import annotations

import sys
from pathlib import Path

from softimpact import Approach, Contact, Motors, body_region, drives, impact_model, load_robot
from softimpact.simulate import ImpactHistory, simulate_impact
from softimpact.studio.figures.style import BLUE, LIMIT, ORANGE, SMALL, TEXT, new_figure, save, tidy

Q, ALONG_Y = [-1.22, 0.84, 0.72, -2.41, 0.79, 1.97, -2.04], [0.0, 1.0, 0.0]
SPEED = 0.5
CHEST = Contact(body_region("chest"))
ENDS = (
    ("motors free from first touch on", Motors("free"), ORANGE, "-"),
    ("they drive on for 20 ms", Motors("driven", 0.02), BLUE, "--"),
    ("they drive on for 50 ms", Motors("driven", 0.05), BLUE, "-"),
)
SPRINGS = (("rigid joints", None), ("springs of 10,000 N·m/rad in all joints", 1e4))


def impact(stiffness: float | None, motors: Motors) -> ImpactHistory:
    """Simulate one impact of the Panda's hand on a chest that is held."""
    panda = load_robot("panda")
    model = impact_model(panda, drives=drives(panda, stiffness))
    return simulate_impact(model, Approach(Q, ALONG_Y, SPEED), CHEST, motors=motors)


def main(path: Path) -> None:
    """Draw the picture."""
    figure = new_figure(10.0, 4.4)
    pair = figure.subplots(1, 2, sharey=True)
    for axes, (title, stiffness) in zip(pair, SPRINGS, strict=True):
        for words, motors, colour, style in ENDS:
            found = impact(stiffness, motors)
            axes.plot(
                1e3 * found.time,
                found.force,
                color=colour,
                linestyle=style,
                linewidth=2,
                label=f"{words}: {found.peak:.0f} N",
            )
        axes.legend(loc="upper left", fontsize=SMALL, frameon=False)
        limit = CHEST.region.force_limit
        axes.axhline(limit, color=LIMIT, linestyle=":", linewidth=1.5)
        axes.annotate(f"limit {limit:g} N", (99, limit), ha="right", va="bottom", color=LIMIT)
        axes.set_title(title, fontsize=TEXT)
        axes.set_xlim(0, 100)
        axes.set_ylim(0, 850)
        axes.set_xlabel("time since first touch [ms]", fontsize=TEXT)
        tidy(axes)
    pair[0].set_ylabel("contact force [N]", fontsize=TEXT)
    figure.suptitle(
        f"What the motors do decides the force: Panda on a chest (held) at {SPEED} m/s",
        fontsize=TEXT + 2,
    )
    save(figure, path)


if __name__ == "__main__":
    main(Path(sys.argv[1] if len(sys.argv) > 1 else "motors.png"))
