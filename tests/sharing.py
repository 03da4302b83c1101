# SPDX-License-Identifier: BSD-3-Clause
"""What the processes of one test run make once and share, such as packages and libraries."""

from __future__ import annotations

import fcntl
import pickle
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TypeVar

Made = TypeVar("Made")


@contextmanager
def locked(path: Path) -> Iterator[None]:
    """Hold a lock that belongs to a path; other processes wait for it."""
    with path.with_name(f".{path.name}.lock").open("w") as file:
        fcntl.flock(file, fcntl.LOCK_EX)
        yield


def once(path: Path, make: Callable[[Path], Made]) -> Made:
    """Make a file or folder once, whichever process comes first.

    Args:
        path: of it, in the fixture ``shared_folder``.
        make: fills the path; what it returns is pickled for those that come later.
    """
    record = path.with_name(f".{path.name}.pickle")
    path.parent.mkdir(parents=True, exist_ok=True)
    with locked(path):
        if record.exists():
            made: Made = pickle.loads(record.read_bytes())
            return made
        made = make(path)
        record.write_bytes(pickle.dumps(made))
    return made
