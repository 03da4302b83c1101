# SPDX-License-Identifier: BSD-3-Clause
"""What is known of a program that was slowed down, for machines and as a table."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from softimpact.simulate.program import Danger, SafeProgram, worst_moments
from softimpact.simulate.trajectory import Trajectory
from softimpact.symbolic import ImpactModel, Motors

from .output import print_table, say

GENERATOR = "softimpact program"


@dataclass(frozen=True, eq=False)
class ProgramResult:
    """A program that was looked at.

    Attributes:
        motion: of the joints.
        dangers: of each point and region.
        safe: the program slowed down.
        record: for machines.
    """

    motion: Trajectory
    dangers: Sequence[Danger]
    safe: SafeProgram
    record: dict[str, Any]


def program_record(
    path: Path,
    clamped: bool,
    model: ImpactModel,
    motion: Trajectory,
    points: Sequence[str],
    ends: dict[str, Motors],
    horizon: float,
    dangers: Sequence[Danger],
    safe: SafeProgram,
    warnings: list[str],
) -> dict[str, Any]:
    """Return everything that an answer depends on, and the answer."""
    springs = np.array(model.drives.springs, dtype=float).ravel()
    return {
        "generator": GENERATOR,
        "motion": path,
        "robot": model.robot.name,
        "joints": model.robot.joint_names,
        "points": points,
        "regions": [*dict.fromkeys(danger.region for danger in dangers)],
        "clamped": clamped,
        "motors": ends,
        "horizon": horizon,
        "joint_stiffness": [
            float(k) if gives else None
            for k, gives in zip(springs, model.drives.elastic, strict=True)
        ],
        "rotor_inertia": model.drives.rotors,
        "time": motion.time,
        "factor": safe.factor,
        "binding": [
            moment_of(motion, safe, k) if factor < 1 else None
            for k, factor in enumerate(safe.factor)
        ],
        "time_before": safe.time_before,
        "time_after": safe.time_after,
        "worst": [
            {**(moment_of(motion, safe, k) or {}), "q": motion.q[k]}
            for k in worst_moments(motion, safe)
        ],
        "iso": {"factor": safe.two_body, "time_after": safe.time_by_formula},
        "warnings": warnings,
    }


def moment_of(motion: Trajectory, safe: SafeProgram, sample: int) -> dict[str, Any] | None:
    """Return what is worst at a sample, None where nothing moves."""
    worst = safe.worst[sample]
    if worst is None:
        return None
    danger, row = worst
    return {
        "sample": sample,
        "t": motion.time[sample],
        "factor": safe.factor[sample],
        "point": danger.point,
        "region": danger.region,
        "limit": str(danger.limit[row]),
        "motors": str(danger.motors[row]),
        "speed": danger.speed[row],
        "direction": danger.direction[row],
        "safe_speed": danger.safe_speed[row],
        "peak": danger.peak[row],
        "share_of_limit": danger.share[row],
        "iso_safe_speed": danger.two_body,
    }


COLUMNS = ("worst at", "factor", "point", "region", "limit", "motors", "m/s", "safe m/s", "N")


def print_program(found: ProgramResult, out: Path | None) -> None:
    """Print what limits a program as a table."""
    safe, record = found.safe, found.record
    longer = safe.time_after / safe.time_before - 1
    slowed = int((safe.factor < 1).sum())
    bands = {"band N": None} if any("band" in moment for moment in record["worst"]) else {}
    print_table(
        f"{record['robot']}: {safe.time_before:.4g} s become {safe.time_after:.4g} s "
        f"(+{100 * longer:.3g} %; by the two-body formula {safe.time_by_formula:.4g} s); "
        f"{slowed} of {len(safe.factor)} samples slow down",
        (*COLUMNS, *bands),
        [
            (
                f"{moment['t']:.4g} s",
                moment["factor"],
                moment["point"],
                moment["region"],
                moment["limit"],
                moment["motors"],
                moment["speed"],
                moment["safe_speed"] if np.isfinite(moment["safe_speed"]) else None,
                moment["peak"],
                *(f"{moment['band'].low:.0f} to {moment['band'].high:.0f}" for _ in bands),
            )
            for moment in record["worst"]
        ],
    )
    if out is not None:
        say(f"wrote {out}")
