# SPDX-License-Identifier: BSD-3-Clause
"""Ctrl-C, which a terminal sends to all processes of a command, ends it at once with one line."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from softimpact.__main__ import main as start

HEAD = """
import os
import signal
import sys
import time

from softimpact import cli


def ready():
    os.write(1, b"ready\\n")

"""

WAITING = """
@cli.app.command()
def endless():
    ready()
    while True:
        time.sleep(0.1)
"""

SOLVER = """
@cli.app.command()
def endless():
    import casadi as ca

    x = ca.SX.sym("x")
    ipopt = {"print_level": 0, "sb": "yes", "max_iter": 2**31 - 1, "tol": 1e-300}
    options = {"print_time": False, "error_on_fail": False, "ipopt": ipopt}
    solver = ca.nlpsol("solver", "ipopt", {"x": x, "f": ca.exp(-x)}, options)
    ready()
    while True:
        solver(x0=0)
"""

PYTHON = """
@cli.app.command()
def endless():
    import casadi as ca
    import numpy as np

    class Slow(np.ndarray):
        def astype(self, *args, **kwargs):
            time.sleep(0.1)
            return super().astype(*args, **kwargs)

    numbers = np.zeros(2).view(Slow)
    ca.DM(numbers)
    ready()
    while True:
        ca.DM(numbers)
"""
"""CasADi's own Python takes an exception for numbers that it cannot use."""

WORKERS = """
def job():
    ready()
    while True:
        signal.pause()


@cli.app.command()
def endless():
    from softimpact.optimize.running.workers import as_completed, workers

    with workers(2) as pool:
        for done in as_completed([pool.submit(job)]):
            done.result()
"""

TAIL = """
if __name__ == "__main__":
    sys.exit(cli.main(["endless"]))
"""


@pytest.mark.parametrize(
    "command", [WAITING, SOLVER, PYTHON, WORKERS], ids=["waiting", "solver", "python", "workers"]
)
def test_one_line_and_exit_code_130(tmp_path: Path, command: str) -> None:
    script = tmp_path / "command.py"
    script.write_text(HEAD + command + TAIL, encoding="utf-8")
    pipe = subprocess.PIPE
    with subprocess.Popen(
        [sys.executable, str(script)], stdout=pipe, stderr=pipe, text=True, start_new_session=True
    ) as parent:
        assert parent.stdout is not None
        try:
            while parent.stdout.readline() != "ready\n":
                assert parent.poll() is None
            os.killpg(parent.pid, signal.SIGINT)
            _, words = parent.communicate(timeout=100)  # until all that hold the pipes have ended
        finally:
            if parent.poll() is None:
                os.killpg(parent.pid, signal.SIGKILL)
    assert (parent.returncode, words.strip()) == (130, "error: interrupted")


def test_an_interruption_while_the_command_loads(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def interrupted() -> int:
        raise KeyboardInterrupt

    monkeypatch.setattr("softimpact.cli.main", interrupted)
    assert start() == 130
    assert capsys.readouterr().err == "error: interrupted\n"
