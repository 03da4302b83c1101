# SPDX-License-Identifier: BSD-3-Clause
"""Where long work runs: a process for each core, or what the caller brings."""

from __future__ import annotations

import multiprocessing
import os
import signal
from collections.abc import Iterator
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import contextmanager


@contextmanager
def workers(jobs: int, given: Executor | None = None) -> Iterator[Executor]:
    """Return an executor to use with ``with``; one that was given stays open.

    An interruption ends jobs that run and drops those that wait.

    Args:
        jobs: most that will run at once.
        given: the caller's executor, None for a process for each core.
    """
    if given is not None:
        yield given
        return
    context = multiprocessing.get_context("spawn")
    pool = ProcessPoolExecutor(min(jobs, _cores()), context, initializer=_prepare_worker)
    try:
        yield pool
    finally:
        pool.shutdown(cancel_futures=True)


def _cores() -> int:
    """Number of cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _prepare_worker() -> None:
    """Keep a worker to one core, and let it die of Ctrl-C.

    OpenMP reads the variable when Ipopt is loaded, at the worker's first search; the linear solver
    would spin threads on the other workers' cores. CasADi takes Python's KeyboardInterrupt for the
    end of one search, and would go on with the next.
    """
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    signal.signal(signal.SIGINT, signal.SIG_DFL)
