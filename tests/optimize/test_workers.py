# SPDX-License-Identifier: BSD-3-Clause
"""Workers end with their parent, also by Ctrl-C, which a terminal sends to all of them.

No job here ends by itself: a parent that waited for one would never end.
"""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import threading
from collections.abc import Iterator
from concurrent.futures import Future, ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import pytest
from studies import InProcess

from softimpact.optimize.running.workers import WorkerLost, as_completed, awake, workers

SCRIPT = """
import os
import signal

from softimpact.optimize.running.workers import as_completed, workers


def say(word):
    os.write(1, f"{word}\\n".encode())  # one write, so that words of two processes stay apart


def endless():
    say(f"worker {os.getpid()}")
    while True:
        signal.pause()


if __name__ == "__main__":
    with workers(2) as pool:
        jobs = [pool.submit(endless) for _ in range(9)]
        say("parent")
        for job in as_completed(jobs):
            job.result()
"""


HALF_STARTED = """
from multiprocessing import util
import threading

start = util.spawnv_passfds


def press():
    signal.pthread_sigmask(signal.SIG_UNBLOCK, [signal.SIGINT])  # inherited from the main thread
    signal.pthread_kill(threading.get_ident(), signal.SIGINT)


def pressed(program, words, handles):
    pid = start(program, words, handles)
    if any("multiprocessing-fork" in str(word) for word in words):  # not what Python starts beside
        thread = threading.Thread(target=press)
        thread.start()
        thread.join()
    return pid


util.spawnv_passfds = pressed
"""
"""Presses Ctrl-C when a worker runs that was not told yet what it is, in a thread that hears it."""


@contextmanager
def running(folder: Path, program: str = SCRIPT) -> Iterator[subprocess.Popen[str]]:
    """Run a script in a process group of its own; leave nothing of it behind."""
    script = folder / "script.py"
    script.write_text(program, encoding="utf-8")
    pipe = subprocess.PIPE
    command = [sys.executable, str(script)]
    with subprocess.Popen(
        command, stdout=pipe, stderr=pipe, text=True, start_new_session=True
    ) as parent:
        try:
            yield parent
        finally:
            if parent.poll() is None:
                os.killpg(parent.pid, signal.SIGKILL)


def read_until(parent: subprocess.Popen[str], word: str) -> str:
    """Return the first line that starts with a word."""
    assert parent.stdout is not None
    for line in parent.stdout:
        if line.startswith(word):
            return line
    raise AssertionError(f"ended before '{word}'")


@pytest.mark.parametrize("moment", ["parent", "worker"])
def test_an_interruption_ends_searches_that_start_run_or_wait(tmp_path: Path, moment: str) -> None:
    with running(tmp_path) as parent:
        read_until(parent, moment)
        os.killpg(parent.pid, signal.SIGINT)
        _, words = parent.communicate(timeout=100)  # until all that hold the pipes have ended
    assert parent.returncode == -signal.SIGINT
    assert words.count("Traceback") == 1, words  # the parent's own
    assert words.endswith("KeyboardInterrupt\n")


def test_an_interruption_waits_for_a_worker_that_is_half_started(tmp_path: Path) -> None:
    before, main, after = SCRIPT.partition('if __name__ == "__main__":\n')
    start = "".join(f"    {line}\n" for line in HALF_STARTED.splitlines())
    with running(tmp_path, before + main + start + after) as parent:
        _, words = parent.communicate(timeout=100)
    assert parent.returncode == -signal.SIGINT
    assert words.count("Traceback") == 1, words  # the parent's own
    assert words.endswith("KeyboardInterrupt\n")


def test_workers_end_with_a_parent_that_is_killed(tmp_path: Path) -> None:
    with running(tmp_path) as parent:
        read_until(parent, "worker")
        parent.kill()
        parent.communicate(timeout=100)  # until all that hold the pipes have ended


def test_a_worker_that_is_killed_is_named(tmp_path: Path) -> None:
    with running(tmp_path) as parent:
        worker = int(read_until(parent, "worker").split()[1])
        os.kill(worker, signal.SIGKILL)
        _, words = parent.communicate(timeout=100)
    assert parent.returncode == 1
    assert f"{WorkerLost.__name__}: a worker process was ended from outside" in words


def test_all_jobs_are_heard_of_also_those_that_take_long(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("softimpact.optimize.running.workers.LONGEST_WAIT", 1e-3)
    first, last = threading.Event(), threading.Event()
    with ThreadPoolExecutor(2) as pool:
        late = pool.submit(last.wait)
        jobs = as_completed([late, pool.submit(first.wait)])
        threading.Timer(0.05, first.set).start()  # after some looks at the jobs
        assert next(jobs) is not late
        last.set()
        assert list(jobs) == [late]


def test_the_callers_executor_stays_open() -> None:
    mine = InProcess()
    with workers(2, mine) as pool:
        assert pool is mine
    assert mine.submit(int).result() == 0


def test_workers_that_wake_load_what_searches_need() -> None:
    """What fails there would be lost: nobody waits for it."""
    jobs: list[Future[None]] = []

    class Kept(InProcess):
        def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
            jobs.append(super().submit(fn, *args, **kwargs))
            return jobs[-1]

    awake(Kept(), 1)
    assert [job.exception() for job in jobs] == [None]
