# SPDX-License-Identifier: BSD-3-Clause
"""What accuracy costs the Panda in force: the least peak force by the deflection allowed."""

from softimpact.optimize import load_study, pareto_fronts
from softimpact.robots import FOLDER


def main() -> None:
    few = {"pareto": {"points": 4, "lower": 2e-4}}
    study = load_study(FOLDER / "studies/panda_24_poses.toml", few)
    found = pareto_fronts(study)
    print(f"{study.contact.region.title}, {study.speed:g} m/s; deflection under 30 N, peak force")
    for point in found.free.points:
        print(f"{1e3 * point.deflection:7.2f} mm {point.force:7.1f} N")
    before = found.reference
    print(f"{1e3 * before.deflection:7.2f} mm {before.force:7.1f} N before the design")


if __name__ == "__main__":  # searches run in processes of their own, which import this file
    main()
