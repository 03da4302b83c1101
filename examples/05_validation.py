# SPDX-License-Identifier: BSD-3-Clause
"""Impacts that others measured, and what is foretold of them: docs/validation.md's numbers."""

from pathlib import Path

import numpy as np

from softimpact.papers.measurements.figures import device_figure, wall_figure
from softimpact.papers.measurements.foretold import Servo, foretold, two_body_force
from softimpact.papers.measurements.setups import SVARNY
from softimpact.papers.measurements.wall import apparent_masses
from softimpact.symbolic import Motors

IMAGES = Path(__file__).resolve().parents[1] / "docs/images"

TIMES = tuple(0.005 * k for k in range(11))

OTHERS = {
    "servo, 30 rad/s, 20 ms": (Motors("servo", 0.02), Servo(30)),
    "servo, 100 rad/s, 20 ms": (Motors("servo", 0.02), Servo(100)),
    "servo, 100 rad/s, 50 ms": (Motors("servo", 0.05), Servo(100)),
    "driven, 20 ms, then stop in 100 ms": (Motors("driven", 0.02, "stop"), None),
}

WALLS = (
    "soft contact, soft joints",
    "soft contact, stiff joints",
    "stiff contact, soft joints",
    "stiff contact, stiff joints",
)


def motors(time: float) -> Motors:
    """Return motors that drive on for a time, or that are free from the first touch on."""
    return Motors("driven", time) if time else Motors("free")


def main() -> None:
    """Print the tables and write the figures."""
    found = {m: [foretold(m, motors(t)) for t in TIMES] for m in SVARNY}
    for measured, bands in found.items():
        print(f"{measured.title}: measured {measured.force:g} N")
        print(f"  two-body formula: {two_body_force(measured):.0f} N")
        for time, band in zip(TIMES, bands, strict=True):
            print(f"  {1e3 * time:3.0f} ms: {band.low:4.0f} {band.middle:4.0f} {band.high:4.0f}")
        for name, (what, servo) in OTHERS.items():
            band = foretold(measured, what, servo)
            print(f"  {name}: {band.low:4.0f} {band.middle:4.0f} {band.high:4.0f}")
    device_figure(
        found,
        TIMES,
        "Free motors foretell too little for the UR10e; where motors drive on for 20 to 40 ms,\n"
        "all three measured forces lie in the band",
        IMAGES / "validation_device.png",
    )
    masses = apparent_masses()
    share = {"links": masses.links, **masses.rotors}
    share |= {f"{name}, free": m for name, m in zip(WALLS, masses.free, strict=True)}
    share |= {f"{name}, driven": m for name, m in zip(WALLS, masses.driven, strict=True)}
    print("Panda on a wall, apparent mass over that of the composite body")
    for name, mass in share.items():
        low, middle, high = np.percentile(mass / masses.composite, [2.5, 50, 97.5])
        print(f"  {name}: {low:.2f} {middle:.2f} {high:.2f}")
    for i, name in enumerate(WALLS):
        inside = (masses.free[i] <= masses.composite) & (masses.composite <= masses.driven[i])
        print(f"  {name}: composite body between free and driven in {inside.mean():.0%}")
    wall_figure(
        masses,
        WALLS,
        "The Panda's links alone are too light for what was measured on a rigid wall;\n"
        "stiff joints and motors that drive on reach it, and pass it",
        IMAGES / "validation_wall.png",
    )


if __name__ == "__main__":
    main()
