# SPDX-License-Identifier: BSD-3-Clause
"""Folders of results: replaced whole, or left as they were."""

from __future__ import annotations

import errno
import json
from pathlib import Path

import pytest

from softimpact.codegen import FolderNotWritable, ForeignFolder
from softimpact.optimize.running.execution import Execution
from softimpact.studio.output.results_folder import (
    RESULTS,
    replaced_folder,
    require_replaceable_results,
    running,
)

MINE = "softimpact test"


def written(folder: Path, content: str, generator: str = MINE) -> None:
    with replaced_folder(folder, generator) as fresh:
        (fresh / RESULTS).write_text(json.dumps({"generator": generator, "content": content}))
        (fresh / f"{content}.txt").write_text(content)


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.iterdir())


def test_results_take_the_place_of_older_ones(tmp_path: Path) -> None:
    folder = tmp_path / "new" / "odd näme"
    written(folder, "first")
    written(folder, "second")
    assert names(folder) == [RESULTS, "second.txt"]
    assert names(folder.parent) == ["odd näme"]


@pytest.mark.parametrize("failure", [ValueError, KeyboardInterrupt])
def test_a_failure_keeps_the_older_ones(tmp_path: Path, failure: type[BaseException]) -> None:
    written(tmp_path / "out", "first")

    def fail() -> None:
        with replaced_folder(tmp_path / "out", MINE) as fresh:
            (fresh / "half").write_text("")
            raise failure

    with pytest.raises(failure):
        fail()
    assert names(tmp_path / "out") == ["first.txt", RESULTS]
    assert names(tmp_path) == ["out"]


@pytest.mark.parametrize(
    ("error", "told"),
    [
        (OSError(errno.ENOSPC, "No space left on device"), "out: cannot be written .No space left"),
        (FileNotFoundError(errno.ENOENT, "No such file", "/motion.csv"), "/motion.csv"),
    ],
)
def test_a_full_disk_names_the_folder_and_another_file_itself(
    tmp_path: Path, error: OSError, told: str
) -> None:
    def fail() -> None:
        with replaced_folder(tmp_path / "out", MINE):
            raise error

    with pytest.raises((FolderNotWritable, FileNotFoundError), match=told):
        fail()


def test_an_interruption_between_the_two_moves_is_undone(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    written(tmp_path / "out", "first")
    move = Path.rename

    def interrupted(source: Path, target: Path) -> Path:
        if target.name == "out" and not source.name.endswith(".previous"):
            raise KeyboardInterrupt
        return move(source, target)

    monkeypatch.setattr(Path, "rename", interrupted)
    with pytest.raises(KeyboardInterrupt):
        written(tmp_path / "out", "second")
    assert names(tmp_path / "out") == ["first.txt", RESULTS]
    assert names(tmp_path) == ["out"]


def test_a_link_stays_one(tmp_path: Path) -> None:
    (tmp_path / "target").mkdir()
    link = tmp_path / "link"
    link.symlink_to("target")
    written(link, "first")
    assert link.is_symlink()
    assert names(tmp_path / "target") == ["first.txt", RESULTS]
    assert names(tmp_path) == ["link", "target"]


def test_results_of_another_command_are_foreign(tmp_path: Path) -> None:
    written(tmp_path / "out", "first", "softimpact other")
    with pytest.raises(ForeignFolder, match="no earlier results of 'softimpact test'"):
        require_replaceable_results(tmp_path / "out", MINE)


@pytest.mark.parametrize("out", [".", "..", "", "/"])
def test_folders_in_use_are_refused_before_the_work(
    out: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "here").mkdir()
    monkeypatch.chdir(tmp_path / "here")
    with pytest.raises(FolderNotWritable, match="name one in it"):
        require_replaceable_results(Path(out), MINE)


def test_an_interrupted_run_names_resume(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    def interrupted() -> None:
        with running(Execution(processes=1), tmp_path / "out") as pool:
            pool.submit(abs, -1).result()
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        interrupted()
    assert "out.journal.jsonl: what was found so far; the same command with --resume goes on" in (
        capsys.readouterr().err
    )
