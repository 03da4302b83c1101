# SPDX-License-Identifier: BSD-3-Clause
"""Without a C compiler, a home or a cache, with a damaged cache or nowhere to write."""

from __future__ import annotations

import os
from pathlib import Path
from typing import Any

import pytest
from command_line import Outcome, refusal, run
from small_arm import small_study

from softimpact import toolchain
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
WRITING = [name for name, words in COMMANDS.items() if "--out" in words]


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A working directory with a robot, a study and a motion."""
    small_study(tmp_path)
    monkeypatch.chdir(tmp_path)
    (tmp_path / "motion.json").write_text(WAYPOINTS)
    return tmp_path


def works(name: str) -> Outcome:
    impact_program._loaded.cache_clear()
    outcome = run(name, *COMMANDS[name])
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


@pytest.mark.parametrize("name", WRITING)
def test_where_nothing_can_be_written_one_line_says_so(name: str, folder: Path) -> None:
    words = [f"{os.devnull}/out" if word == "out" else word for word in COMMANDS[name]]
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
