# SPDX-License-Identifier: BSD-3-Clause
"""Motions as CSV files: a column ``t`` [s] and one for each joint [rad, m]."""

from __future__ import annotations

import csv
import re
import warnings
from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import numpy as np

from softimpact.simulate.trajectory import Trajectory, trajectory
from softimpact.symbolic import Robot, SoftImpactError
from softimpact.symbolic.robot.rigid import Array

ROWS = 20_000
"""Samples that are read at once."""

DELIMITERS = ",;\t"
"""Any of these may part the columns."""

BEYOND = 1e-6
"""By which an angle may be past its limit without a word [rad, m]."""


class MotionFileError(SoftImpactError):
    """A file is no motion of a robot."""

    def __init__(self, path: Path, reason: str) -> None:
        super().__init__(f"{path}: {reason}")
        self.path, self.reason = path, reason


@dataclass(frozen=True)
class MotionTable:
    """A CSV file of a motion whose first line was read.

    Attributes:
        path: of the file.
        delimiter: between its columns.
        columns: their names.
        joints: names of the arm's joints, in its order.
        idle: names of columns that do not count.
    """

    path: Path
    delimiter: str
    columns: tuple[str, ...]
    joints: tuple[str, ...]
    idle: tuple[str, ...]

    def chunks(self, rows: int) -> Iterator[tuple[Trajectory, float]]:
        """Yield the motion in parts of some samples, unchecked, and the share of it that was read.

        Raises:
            MotionFileError: something that is no table of numbers, or nothing at all.
        """
        size, seen, first = max(self.path.stat().st_size, 1), 0, 1
        order = [self.columns.index(name) for name in self.joints]
        with self.path.open(encoding="utf-8-sig", newline=None) as file:
            _header(file)
            while lines := self._lines(file, rows):
                seen += sum(map(len, lines))
                table = self._numbers(lines, first)
                first += len(lines)
                if len(table):
                    yield (
                        Trajectory(table[:, self.columns.index("t")], table[:, order]),
                        min(seen / size, 1.0),
                    )
        if first == 1:
            raise MotionFileError(self.path, "holds no samples below its first line")

    def _lines(self, file: Iterator[str], rows: int) -> list[str]:
        """Return some of the next lines, none at the end."""
        try:
            lines = list(islice(file, rows))
        except UnicodeDecodeError:
            raise MotionFileError(self.path, NO_TEXT) from None
        return lines if any(line.strip() for line in lines) else []

    def _numbers(self, lines: list[str], first: int) -> Array:
        """Return a table; ``first`` is the number of its first line below the names."""
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", UserWarning)  # of comments only
                table = np.loadtxt(lines, delimiter=self.delimiter, ndmin=2, comments="#")
        except ValueError as error:
            reason = str(error).split(";")[0].rstrip(".")
            if self.delimiter != "," and re.search(r"'[-\d]*,\d*'", reason):
                reason += "; decimals need a point, not a comma"
            skipped = first if "columns changed" in reason else first + 1  # NumPy counts both ways
            reason = re.sub(r"at row (\d+)", lambda m: f"in line {int(m[1]) + skipped}", reason)
            raise MotionFileError(self.path, f"below its first line: {reason}") from None
        if table.size and table.shape[1] != len(self.columns):
            names, numbers = len(self.columns), table.shape[1]
            reason = f"has {names} names in its first line, but {numbers} numbers below"
            raise MotionFileError(self.path, reason)
        return np.asarray(table)


def open_motion(path: Path, robot: Robot, also: tuple[str, ...] = ()) -> MotionTable:
    """Read the first line of a motion; arguments and errors as ``read_motion``."""
    try:
        with path.open(encoding="utf-8-sig", newline=None) as file:
            header = _header(file)
    except UnicodeDecodeError:
        raise MotionFileError(path, NO_TEXT) from None
    delimiter = max(DELIMITERS, key=header.count)
    columns = [name.strip() for name in next(csv.reader([header], delimiter=delimiter), [])]
    _check_columns(path, columns, robot.joint_names, also)
    idle = tuple(name for name in columns if name in also)
    return MotionTable(path, delimiter, tuple(columns), robot.joint_names, idle)


NO_TEXT = "is not a text file in UTF-8"


def read_motion(
    path: Path, robot: Robot, also: tuple[str, ...] = ()
) -> tuple[Trajectory, list[str]]:
    """Read a whole motion.

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
    table = open_motion(path, robot, also)
    parts = [part for part, _ in table.chunks(ROWS)]
    whole = trajectory(
        np.concatenate([part.time for part in parts]), np.vstack([part.q for part in parts])
    )
    return whole, idle_columns(table.idle) + limits_left(path, whole.q, robot)


def idle_columns(names: tuple[str, ...]) -> list[str]:
    """Return a line for each column that does not count."""
    return [f"column '{name}' is of no joint of the arm and does not count" for name in names]


def _header(file: Iterator[str]) -> str:
    """Return the first line that holds something, and leave the file at the next."""
    return next((line.strip("\n") for line in file if line.strip()), "")


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


def limits_left(path: Path, q: Array, robot: Robot) -> list[str]:
    """Return warnings about angles past their limits; raise MotionFileError if they are degrees.

    Args:
        path: of the file.
        q: of the joints, S×n, or the least and the largest of them.
        robot: whose joints they are.
    """
    lower, upper = robot.limits
    low, high = q.min(axis=0), q.max(axis=0)
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
