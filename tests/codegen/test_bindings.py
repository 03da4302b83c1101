# SPDX-License-Identifier: BSD-3-Clause
"""Packages from C++, Rust and ROS 2: the examples build without a warning, and say what C says."""

from __future__ import annotations

import os
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from catkin_pkg.package import parse_package
from compiled_packages import COMMITTED, WARNINGS, missing, run, tool

from softimpact import batch
from softimpact.codegen.bindings.interface import interface_of
from softimpact.codegen.bindings.languages import bindings

ROOT = Path(__file__).parents[2]
PANDA, EXAMPLES = ROOT / "generated/panda", ROOT / "examples"
STRICT = [flag for flag in WARNINGS if "prototypes" not in flag]


@pytest.fixture(scope="module")
def states() -> np.ndarray:
    """Joint coordinates and velocities, some of them fast, and one that makes no sense."""
    random = np.random.default_rng(1)
    middle = np.array([0.1, -0.3, 0.2, -2.0, 0.3, 2.0, 0.5])
    q = middle + random.uniform(-0.3, 0.3, (20, 7))
    dq = random.normal(size=(20, 7)) * np.linspace(0, 3, 20)[:, None]
    dq[5, 3] = np.nan
    return np.hstack([q, dq])


def right_factors(states: np.ndarray) -> tuple[np.ndarray, list[str]]:
    """Return what the package says over arrays."""
    panda = batch.compiled("panda", joint_stiffness=3e3)
    found = panda.speed_factor(states[:, :7], states[:, 7:], region="chest", clamped=False,
                               horizon=0.1)  # fmt: skip
    factors = np.nan_to_num(found["factor"])
    assert (factors < 0.9).any()
    assert (factors == 1).any()
    return factors, [panda.status_text(int(status)) for status in found["status"]]


def check(program: list[str | Path], states: np.ndarray) -> None:
    """A program's lines are the right factors and texts, and it names lines that are no states."""
    lines = "".join(",".join(f"{x:.17g}" for x in row) + "\n" for row in states)
    words = [str(word) for word in program]
    done = subprocess.run(words, input=lines, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stderr
    factors, texts = right_factors(states)
    said = [line.split(" ", 1) for line in done.stdout.splitlines()]
    assert [float(factor) for factor, _ in said] == pytest.approx(factors.tolist(), abs=2e-6)
    assert [text for _, text in said] == texts
    wrong = subprocess.run(words, input="1,2\n", capture_output=True, text=True, check=False)
    assert (wrong.returncode, wrong.stderr) == (2, "line 1 is not a state\n")


@pytest.mark.parametrize("compiler", ["g++", "clang++"])
@pytest.mark.parametrize("name", COMMITTED)
@pytest.mark.parametrize("real", ["float", "double"])
def test_wrappers_compile_without_a_warning(
    tmp_path: Path, compiler: str, name: str, real: str
) -> None:
    source = tmp_path / "main.cpp"
    lines = [f'#include "{name}.hpp"', f'#include "{name}.hpp"', "int main()", "{",
             f"    const {name}::params p;",
             f"    return {name}::mass_matrix({{}}) && p.layout == {name.upper()}_LAYOUT ? 0 : 1;",
             "}"]  # fmt: skip
    source.write_text("\n".join([*lines, ""]))
    told = ["-std=c++17", "-fno-exceptions", "-fno-rtti", f"-D{name.upper()}_USE_{real.upper()}=1"]
    include = f"-I{ROOT / 'generated' / name / 'include'}"
    run(tool(compiler), *told, *STRICT, include, "-fsyntax-only", source)


@pytest.mark.parametrize("word", ["class", "main", "sin", "link"])
def test_words_of_the_language_and_functions_of_c_are_no_namespaces(word: str) -> None:
    header = (PANDA / "include/panda.h").read_text()
    header = header.replace("panda", word).replace("PANDA", word.upper())
    interface = interface_of(header, word)
    seen: dict[str, Any] = {}
    bindings(interface, lambda template, **more: seen.setdefault(template, more) and "")
    assert seen["header.hpp"]["namespace"] == f"{word}_"
    assert seen["header.hpp"]["region"]  # and it has what makes a region


@pytest.mark.slow
def test_cpp_example(tmp_path: Path, states: np.ndarray) -> None:
    cmake = tool("cmake")
    flags = f"-DCMAKE_CXX_FLAGS={' '.join(STRICT)}"
    run(cmake, "-S", EXAMPLES / "cpp", "-B", tmp_path, flags)
    run(cmake, "--build", tmp_path)
    check([tmp_path / "speed_factor"], states)


@pytest.fixture(scope="module")
def cargo() -> Callable[..., str]:
    """Return how Rust's cargo is run, without a network."""
    found = shutil.which("cargo", path=f"{os.environ['PATH']}:{Path.home() / '.cargo/bin'}")
    if found is None:
        missing("cargo")
    return lambda *words: run(str(found), *words, "--offline")


@pytest.mark.slow
def test_rust_example(cargo: Callable[..., str], tmp_path: Path, states: np.ndarray) -> None:
    shutil.copytree(PANDA, tmp_path / "generated/panda")
    shutil.copytree(EXAMPLES / "rust", tmp_path / "examples/rust")
    manifest = ["--manifest-path", tmp_path / "examples/rust/Cargo.toml"]
    cargo("build", *manifest)
    check([tmp_path / "examples/rust/target/debug/speed-factor"], states)


@pytest.mark.slow
@pytest.mark.parametrize("features", [[], ["--features", "float"]])
def test_rust_declarations_are_those_of_c(
    cargo: Callable[..., str], tmp_path: Path, features: list[str]
) -> None:
    shutil.copytree(ROOT / "generated/rr", tmp_path / "rr")
    said = cargo("test", "--manifest-path", tmp_path / "rr/rust/Cargo.toml", *features)
    assert "2 passed" in said
    assert "warning" not in said


@pytest.mark.slow
def test_ros_example_without_ros(tmp_path: Path) -> None:
    package = parse_package(str(EXAMPLES / "ros2/package.xml"))
    assert {d.name for d in package.exec_depends} == {"rclcpp", "sensor_msgs", "std_msgs"}
    cmake = tool("cmake")
    flags = f"-DCMAKE_CXX_FLAGS={' '.join(STRICT)}"
    said = run(cmake, "-S", EXAMPLES / "ros2", "-B", tmp_path, flags)
    assert "the node is left out" in said
    run(cmake, "--build", tmp_path)
    run(tmp_path / "speed_guard_check")
