# SPDX-License-Identifier: BSD-3-Clause
"""A factor study as plain data, for ``results.json``."""

from __future__ import annotations

from typing import Any

from softimpact.studio.design.report import versions

from .agreement import STIFFNESSES
from .heavy_base import MASSES
from .poses import ANGLES, RATIOS, SCALES
from .study import FactorStudy

GENERATOR = "softimpact factors-study"
"""Marks a folder of results as one that may be replaced."""


def factor_study_record(found: FactorStudy) -> dict[str, Any]:
    """Return a factor study as plain data."""
    study = found.study
    return {
        "generator": GENERATOR,
        "versions": versions(),
        "study": study.source,
        "robot": study.robot.name,
        "robot_digest": study.robot.digest(),
        "joints": study.robot.joint_names,
        "direction": study.direction,
        "speed": study.speed,
        "joint_stiffness": study.nominal,
        "tips": found.tips,
        "rotor_inertia_sets": found.rotor_sets,
        "inertia_scales": SCALES,
        "gear_scales": RATIOS,
        "polar_angles": ANGLES,
        "poses": [
            {"name": name, "q": q, "arc": found.curve.arc[found.curve.nearest(q)]}
            for name, q in zip(found.names, found.poses, strict=True)
        ],
        "factors": [
            {"tip": tip, "rotors": name, **vars(factors)}
            for (tip, name), factors in found.factors.items()
        ],
        "self_motion": {
            "q": found.curve.q,
            "arc": found.curve.arc,
            "closed": found.curve.closed,
            "figures": [
                {"tip": tip, "rotors": name, **vars(along)}
                for (tip, name), along in found.along.items()
            ],
        },
        "floating_base": {
            "mass": MASSES,
            "rotors": {name: vars(heavy) for name, heavy in found.heavy_base.items()},
        },
        "agreement": {
            "joint_stiffness": STIFFNESSES,
            "peak_definition": "first_contact",
            "cases": [vars(agreement) for agreement in found.agreements],
        },
    }
