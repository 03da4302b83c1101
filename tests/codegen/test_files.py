# SPDX-License-Identifier: BSD-3-Clause
"""Packages replace packages as a whole, and nothing else."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from softimpact.codegen import FolderNotWritable, ForeignFolder
from softimpact.codegen.package.files import replace_package, require_place, sha256
from softimpact.codegen.record.manifest import GENERATOR


def package(content: str) -> dict[str, str]:
    """Return a small package."""
    texts = {"src/a.c": content, "README.md": f"about {content}"}
    hashes = {name: sha256(text) for name, text in texts.items()}
    return {**texts, "manifest.json": json.dumps({"generator": GENERATOR, "files": hashes})}


def contents(folder: Path) -> dict[str, str]:
    """Return all files below a folder."""
    found = sorted(path for path in folder.rglob("*") if path.is_file())
    return {path.relative_to(folder).as_posix(): path.read_text() for path in found}


def test_writes_into_a_new_or_empty_folder(tmp_path: Path) -> None:
    (tmp_path / "empty").mkdir()
    for folder in (tmp_path / "empty", tmp_path / "deep" / "new"):
        replace_package(folder, package("one"))
        assert contents(folder) == package("one")
        assert [p.name for p in folder.parent.iterdir() if p.name.startswith(".")] == []


def test_replaces_its_own_package_and_what_it_no_longer_has(tmp_path: Path) -> None:
    replace_package(tmp_path / "p", package("one"))
    shorter = package("two")
    del shorter["README.md"]
    replace_package(tmp_path / "p", shorter)
    assert contents(tmp_path / "p") == shorter
    assert [p.name for p in tmp_path.iterdir()] == ["p"]


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("notes.txt", "mine"),
        ("src/a.c", "edited"),
        ("manifest.json", '{"generator": "other"}'),
        ("manifest.json", package("one")["manifest.json"].replace(GENERATOR, "other")),
        ("manifest.json", "[]"),
    ],
)
def test_refuses_foreign_or_edited_files(tmp_path: Path, name: str, text: str) -> None:
    folder = tmp_path / "p"
    replace_package(folder, package("one"))
    (folder / name).write_text(text)
    before = contents(folder)
    with pytest.raises(ForeignFolder, match=r"not overwritten"):
        replace_package(folder, package("two"))
    assert contents(folder) == before


def test_refuses_a_file_or_a_link_in_the_folders_place(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("mine")
    (tmp_path / "target").mkdir()
    (tmp_path / "link").symlink_to(tmp_path / "target")
    for name in ("file", "link"):
        with pytest.raises(ForeignFolder):
            replace_package(tmp_path / name, package("one"))
    assert (tmp_path / "file").read_text() == "mine"
    assert contents(tmp_path / "target") == {}


def test_refuses_a_package_with_a_link_in_it(tmp_path: Path) -> None:
    replace_package(tmp_path / "p", package("one"))
    (tmp_path / "mine").mkdir()
    (tmp_path / "p/link").symlink_to(tmp_path / "mine")
    with pytest.raises(ForeignFolder, match="link"):
        replace_package(tmp_path / "p", package("two"))
    assert (tmp_path / "p/link").is_symlink()


def test_names_the_folder_that_cannot_be_written(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("mine")
    with pytest.raises(FolderNotWritable, match="p"):
        replace_package(tmp_path / "file" / "p", package("one"))


class Interrupted(BaseException):
    """Stands for a signal."""


def test_interrupted_writing_leaves_the_older_package(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    replace_package(tmp_path / "p", package("one"))
    write = Path.write_text

    def write_one(self: Path, text: str, **options: str) -> int:
        if self.name == "a.c":
            raise Interrupted
        return write(self, text, **options)

    monkeypatch.setattr(Path, "write_text", write_one)
    with pytest.raises(Interrupted):
        replace_package(tmp_path / "p", package("two"))
    assert contents(tmp_path / "p") == package("one")
    assert [p.name for p in tmp_path.iterdir()] == ["p"]


def test_interrupted_exchange_brings_the_older_package_back(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    replace_package(tmp_path / "p", package("one"))
    rename = Path.rename

    def rename_old(self: Path, target: Path) -> Path:
        if target.name == "p" and not self.name.endswith(".previous"):
            raise Interrupted
        return rename(self, target)

    monkeypatch.setattr(Path, "rename", rename_old)
    with pytest.raises(Interrupted):
        replace_package(tmp_path / "p", package("two"))
    assert contents(tmp_path / "p") == package("one")


def test_package_left_behind_by_a_killed_process_comes_back(tmp_path: Path) -> None:
    folder = tmp_path / "p"
    replace_package(folder, package("one"))
    folder.rename(tmp_path / ".p.previous")  # killed between the two renames
    require_place(folder)
    assert contents(folder) == package("one")
    replace_package(folder, package("two"))
    assert contents(folder) == package("two")
    assert [p.name for p in tmp_path.iterdir()] == ["p"]


def test_foreign_folder_in_the_place_of_the_older_package_stays(tmp_path: Path) -> None:
    mine = tmp_path / ".p.previous"
    mine.mkdir()
    (mine / "notes.txt").write_text("mine")
    with pytest.raises(ForeignFolder):
        replace_package(tmp_path / "p", package("one"))
    assert contents(mine) == {"notes.txt": "mine"}
