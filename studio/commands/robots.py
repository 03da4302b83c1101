# SPDX-License-Identifier: BSD-3-Clause
"""``softimpact robots``: the built-in robots."""

from __future__ import annotations

from ..typed.options import JsonOption


def robots(json: JsonOption = False) -> None:
    """List the built-in robots and studies; robots' frames are in --json."""
    from softimpact.robots import built_in_robots, built_in_studies
    from softimpact.symbolic import load_robot

    from ..output.printed import print_json, print_table

    found = {name: (load_robot(name), path) for name, path in built_in_robots().items()}
    entries = [
        {
            "name": name,
            "joints": robot.joint_names,
            "tip": robot.tip,
            "frames": tuple(robot.frames),
            "rotor_inertia_sets": dict(robot.rotor_inertia_sets),
            "source": path,
        }
        for name, (robot, path) in found.items()
    ]
    if json:
        print_json({"robots": entries, "studies": built_in_studies()})
        return
    print_table(
        "Built-in robots",
        ("name", "joints", "tip", "rotor inertia sets", "source"),
        [
            (
                name,
                str(robot.n),
                robot.tip,
                "\n".join(robot.rotor_inertia_sets) or "none",
                path.name,
            )
            for name, (robot, path) in found.items()
        ],
    )
    print_table("Built-in studies", ("name",), [(name,) for name in built_in_studies()])
