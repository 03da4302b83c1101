# SPDX-License-Identifier: BSD-3-Clause
"""Where searches run: a process for each core, or what the caller brings."""

from __future__ import annotations

import multiprocessing
import os
from concurrent.futures import Executor, ProcessPoolExecutor
from contextlib import AbstractContextManager, nullcontext


def workers(searches: int, given: Executor | None = None) -> AbstractContextManager[Executor]:
    """Return an executor to use with ``with``; one that was given stays open.

    Args:
        searches: most that will run at once.
        given: the caller's executor, None for a process for each core.
    """
    if given is not None:
        return nullcontext(given)
    context = multiprocessing.get_context("spawn")
    return ProcessPoolExecutor(min(searches, _cores()), context, initializer=_keep_to_one_core)


def _cores() -> int:
    """Number of cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


def _keep_to_one_core() -> None:
    """Keep the linear solver of a worker from spinning threads on the other workers' cores.

    OpenMP reads this when Ipopt is loaded, at the worker's first search.
    """
    os.environ.setdefault("OMP_NUM_THREADS", "1")
