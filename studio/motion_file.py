# SPDX-License-Identifier: BSD-3-Clause
"""Motions as CSV files: a column ``t`` [s] and one for each joint [rad, m]."""

from __future__ import annotations

import csv
import io
from pathlib import Path

import numpy as np

from softimpact.simulate.trajectory import Trajectory, trajectory
from softimpact.symbolic import Robot, SoftImpactError
from softimpact.symbolic.robot.rigid import Array

DELIMITERS = ",;\t"
"""Any of these may part the columns."""

BEYOND = 1e-6
"""By which an angle may be past its limit without a word [rad, m]."""


class MotionFileError(SoftImpactError):
    """A file is no motion of a robot."""

    def __init__(self, path: Path, reason: str) -> None:
        super().__init__(f"{path}: {reason}")
        self.path, self.reason = path, reason


def read_motion(
    path: Path, robot: Robot, also: tuple[str, ...] = ()
) -> tuple[Trajectory, list[str]]:
    """Read a motion.

    Args:
        path: of a CSV file.
        robot: whose joints the columns are, in any order.
        also: names of joints whose columns may be there, but do not count.

    Returns:
        The motion, and what of it a user should know.

    Raises:
        MotionFileError: the file cannot be read, columns are missing or unknown, or angles look
            like degrees.
        InvalidValue: times that do not rise, numbers that are not finite, or too few samples.
        OSError: there is no such file.
    """
    text = _text(path)
    header, _, body = text.partition("\n")
    delimiter = max(DELIMITERS, key=header.count)
    columns = [name.strip() for name in next(csv.reader([header], delimiter=delimiter), [])]
    _check_columns(path, columns, robot.joint_names, also)
    if not body.strip():
        raise MotionFileError(path, "holds no samples below its first line")
    table = _numbers(path, body, delimiter, len(columns))
    order = [columns.index(name) for name in robot.joint_names]
    found = trajectory(table[:, columns.index("t")], table[:, order])
    idle = [name for name in columns if name in also]
    warnings = [f"column '{name}' is of no joint of the arm and does not count" for name in idle]
    return found, warnings + limits_left(path, found, robot)


def _text(path: Path) -> str:
    try:
        return path.read_bytes().decode("utf-8-sig").replace("\r\n", "\n").lstrip("\n")
    except UnicodeDecodeError:
        raise MotionFileError(path, "is not a text file in UTF-8") from None


def _check_columns(
    path: Path, columns: list[str], joints: tuple[str, ...], also: tuple[str, ...]
) -> None:
    expected = f"needs the columns t, {', '.join(joints)}"
    if "t" not in columns:
        raise MotionFileError(path, f"has no column 't' in its first line; {expected}")
    twice = [name for name in columns if columns.count(name) > 1]
    if twice:
        raise MotionFileError(path, f"has two columns '{twice[0]}'")
    missing = [name for name in joints if name not in columns]
    if missing:
        raise MotionFileError(path, f"has no column for joint {_listed(missing)}; {expected}")
    unknown = [name for name in columns if name not in ("t", *joints, *also)]
    if unknown:
        raise MotionFileError(path, f"has unknown columns {_listed(unknown)}; {expected}")


def _listed(names: list[str]) -> str:
    return ", ".join(f"'{name}'" for name in names)


def _numbers(path: Path, body: str, delimiter: str, columns: int) -> Array:
    try:
        table = np.loadtxt(io.StringIO(body), delimiter=delimiter, ndmin=2, comments="#")
    except ValueError as error:
        reason = str(error).split(";")[0].rstrip(".")
        raise MotionFileError(path, f"below its first line: {reason}") from None
    if table.shape[1] != columns:
        reason = f"has {columns} names in its first line, but {table.shape[1]} numbers below"
        raise MotionFileError(path, reason)
    return np.asarray(table)


def limits_left(path: Path, found: Trajectory, robot: Robot) -> list[str]:
    """Return warnings about angles past their limits; raise MotionFileError if they are degrees."""
    lower, upper = robot.limits
    low, high = found.q.min(axis=0), found.q.max(axis=0)
    past = (low < lower - BEYOND) | (high > upper + BEYOND)
    far = np.maximum(abs(low), abs(high)) > 4 * np.pi
    hinges = np.array([joint.kind.value == "hinge" for joint in robot.joints])
    if (past & far & hinges).any():
        name = robot.joint_names[int(np.argmax(past & far & hinges))]
        raise MotionFileError(
            path,
            f"joint '{name}' goes far beyond its limits: angles are to be in radians, and look "
            "like degrees",
        )
    return [
        f"joint '{robot.joint_names[i]}' goes from {low[i]:.4g} to {high[i]:.4g}, beyond its "
        f"limits {lower[i]:.4g} and {upper[i]:.4g}"
        for i in np.flatnonzero(past)
    ]
