# SPDX-License-Identifier: BSD-3-Clause
"""Workers end with their parent, also by Ctrl-C, which a terminal sends to all of them."""

from __future__ import annotations

import os
import signal
import subprocess
import sys

from studies import InProcess

from softimpact.optimize.workers import workers

LONG = """
import time
from softimpact.optimize.workers import workers

if __name__ == "__main__":
    with workers(1) as pool:
        pool.submit(int).result()
        jobs = [pool.submit(time.sleep, 600) for _ in range(9)]
        time.sleep(1)  # until the worker is at the first of them
        print("ready", flush=True)
        jobs[-1].result()
"""


def test_an_interruption_ends_searches_that_run_or_wait() -> None:
    command = [sys.executable, "-c", LONG]
    pipe = subprocess.PIPE
    with subprocess.Popen(
        command, stdout=pipe, stderr=pipe, text=True, start_new_session=True
    ) as parent:
        assert parent.stdout is not None
        assert parent.stdout.readline() == "ready\n"
        os.killpg(parent.pid, signal.SIGINT)
        try:
            _, words = parent.communicate(timeout=100)  # a sixth of the time that a job takes
        finally:
            if parent.poll() is None:
                os.killpg(parent.pid, signal.SIGKILL)
    assert parent.returncode != 0
    assert "KeyboardInterrupt" in words


def test_the_callers_executor_stays_open() -> None:
    mine = InProcess()
    with workers(2, mine) as pool:
        assert pool is mine
    assert mine.submit(int).result() == 0
