# SPDX-License-Identifier: BSD-3-Clause
"""``softimpact inspect``: what a robot's file says, what of it counts, and what looks wrong."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from ..typed import options as o


def inspect(
    model: o.ModelArgument,
    tip: o.TipOption = None,
    json: o.JsonOption = False,
) -> None:
    """Print what a robot is: joints, masses, drives, frames, loops, and what is doubtful."""
    from ..output.printed import print_json, print_warnings
    from ..robot.inspection import inspected

    found = inspected(model, tip)
    print_warnings(found["warnings"])
    if json:
        print_json(found)
    else:
        _print_tables(found)


def _print_tables(found: Mapping[str, Any]) -> None:
    from ..output.printed import print_table

    entries = {name: str(i) for i, name in enumerate(found["q"], start=1)}
    print_table(
        f"{found['robot']}, {found['base']} base",
        ("quantity", "value", "unit"),
        [
            ("joints", str(len(found["joints"])), ""),
            ("contact frame", found["tip"], ""),
            ("reach of the contact frame, at most", found["reach"], "m"),
            ("moving mass", found["moving_mass"], "kg"),
            ("mass fixed to the base", found["base_mass"], "kg"),
        ],
    )
    print_table(
        "Joints (q: entry of --q that is the joint's; no: off the way to the contact frame)",
        ("joint", "kind", "on", "moves [kg]", "q"),
        [
            (j["name"], j["kind"], j["parent"] or "base", j["mass"], entries.get(j["name"], "no"))
            for j in found["joints"]
        ],
    )
    print_table(
        "Limits (rad, rad/s, N·m; or m, m/s, N)",
        ("joint", "lower", "upper", "speed", "torque", "motor"),
        [
            (
                joint["name"],
                joint["lower"],
                joint["upper"],
                joint["speed_limit"],
                joint["torque_limit"],
                "yes" if joint["motor"] else "no",
            )
            for joint in found["joints"]
        ],
    )
    print_table(
        "Drives, reflected to the joints (rad or m)",
        ("joint", "rotor", "spring", "damping", "friction", "K_p", "K_d"),
        [
            (
                joint["name"],
                joint["rotor_inertia"],
                joint["stiffness"],
                joint["damping"],
                joint["friction"],
                joint["position_gain"],
                joint["velocity_gain"],
            )
            for joint in found["joints"]
        ],
    )
    if found["constraints"]:
        print_table(
            "Loops and couplings",
            ("name", "kind", "what it ties"),
            [(c["name"], c["kind"], c["ties"]) for c in found["constraints"]],
        )
    print_table(
        "Frames",
        ("frame", "moved by"),
        [(f["name"], f["joint"] or "base") for f in found["frames"]],
    )
    print_table(
        "Mass matrix by others, largest difference over largest entry",
        ("library", "difference"),
        [
            (name, opinion if isinstance(opinion, str) else f"{opinion:.1e}")
            for name, opinion in found["second_opinions"].items()
        ],
    )
