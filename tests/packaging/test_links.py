# SPDX-License-Identifier: BSD-3-Clause
"""A copy without symbolic links does not build, and says why."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).resolve().parents[2]
FOLDERS = sorted(path.parent.name for path in ROOT.glob("*/__init__.py"))


def made_without_links(folder: Path, how: str) -> Path:
    """Copy what a build reads as git or zip do where there are no links."""
    for name in FOLDERS:
        (folder / name).mkdir()
        shutil.copy(ROOT / name / "__init__.py", folder / name)
    source = folder / "src" / "softimpact"
    source.mkdir(parents=True)
    shutil.copy(ROOT / "setup.py", folder)
    for name in FOLDERS:
        if how == "as text":
            (source / name).write_text(f"../../{name}", encoding="utf-8")
        elif how == "as links":
            (source / name).symlink_to(f"../../{name}")
    return folder


def build(folder: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, "setup.py", "--name"],
        cwd=folder,
        check=False,
        capture_output=True,
        text=True,
    )


@pytest.mark.parametrize("how", ["as text", "left out"])
def test_a_copy_without_links_does_not_build(tmp_path: Path, how: str) -> None:
    done = build(made_without_links(tmp_path, how))
    assert done.returncode != 0
    assert "symbolic links to codegen" in done.stderr
    assert "core.symlinks=true" in done.stderr


def test_one_with_links_builds(tmp_path: Path) -> None:
    assert build(made_without_links(tmp_path, "as links")).returncode == 0


def test_every_folder_is_linked() -> None:
    linked = {path.name for path in (ROOT / "src" / "softimpact").iterdir() if path.is_symlink()}
    assert set(FOLDERS) == linked
