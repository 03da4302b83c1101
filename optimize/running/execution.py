# SPDX-License-Identifier: BSD-3-Clause
"""Where a long search runs, and where its results go meanwhile."""

from __future__ import annotations

from collections.abc import Iterator
from concurrent.futures import Executor
from contextlib import ExitStack, contextmanager
from dataclasses import dataclass
from pathlib import Path

from softimpact.symbolic import InvalidValue

from .cluster import cluster
from .journal import Journal
from .workers import cores, workers


@dataclass(frozen=True)
class Execution:
    """What a command line asks.

    Attributes:
        processes: how many work here; None: one for each core.
        address: of a Dask scheduler whose workers work instead; None: none.
        resume: whether results of a run that was ended are used.
    """

    processes: int | None = None
    address: str | None = None
    resume: bool = False

    def __post_init__(self) -> None:
        if self.processes is not None and self.processes < 1:
            raise InvalidValue("--workers", f"must be at least 1, not {self.processes}")
        if self.processes is not None and self.address is not None:
            raise InvalidValue("--workers", "excludes --dask, whose workers are the cluster's")


@contextmanager
def executing(how: Execution, journal: Path) -> Iterator[Journal]:
    """Return the executor for a ``with`` block; a run that ends well leaves no journal behind.

    Nor does one that found nothing. Results should be written within the block.

    Args:
        how: to run.
        journal: file to which results go.

    Raises:
        InvalidValue, ClusterSilent: as ``cluster``; the journal cannot be used.
        WorkerLost: a worker process ended before its job.
    """
    with ExitStack() as stack:
        inner: Executor
        if how.address is not None:
            inner = stack.enter_context(cluster(how.address))
        else:
            inner = stack.enter_context(workers(how.processes or cores()))
        written = Journal(journal, inner, resume=how.resume)
        stack.callback(_forget_if_empty, written, journal)
        stack.callback(written.shutdown)
        yield written
    journal.unlink(missing_ok=True)


def _forget_if_empty(written: Journal, journal: Path) -> None:
    if not written.known and not written.recorded:
        journal.unlink(missing_ok=True)
