# SPDX-License-Identifier: BSD-3-Clause
"""A folder of results, which the next run of the same command replaces, and runs that fill it."""

from __future__ import annotations

import errno
import json
import os
from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import contextmanager
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

from softimpact.codegen import ForeignFolder
from softimpact.codegen.package import folder as place

from .printed import print_warnings, say_beside

if TYPE_CHECKING:
    from softimpact.optimize.running.execution import Execution

RESULTS = "results.json"


@contextmanager
def replaced_folder(folder: Path, generator: str) -> Iterator[Path]:
    """Give a fresh folder to fill; on success it takes the place of an older one.

    Args:
        folder: where the results belong; of a link, the folder that it leads to is replaced.
        generator: that marks the results of earlier runs.

    Raises:
        ForeignFolder: it holds what an earlier run of the same command did not write.
        FolderNotWritable: the operating system refuses.
    """
    with place.replaced(folder.resolve(), partial(_require_own, generator)) as fresh:
        yield fresh


@contextmanager
def running(how: Execution, folder: Path) -> Iterator[Executor]:
    """Return the executor for a ``with`` block, its journal beside the folder of results.

    Args:
        how: to run.
        folder: of the results.
    """
    from softimpact.optimize.running.execution import executing

    journal = folder.resolve().parent / f"{folder.resolve().name}.journal.jsonl"
    if journal.exists() and not how.resume:
        print_warnings([f"{journal}: results of a run that was ended; --resume would use them"])
    try:
        with executing(how, journal) as pool:
            if how.resume:
                print_warnings([f"{pool.known} results of an earlier run are used again"])
            yield pool
    except KeyboardInterrupt:
        if journal.exists():
            say_beside(f"{journal}: what was found so far; the same command with --resume goes on")
        raise


def require_replaceable_results(folder: Path, generator: str) -> None:
    """Raise ForeignFolder or FolderNotWritable if results could not be written."""
    place.require_replaceable(folder.resolve(), partial(_require_own, generator))


def require_folder_of(file: Path | None) -> None:
    """Raise FileNotFoundError before a long search if a file could not be written after it."""
    if file is not None and not file.parent.is_dir():
        raise FileNotFoundError(errno.ENOENT, os.strerror(errno.ENOENT), str(file))


def _require_own(generator: str, folder: Path) -> None:
    if folder.exists() and not folder.is_dir():
        raise ForeignFolder(folder, "no results")
    if folder.exists() and any(folder.iterdir()) and not _is_ours(folder, generator):
        raise ForeignFolder(folder, f"no earlier results of '{generator}'")


def _is_ours(folder: Path, generator: str) -> bool:
    try:
        record = json.loads((folder / RESULTS).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return False
    return isinstance(record, dict) and record.get("generator") == generator
