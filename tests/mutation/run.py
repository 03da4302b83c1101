# SPDX-License-Identifier: BSD-3-Clause
"""Put small faults into sources, one at a time, and see whether a test notices.

Usage: ``python tests/mutation/run.py symbolic codegen --sample 100``, after a run of the tests with
``--cov --cov-context=test``, which tells the tests that pass through a line. A fault that none of
them notices is printed; judge it: a test that notices it, or a line of ``harmless.csv`` that says
why none is needed. Those are not tried again.
"""

from __future__ import annotations

import argparse
import csv
import hashlib
import math
import multiprocessing
import os
import resource
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from queue import Queue
from types import SimpleNamespace

import coverage
import pytest
from mutants import Mutant, mutants, mutated  # type: ignore[import-not-found] # beside it

ROOT = Path(__file__).resolve().parents[2]
HARMLESS = Path(__file__).with_name("harmless.csv")
FEW = 25
"""Tests that a fault meets first: those that pass through the fewest lines, so the closest ones."""
MANY = 200
"""Tests that a fault meets at most."""
TEST_SECONDS = 10
"""Processor time after which a test counts as endless: fast ones take two. The fault is noticed."""
RUN_SECONDS = 300
"""Time after which a run that waits counts as endless."""

PROCESSES = multiprocessing.get_context("forkserver")
"""Starts a process for each fault; what all of them import is imported once."""
PROCESSES.set_forkserver_preload(["casadi", "hypothesis", "mujoco", "pytest"])


@dataclass(frozen=True)
class Fault:
    """A mutant of a file, and the tests that may notice it, closest first."""

    file: str
    code: str
    mutant: Mutant
    tests: tuple[str, ...]

    @property
    def place(self) -> tuple[str, str, str]:
        """What stays when lines move."""
        return self.file, self.code, self.mutant.what


def faults(folders: Sequence[str], data: coverage.CoverageData) -> Iterator[Fault]:
    """Yield the faults of folders whose lines some test passes through."""
    lines_of: Counter[str] = Counter()
    ran: dict[Path, dict[int, set[str]]] = {}
    for measured in data.measured_files():
        ran[Path(measured).resolve()] = by_line = {
            line: {context.rpartition("|")[0] for context in contexts} - {""}
            for line, contexts in data.contexts_by_lineno(measured).items()
        }
        lines_of.update(test for tests in by_line.values() for test in tests)

    def closest(tests: Iterable[str]) -> list[str]:
        return sorted(tests, key=lambda test: (lines_of[test], test))

    for folder in folders:
        for path in sorted((ROOT / folder).rglob("*.py")):
            by_line, file = ran.get(path, {}), path.relative_to(ROOT)
            through = closest(set().union(*by_line.values()))
            # what a module or a cache holds was made while another test ran, or none
            beside = closest(test for test in lines_of if test.startswith(tests_of(file)))
            source = path.read_text(encoding="utf-8")
            lines = source.splitlines()
            for mutant in mutants(source) if by_line else ():
                tests = dict.fromkeys([*closest(by_line.get(mutant.line, ())), *through, *beside])
                code = lines[mutant.line - 1].strip()
                yield Fault(file.as_posix(), code, mutant, tuple(tests)[:MANY])


def tests_of(file: Path) -> str:
    """Return the folder of tests that is named as the deepest folder of a source."""
    return next(f"tests/{f.as_posix()}/" for f in file.parents if (ROOT / "tests" / f).is_dir())


@contextmanager
def copies(count: int) -> Iterator[Queue[Path]]:
    """Give copies of the sources to put faults into."""
    listed = ["git", "ls-files", "--cached", "--others", "--exclude-standard"]
    names = subprocess.run(listed, cwd=ROOT, check=True, capture_output=True, text=True).stdout
    free: Queue[Path] = Queue()
    with tempfile.TemporaryDirectory() as folder:
        for i in range(count):
            copy = Path(folder) / str(i)
            for name in names.splitlines():
                (copy / name).parent.mkdir(parents=True, exist_ok=True)
                if (ROOT / name).exists():
                    shutil.copy(ROOT / name, copy / name, follow_symlinks=False)
            free.put(copy)
        yield free


def noticed(fault: Fault, free: Queue[Path]) -> bool:
    """Return whether a test fails with a fault: the closest ones, then the others."""
    copy = free.get()
    source = copy / fault.file
    original = source.read_text(encoding="utf-8")
    try:
        source.write_text(mutated(original, fault.mutant), encoding="utf-8")
        if fails(copy, fault.tests[:FEW]):
            return True
        return len(fault.tests) > FEW and fails(copy, fault.tests[FEW:])
    finally:
        source.write_text(original, encoding="utf-8")
        free.put(copy)


def fails(copy: Path, tests: Sequence[str]) -> bool:
    """Return whether one of some tests fails, in a process that has the libraries already."""
    process = PROCESSES.Process(target=run, args=(copy, tests))
    process.start()
    process.join(RUN_SECONDS)
    if process.exitcode is None:
        process.kill()
        process.join()
    return process.exitcode != 0


def run(copy: Path, tests: Sequence[str]) -> None:
    """Run tests of a copy, silently, and end this process as they ended."""
    os.chdir(copy)
    sys.path.insert(0, str(copy / "src"))
    sys.dont_write_bytecode = True
    os.environ["PYTHONPATH"] = str(copy / "src")  # of the processes that tests start
    for stream in (sys.stdout, sys.stderr):
        os.dup2(os.open(os.devnull, os.O_WRONLY), stream.fileno())
    options = "-x -q -p no:cacheprovider -p no:randomly --hypothesis-profile first-failure"
    already = "-W ignore::pytest.PytestAssertRewriteWarning"  # imported, by PROCESSES
    hurry = SimpleNamespace(pytest_runtest_setup=end_soon)
    sys.exit(pytest.main([*options.split(), *already.split(), *tests], plugins=[hurry]))


def end_soon() -> None:
    """End this process when the test that begins takes too much processor time."""
    used = resource.getrusage(resource.RUSAGE_SELF)
    limit = math.ceil(used.ru_utime + used.ru_stime) + TEST_SECONDS
    resource.setrlimit(resource.RLIMIT_CPU, (limit, resource.RLIM_INFINITY))


def known_as_harmless() -> set[tuple[str, str, str]]:
    """Return the places of the faults that were judged."""
    with HARMLESS.open(encoding="utf-8", newline="") as lines:
        return {(row["file"], row["code"], row["change"]) for row in csv.DictReader(lines)}


def drawn(fault: Fault, seed: int) -> str:
    """Return by what a sample is drawn: other lines of a file do not change it."""
    return hashlib.sha256(f"{seed} {fault.place}".encode()).hexdigest()


def main() -> int:
    """Try a sample; return 1 if it must not have a fault that no test notices, and has one."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("folders", nargs="+")
    parser.add_argument("--sample", type=int, default=100)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--processes", type=int, default=os.cpu_count() or 1)
    parser.add_argument("--strict", action="store_true", help="fail if one is not noticed")
    given = parser.parse_args()
    data = coverage.CoverageData(str(ROOT / ".coverage"))
    data.read()
    harmless = known_as_harmless()
    known = [each for each in faults(given.folders, data) if each.place not in harmless]
    chosen = sorted(
        sorted(known, key=lambda fault: drawn(fault, given.seed))[: given.sample],
        key=lambda fault: (fault.file, fault.mutant),
    )
    with copies(given.processes) as free, ThreadPoolExecutor(given.processes) as pool:
        answers = pool.map(lambda fault: noticed(fault, free), chosen)
        missed = []
        for fault, found in zip(chosen, answers, strict=True):
            if not found:
                missed.append(fault)
                print(f"{fault.file}:{fault.mutant.line}: {fault.mutant.what}", flush=True)
    print(f"{len(chosen) - len(missed)} of {len(chosen)} faults noticed, of {len(known)} possible")
    return int(given.strict and bool(missed))


if __name__ == "__main__":
    sys.exit(main())
