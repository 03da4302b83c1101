# SPDX-License-Identifier: BSD-3-Clause
"""libFuzzer and clang's sanitizers on generated packages; ``make fuzz`` runs them for longer."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from adversarial.robots import package_of
from compiled_packages import COMMITTED, Generated, missing, run, tool

from softimpact.codegen import Payload, generate_package
from softimpact.symbolic import load_robot

WEIGHTS = {
    **dict.fromkeys(COMMITTED, (1, 1)),
    "panda": (5, 1),
    "rmin": (5, 1),
    "cold": (1, 1),
    "hanging": (1, 1),
    "laden": (1, 1),
}
"""Shares of all executions in double and in float, which begins with what was found in double.

Other robots run the same sources as Panda (open chains) and R-Min (closed ones) with other joints;
some of these are compiled only where joints damp, gravity pulls or there are several points.
"""

EXECUTIONS = 1_000_000
"""Of all builds together, some three minutes of one core; ``make fuzz`` asks for more."""

CHECKS = (
    *("-fsanitize=fuzzer,address,undefined", "-fno-sanitize-recover=all", "-O2", "-g"),
    "-fno-sanitize-coverage=trace-cmp",
)
"""Comparisons tell libFuzzer nothing here, and to follow them takes four fifths of the time."""

RUN = ("-seed=1", "-max_len=256", "-len_control=0", "-timeout=60")


def executions(robot: str, real: str) -> int:
    """Return how often the fuzzer calls a build."""
    every = int(os.environ.get("FUZZ_EXECUTIONS", EXECUTIONS))
    share = WEIGHTS[robot][real == "float"] / sum(map(sum, WEIGHTS.values()))
    return round(every * share)


def laden(folder: Path) -> Generated:
    """Return a package with a payload, gravity and three contact points."""
    robot = load_robot("xarm7")
    points = {"elbow": "link4", "wrist": "link6@0.05,0,0.1"}
    payload = Payload(2.0, (0.0, 0.0, 0.1))
    pull = (0.0, 0.0, -9.81)
    manifest = generate_package(
        robot, folder, name="laden", gravity=pull, payload=payload, points=points
    )
    return Generated(robot, str(robot.tip), folder, manifest)


def build(generated: Generated, real: str, binary: Path) -> None:
    """Compile a package's fuzzing target."""
    sources = [*generated.folder.glob("src/*.c"), generated.folder / "fuzz/fuzz.c"]
    run(tool("clang"), *generated.flags(real), *CHECKS, *sources, "-o", binary, "-lm")


@pytest.fixture
def fuzzing(tmp_path: Path) -> None:
    """Skip a test where clang has no libFuzzer."""
    probe = tmp_path / "probe.c"
    probe.write_text("int LLVMFuzzerTestOneInput(const unsigned char *d, unsigned long n);\n"
                     "int LLVMFuzzerTestOneInput(const unsigned char *d, unsigned long n)"
                     "{ return d == 0 && n > 0; }\n")  # fmt: skip
    command = [tool("clang"), "-fsanitize=fuzzer", str(probe), "-o", str(tmp_path / "probe")]
    if subprocess.run(command, capture_output=True, check=False).returncode != 0:
        missing("clang's libFuzzer")


@pytest.mark.slow
@pytest.mark.long
@pytest.mark.usefixtures("fuzzing")
@pytest.mark.parametrize("robot", sorted(WEIGHTS))
def test_fuzzer_finds_nothing(
    package: Callable[[str], Generated], robot: str, tmp_path: Path
) -> None:
    corpus = tmp_path / "corpus"
    corpus.mkdir()
    if robot in COMMITTED:
        generated = package(robot)
    else:
        generated = (
            laden(tmp_path / robot) if robot == "laden" else package_of(robot, tmp_path / robot)
        )
    for real in ("double", "float"):
        binary, runs = tmp_path / real, executions(robot, real)
        build(generated, real, binary)
        said = run(binary, f"-runs={runs}", *RUN, f"-artifact_prefix={tmp_path}/", corpus)
        assert f"Done {runs} runs" in said


@pytest.mark.slow
@pytest.mark.usefixtures("fuzzing")
def test_fuzzer_notices_a_late_fault(package: Callable[[str], Generated], tmp_path: Path) -> None:
    generated = replace(package("rr"), folder=tmp_path / "rr")
    shutil.copytree(package("rr").folder, generated.folder)
    source = generated.folder / "src/rr_release.c"
    text = source.read_text()
    begin = "void rr_release(rr_state *s)\n{\n"
    assert text.count(begin) == 1
    fault = "    volatile rr_real two[2];\n    two[s->past > 4 ? 2 : 0] = s->f;\n"
    source.write_text(text.replace(begin, begin + fault))
    build(generated, "float", tmp_path / "fuzz")
    said = run(tmp_path / "fuzz", "-runs=100000", *RUN, f"-artifact_prefix={tmp_path}/", ok=False)
    assert "out of bounds" in said
