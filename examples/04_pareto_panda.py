# SPDX-License-Identifier: BSD-3-Clause
"""What accuracy costs the Panda in force: the least peak force by the deflection allowed."""

from dataclasses import replace

from softimpact.optimize import load_study, pareto_fronts
from softimpact.robots import FOLDER


def main() -> None:
    overrides = {"pareto": {"points": 4, "lower": 2e-4}}
    study = load_study(FOLDER / "studies/panda_24_poses.toml", overrides)
    found = pareto_fronts(replace(study, poses=study.poses[8::5]))
    for point in found.free.points:
        print(f"{1e3 * point.deflection:5.2f} mm under 30 N: {point.force:5.1f} N on the chest")
    before = found.reference
    print(f"{1e3 * before.deflection:5.2f} mm under 30 N: {before.force:5.1f} N before the design")


if __name__ == "__main__":  # the processes that search import this file too
    main()
