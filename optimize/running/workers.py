# SPDX-License-Identifier: BSD-3-Clause
"""Where long work runs: a process for each core, or what the caller brings."""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterable, Iterator
from concurrent import futures
from concurrent.futures import Executor, Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from importlib import import_module
from multiprocessing.context import SpawnContext, SpawnProcess
from typing import Any, TypeVar

Result = TypeVar("Result")

Progress = Callable[[str, int, int], None]
"""Called with what is being done, how much of it is done, and how much there is."""

LONGEST_WAIT = 0.5
"""Time [s] that is waited without a look at whether Ctrl-C was pressed."""


class WorkerLost(Exception):
    """A worker process ended before its job, which no job of ours does by itself."""

    exit_code = 3

    def __init__(self) -> None:
        super().__init__(
            "a worker process was ended from outside, perhaps for want of memory; "
            "close other programs or use fewer workers; --resume goes on from here"
        )


@contextmanager
def workers(count: int, given: Executor | None = None) -> Iterator[Executor]:
    """Return an executor to use with ``with``; one that was given stays open.

    An exception, an interruption above all, ends jobs that run and drops those that wait.

    Args:
        count: number of processes.
        given: the caller's executor, None for a process for each core.

    Raises:
        WorkerLost: a worker process ended before its job.
    """
    if given is not None:
        yield given
        return
    context = _Context()
    pool = ProcessPoolExecutor(count, context, initializer=_prepare_worker)
    try:
        yield pool
    except BaseException as error:
        context.end_workers()
        if isinstance(error, BrokenProcessPool):
            raise WorkerLost from error
        raise
    finally:
        pool.shutdown(cancel_futures=True)


def works_elsewhere(executor: Executor | None) -> bool:
    """Return whether jobs may run on other machines, which have no library of this one."""
    return bool(getattr(executor, "elsewhere", False))


def awake(pool: Executor, jobs: int) -> None:
    """Let worker processes start and load what they need while this one prepares their jobs."""
    for _ in range(min(jobs, cores())):
        pool.submit(_load)


def _load() -> None:
    """Import what searches need, in a worker process."""
    import_module("..search.solve", __package__)


def as_completed(jobs: Iterable[Future[Result]]) -> Iterator[Future[Result]]:
    """Yield jobs as they end, like ``concurrent.futures.as_completed``, and hear every Ctrl-C.

    Python sleeps through a signal that comes while it goes to sleep, on a busy machine often.
    """
    waiting = set(jobs)
    while waiting:
        try:
            for job in futures.as_completed(waiting, timeout=LONGEST_WAIT):
                waiting.remove(job)
                yield job
        except TimeoutError:
            continue


def cores() -> int:
    """Number of cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


class _Worker(SpawnProcess):
    """A process that does not hear Ctrl-C, which a terminal sends to all: its parent ends it.

    If it died by itself, the parent might learn of the broken pool before the interruption. Nor
    does it load what MuJoCo draws with: that starts a process of its own, which would complain of
    its parent's end.
    """

    def start(self) -> None:
        with _without_drawing(), _interruption_waits():
            self._start_deaf()

    def _start_deaf(self) -> None:
        # a process takes over what is blocked, from its first instruction on
        if not hasattr(signal, "pthread_sigmask"):  # Windows: see _prepare_worker
            super().start()
            return
        before = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
        try:
            super().start()
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)


@contextmanager
def _interruption_waits() -> Iterator[None]:
    """Let Ctrl-C come after a process has started: one that is half started nobody can end.

    That the signal is blocked meanwhile does not do: another thread takes it for this one.
    """
    before = signal.getsignal(signal.SIGINT)
    if threading.current_thread() is not threading.main_thread() or before is None:
        yield
        return
    pressed: list[int] = []
    signal.signal(signal.SIGINT, lambda number, _: pressed.append(number))
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
        if pressed:
            signal.raise_signal(signal.SIGINT)


@contextmanager
def _without_drawing() -> Iterator[None]:
    """Let processes that start meanwhile load MuJoCo without its graphics."""
    before = os.environ.get("MUJOCO_GL")
    os.environ["MUJOCO_GL"] = "disable"
    try:
        yield
    finally:
        if before is None:
            del os.environ["MUJOCO_GL"]
        else:
            os.environ["MUJOCO_GL"] = before


class _Context(SpawnContext):
    """What starts a pool's processes, and remembers them.

    The pool does not know yet of a process whose start was interrupted.
    """

    def __init__(self) -> None:
        self.started: list[_Worker] = []

    def Process(self, *arguments: Any, **named: Any) -> _Worker:  # type: ignore[override]
        worker = _Worker(*arguments, **named)
        self.started.append(worker)
        return worker

    def end_workers(self) -> None:
        """End all processes at once, whatever they do."""
        for worker in self.started:
            if worker.is_alive():
                worker.terminate()


def _prepare_worker() -> None:
    """Keep a worker to one core, deaf to Ctrl-C, and let it end with its parent.

    OpenMP reads the variable when Ipopt is loaded, at the worker's first search; the linear solver
    would spin threads on the other workers' cores.
    """
    os.environ.setdefault("OMP_NUM_THREADS", "1")
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    """End this process when its parent has: nobody else would tell a worker to stop waiting."""
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
