# SPDX-License-Identifier: BSD-3-Clause
"""A real cluster of processes that share no cache of compiled functions; one of them is killed."""

from __future__ import annotations

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager
from pathlib import Path

import pytest
from command_line import run
from small_arm import small_study
from studies import InProcess

from softimpact.optimize.robust.robust import robust_design
from softimpact.optimize.running.cluster import ClusterSilent, cluster
from softimpact.optimize.study.study_scenarios import scenarios_of
from softimpact.symbolic import InvalidValue

pytest.importorskip("distributed")

MANY = "directions = [[0.0, 1.0, 0.0], [0.0, 0.0, -1.0]]\nspeeds = [{}]"


@contextmanager
def process(*arguments: str, folder: Path, **environment: str) -> Iterator[subprocess.Popen[bytes]]:
    """Run a module of the cluster; end it with the block."""
    with (folder / f"{arguments[0]}.log").open("ab") as log:
        started = subprocess.Popen(
            [sys.executable, "-m", *arguments],
            stdout=log,
            stderr=log,
            env={**os.environ, "OMP_NUM_THREADS": "1", **environment},
            start_new_session=True,
        )
        try:
            yield started
        finally:
            if started.poll() is None:
                os.killpg(started.pid, signal.SIGKILL)
            started.wait()


@contextmanager
def started(folder: Path, workers: int) -> Iterator[tuple[str, list[subprocess.Popen[bytes]]]]:
    """A scheduler and some workers, each with a cache of its own; its address."""
    file = folder / "scheduler.json"
    with ExitStack() as stack:
        common = ("--no-dashboard", "--scheduler-file", str(file))
        stack.enter_context(
            process(
                *("distributed.cli.dask_scheduler", *common, "--port", "0"),
                *("--host", "127.0.0.1"),
                folder=folder,
            )
        )
        deadline = time.monotonic() + 60
        while not file.exists() and time.monotonic() < deadline:
            time.sleep(0.1)
        found = []
        for i in range(workers):
            home = folder / f"worker{i}"
            home.mkdir()
            found.append(
                stack.enter_context(
                    process(
                        *("distributed.cli.dask_worker", *common, "--nthreads", "1"),
                        *("--no-nanny", "--local-directory", str(home)),
                        folder=folder,
                        SOFTIMPACT_CACHE=str(home / "cache"),
                    )
                )
            )
        import json

        yield json.loads(file.read_text(encoding="utf-8"))["address"], found


@pytest.mark.slow
def test_a_worker_that_is_killed_loses_nothing(tmp_path: Path) -> None:
    speeds = ", ".join(f"{0.2 + 0.0001 * i:.4f}" for i in range(1500))
    study = small_study(tmp_path, scenarios=MANY.format(speeds))
    scenarios = scenarios_of(study)
    assert len(scenarios) == 6000
    killed: list[int] = []
    with started(tmp_path, 2) as (address, processes), cluster(address) as there:

        def kill_one(what: str, done: int, total: int) -> None:
            if what == "screening" and done == 2 and not killed:
                killed.append(processes[0].pid)
                os.killpg(processes[0].pid, signal.SIGKILL)

        found = robust_design(study, scenarios, there, kill_one)
        caches = [list((tmp_path / f"worker{i}" / "cache").glob("*.so")) for i in range(2)]
    assert killed
    assert any(caches)  # compiled there, not fetched from here
    here = robust_design(study, scenarios, InProcess())
    assert found.worst.index == here.worst.index
    assert found.worst.share == pytest.approx(here.worst.share, rel=1e-6)


def test_a_cluster_that_does_not_answer(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("softimpact.optimize.running.cluster.PATIENCE", 0.3)
    with (
        pytest.raises(ClusterSilent, match=r"no Dask scheduler answers at 'tcp://127.0.0.1:9'"),
        cluster("tcp://127.0.0.1:9"),
    ):
        pass
    for address in ("nonsense://", "nonsense"):
        with pytest.raises(InvalidValue, match="is no address"), cluster(address):
            pass
    small_study(tmp_path)
    command = ["design", tmp_path / "study.toml", "--dask", "tcp://127.0.0.1:9"]
    ended = run(*command, "--out", tmp_path / "out")
    assert ended.code == 3
    assert ended.err.strip().count("\n") == 0
    assert not (tmp_path / "out").exists()
