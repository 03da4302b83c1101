# SPDX-License-Identifier: BSD-3-Clause
"""Without a C compiler, a home or a cache, with a damaged cache or nowhere to write."""

from __future__ import annotations

import os
import re
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from command_line import Outcome, refusal, run
from small_arm import small_study

from softimpact import toolchain
from softimpact.batch import build
from softimpact.optimize import impact_program
from softimpact.optimize.impact_program import impact_program as program_of

WAYPOINTS = '{"waypoints": [{"q": [0.2, -0.7, 1.3]}, {"q": [0.4, -0.6, 1.3], "speed": 0.3}]}'
STUDY = {"select": (), "check": (), "design": ("--out", "out")}
MODEL = ("arm.xml", "--tip", "tool")
AT = ("--q", "[0.2, -0.7, 1.3]", "--direction", "[0, 1, 0]", "--joint-stiffness", 8000)
COMMANDS: dict[str, tuple[object, ...]] = {
    "robots": (),
    "inspect": MODEL,
    "init": MODEL,
    "analyze": (*MODEL, *AT),
    "factors": (*MODEL, *AT[:4]),
    "simulate": (*MODEL, *AT, "--region", "chest", "--speed", 0.3, "--safe-speed"),
    "program": ("motion.json", "--model", "arm.xml", "--end", "tool", "--regions", "chest"),
    "generate": (*MODEL, "--out", "out"),
    **{name: ("study.toml", *options) for name, options in STUDY.items()},
}
LONGER: dict[str, tuple[object, ...]] = {
    "pareto": ("study.toml", "--points", 2, "--out", "out"),
    "map": (*MODEL, "--step", 0.8, "--out", "out"),
}
"""These are tried on the poorest machine alone."""

ENDLESS: dict[str, tuple[object, ...]] = {
    "studio": (*MODEL, "--out", "out"),
    "factors-study": ("study.toml", "--out", "out"),
    "reproduce": ("--out", "out"),
}
"""They are as the others, but take minutes: that they refuse at once is tested."""

EVERY = COMMANDS | LONGER | ENDLESS
WRITING = [name for name, words in EVERY.items() if "--out" in words]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A working directory with a robot, a study and a motion."""
    small_study(tmp_path)
    monkeypatch.chdir(tmp_path)
    (tmp_path / "motion.json").write_text(WAYPOINTS)
    return tmp_path


def works(name: str) -> Outcome:
    impact_program._loaded.cache_clear()
    outcome = run(name, *EVERY[name])
    assert outcome.code == 0, outcome.err
    assert outcome.out
    return outcome


def no_compiler(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("CC", str(folder / "none"))


def no_cache(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SOFTIMPACT_CACHE", os.devnull + "/cache")


def no_home(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def homeless(*_: Any, **__: Any) -> Path:
        raise RuntimeError("Could not determine home directory.")

    for name in ("HOME", "SOFTIMPACT_CACHE", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(toolchain, "user_cache_path", homeless)


@pytest.mark.slow
@pytest.mark.parametrize("lacking", [no_compiler, no_cache, no_home])
@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_works(
    name: str, lacking: Any, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    lacking(folder, monkeypatch)
    works(name)


@pytest.mark.slow
def test_fronts_are_found_on_the_poorest_machine(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    no_compiler(folder, monkeypatch)
    no_home(folder, monkeypatch)
    works("pareto")


def test_a_map_without_any_compiler_says_which_package_brings_one(
    folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(build, "_compiler", lambda: None)
    assert "pip install ziglang" in refusal("map", *EVERY["map"])


@pytest.mark.slow
def test_zig_needs_neither_home_nor_cache(folder: Path) -> None:
    """A process of its own: Zig is one, too, and looks for its cache itself."""
    words = ["map", *map(str, EVERY["map"])]
    environment = {"PATH": os.defpath, "CC": "/none/cc", "PYTHONIOENCODING": "ascii:strict"}
    environment |= {name: os.environ[name] for name in ("PYTHONPATH",) if name in os.environ}
    environment["XDG_CACHE_HOME"] = f"{os.devnull}/cache"
    script = "import sys; from softimpact.cli import main; sys.exit(main(sys.argv[1:]))"
    command = [sys.executable, "-c", script, *words]
    done = subprocess.run(
        command, env=environment, cwd=folder, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    assert not {"error", "Warning", "Traceback"} & set(re.findall(r"\w+", done.stderr))


@pytest.mark.parametrize("name", WRITING)
def test_where_nothing_can_be_written_one_line_says_so(name: str, folder: Path) -> None:
    words = [f"{os.devnull}/out" if word == "out" else word for word in EVERY[name]]
    assert os.devnull in refusal(name, *words)


def test_a_damaged_cache_is_made_anew(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("SOFTIMPACT_CACHE", str(folder / "cache"))
    model = small_study(folder).model
    first = program_of(model, 20, 2, compiled=True)
    if first.library is None:
        pytest.skip("needs a C compiler")
    whole = first.library.read_bytes()
    for damaged in (b"", b"not a library"):
        first.library.unlink()
        first.library.write_bytes(damaged)
        again = program_of(model, 20, 2, compiled=True)
        assert again.library == first.library
        assert len(first.library.read_bytes()) == len(whole)
