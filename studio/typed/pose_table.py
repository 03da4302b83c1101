# SPDX-License-Identifier: BSD-3-Clause
"""Candidate poses for a package, from a study or a JSON file."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

from softimpact.robots import study_path
from softimpact.symbolic import InvalidValue, Robot
from softimpact.symbolic.file_section import why_unreadable


def pose_table(path: Path, robot: Robot) -> dict[str, Sequence[float]]:
    """Return poses by name.

    Args:
        path: a study, whose poses are those that ``softimpact select`` ranks: turned back to its
            task and, with ``task.exact``, moved to hold the tip there exactly; else a JSON object
            of lists by name, or a list of lists.
        robot: to the contact point's frame.

    Raises:
        InvalidValue: what the file holds is neither, or it is another robot's study.
    """
    if study_path(path).suffix == ".toml":
        return _of_study(path, robot)
    try:
        found = json.loads(path.read_text(encoding="utf-8-sig"))
    except (OSError, ValueError) as error:
        raise InvalidValue(f"poses: {path}", why_unreadable(error)) from None
    if isinstance(found, list):
        found = {f"pose {i}": q for i, q in enumerate(found)}
    if not isinstance(found, dict) or not all(_is_numbers(q) for q in found.values()):
        raise InvalidValue("poses", f"{path} must hold a list of lists of numbers, or such by name")
    return found


def _is_numbers(q: object) -> bool:
    return isinstance(q, list) and all(
        isinstance(x, int | float) and not isinstance(x, bool) for x in q
    )


def _of_study(path: Path, robot: Robot) -> dict[str, Sequence[float]]:
    from softimpact.optimize import candidates, load_study

    study = load_study(path)
    if study.robot.joint_names != robot.joint_names:
        raise InvalidValue("poses", f"{path} is a study of '{study.robot.name}', or of another tip")
    return {candidate.pose.name: candidate.q.tolist() for candidate in candidates(study)}
