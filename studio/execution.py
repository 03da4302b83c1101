# SPDX-License-Identifier: BSD-3-Clause
"""Where a command's searches run, and what an earlier run of it left."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from pathlib import Path

from softimpact.optimize.execution import Execution, executing

from .output import print_warnings


@contextmanager
def running(how: Execution, folder: Path) -> Iterator[Executor]:
    """Return the executor for a ``with`` block, its journal beside the folder of results.

    Args:
        how: to run.
        folder: of the results.
    """
    journal = folder.resolve().parent / f"{folder.resolve().name}.journal.jsonl"
    if journal.exists() and not how.resume:
        print_warnings([f"{journal}: results of a run that was ended; --resume would use them"])
    with executing(how, journal) as pool:
        if how.resume:
            print_warnings([f"{pool.known} results of an earlier run are used again"])
        yield pool
