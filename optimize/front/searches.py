# SPDX-License-Identifier: BSD-3-Clause
"""Many searches of one problem at once."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from concurrent.futures import Executor
from dataclasses import dataclass
from typing import Any, TypeVar

from ..running.workers import Progress, as_completed
from ..search.problem import Problem

Key = TypeVar("Key")
Result = TypeVar("Result")


@dataclass(frozen=True, eq=False)
class Searches:
    """A problem, where its searches run, and who hears of them."""

    problem: Problem
    pool: Executor
    on_progress: Progress

    def run(
        self, what: str, function: Callable[..., Result], jobs: Mapping[Key, tuple[Any, ...]]
    ) -> Iterator[tuple[Key, Result]]:
        """Yield key and result of each job as it ends.

        Args:
            what: is being done, for progress.
            function: that does it, importable by a worker process.
            jobs: its arguments, by key.
        """
        self.on_progress(what, 0, len(jobs))
        futures = {self.pool.submit(function, *jobs[key]): key for key in jobs}
        for i, future in enumerate(as_completed(futures)):
            self.on_progress(what, i + 1, len(jobs))
            yield futures[future], future.result()
