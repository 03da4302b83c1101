# SPDX-License-Identifier: BSD-3-Clause
"""What GIAF says of the Panda in words, and whether it is so: the paper prints no factor."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

from softimpact.papers.factor_study import FactorStudy
from softimpact.papers.factor_study.heavy_base import MASSES
from softimpact.papers.factor_study.poses import ANGLES, PoseFactors
from softimpact.symbolic.robot.rigid import Array

STUDY = "studies/panda_24_poses.toml"
"""The poses of Table I, in the folder of built-in robots."""

TIPS = ("hand_tcp", "flange")
"""The paper does not say whether the robot wears its hand."""

Holding = Literal["holds", "holds in part", "does not hold"]

WEAKEST = (4, 5)
"""Joints 5 and 6, whose single-joint GIAF is said to be the lowest."""

MITIGATED = 1e-6
"""Distance of ξ from one that counts as none."""


@dataclass(frozen=True)
class Statement:
    """A statement of the paper for one tip and one set of rotors.

    Attributes:
        source: figure or section.
        claim: in our words.
        tip: contact frame.
        rotors: name of the set, none of which the paper gives.
        verdict: whether it is so.
        ours: what was found.
    """

    source: str
    claim: str
    tip: str
    rotors: str
    verdict: Holding
    ours: str


def statements(found: FactorStudy) -> list[Statement]:
    """Return every statement, for every tip and set of rotors that a study covers."""
    lines = [
        Statement(source, claim, tip, rotors, verdict, ours)
        for (tip, rotors), factors in found.factors.items()
        for source, claim, verdict, ours in _of_poses(factors, found.names)
    ]
    return [*lines, *_of_fixed_bases(found)]


def _of_poses(
    factors: PoseFactors, names: tuple[str, ...]
) -> Iterator[tuple[str, str, Holding, str]]:
    least, most = int(factors.giaf.argmin()), int(factors.giaf.argmax())
    spread = 100 * (factors.giaf[most] / factors.giaf[least] - 1)
    yield (
        "Fig. 1",
        "poses that hold the same task absorb differently",
        _verdict(bool(spread > 1)),
        f"{factors.giaf[least]:.4f} ({names[least]}) to {factors.giaf[most]:.4f} ({names[most]}), "
        f"{spread:.0f} % apart",
    )
    for what, sweep in (
        ("reflected inertias", factors.inertia_sweep),
        ("gear ratios", factors.gear_sweep),
    ):
        yield (
            "Fig. 2",
            f"GIAF falls as {what} grow",
            _share(np.diff(sweep, axis=1).max(axis=1) < 0),
            f"mean {sweep[:, 0].mean():.3f} to {sweep[:, -1].mean():.3f} over the sweep",
        )
    single = factors.single_joint_giaf
    in_pose = np.array([set(row) == set(WEAKEST) for row in np.argsort(single, axis=1)[:, :2]])
    on_average = set(np.argsort(single.mean(axis=0))[:2]) == set(WEAKEST)
    yield (
        "Fig. 3",
        "joints 5 and 6 have the lowest single-joint GIAF",
        _share(in_pose) if on_average else "does not hold",
        f"in {in_pose.sum()} of {len(in_pose)} poses; means of 5 and 6: "
        + ", ".join(f"{single.mean(axis=0)[i]:.3f}" for i in WEAKEST),
    )
    for frame in ("tip", "base"):
        at_90, at_150 = (_at(factors.polar[f"{frame}_xy"], angle) for angle in (90, 150))
        yield (
            "Fig. 4",
            f"{names[0]} absorbs more at 150° of the xy plane than at 90°, {frame}'s axes",
            _verdict(at_150 > at_90),
            f"{at_150:.4f} against {at_90:.4f}",
        )


def _of_fixed_bases(found: FactorStudy) -> Iterator[Statement]:
    for rotors, heavy in found.heavy_base.items():
        off = float(heavy.not_mitigated[:, -1].max())
        yield Statement(
            "§II",
            "IMF says nothing of a fixed base, as ξ = 1 there in every pose",
            found.study.model.tip,
            rotors,
            _verdict(off < MITIGATED),
            f"1 - ξ at most {off:.1e} with a base of {MASSES[-1]:.0e} kg, falling as one over mass",
        )


def _at(curve: Array, degrees: float) -> float:
    return float(curve[np.argmin(abs(ANGLES - np.radians(degrees)))])


def _verdict(holds: bool) -> Holding:
    return "holds" if holds else "does not hold"


def _share(hold: Array) -> Holding:
    if hold.all():
        return "holds"
    return "holds in part" if hold.any() else "does not hold"
