# SPDX-License-Identifier: BSD-3-Clause
"""Writing a package as a whole or not at all."""

from __future__ import annotations

import hashlib
import json
import os
import shutil
import tempfile
from collections.abc import Mapping
from pathlib import Path

from .errors import ForeignFiles, OutputNotWritable
from .manifest import GENERATOR, MANIFEST


def sha256(text: str) -> str:
    """Return the hash under which the manifest lists a file."""
    return hashlib.sha256(text.encode()).hexdigest()


def replace_package(folder: Path, files: Mapping[str, str]) -> None:
    """Write a package, replacing an older one.

    The files are written beside the folder, which is then exchanged for them. Whatever interrupts
    this, the older package stays whole: in its place, or as ``.NAME.previous`` beside it, from
    where the next call brings it back.

    Args:
        folder: of the package.
        files: texts by path in it.

    Raises:
        ForeignFiles: the folder holds files that the generator did not write.
        OutputNotWritable: the operating system refuses.
    """
    folder = Path(os.path.abspath(folder))
    try:
        folder.parent.mkdir(parents=True, exist_ok=True)
        _restore_interrupted(folder)
        require_own(folder)
        fresh = Path(tempfile.mkdtemp(prefix=f".{folder.name}.", dir=folder.parent))
        try:
            _write(fresh, files)
            _exchange(folder, fresh)
        finally:
            shutil.rmtree(fresh, ignore_errors=True)
    except OSError as error:
        raise OutputNotWritable(folder, error.strerror or str(error)) from error


def require_own(folder: Path) -> None:
    """Raise ForeignFiles if a folder holds anything but a package as it was generated."""
    if not folder.exists() and not folder.is_symlink():
        return
    if folder.is_symlink() or not folder.is_dir():
        raise ForeignFiles(folder, [folder.name])
    written = _written_files(folder)
    files = (p for p in folder.rglob("*") if p.is_symlink() or not p.is_dir())
    found = {p.relative_to(folder).as_posix(): p for p in files}
    foreign = [
        name
        for name, path in sorted(found.items())
        if name not in written
        or path.is_symlink()
        or written[name] != hashlib.sha256(path.read_bytes()).hexdigest()
    ]
    if foreign:
        raise ForeignFiles(folder, foreign)


def _written_files(folder: Path) -> dict[str, str]:
    """Hashes of the files that the generator wrote; empty if this is no package."""
    path = folder / MANIFEST
    try:
        text = path.read_text(encoding="utf-8")
        manifest = json.loads(text)
    except (OSError, ValueError):
        return {}
    if not isinstance(manifest, dict) or manifest.get("generator") != GENERATOR:
        return {}
    return {MANIFEST: sha256(text), **manifest.get("files", {})}


def _write(folder: Path, files: Mapping[str, str]) -> None:
    folder.chmod(0o755)  # temporary folders are private, packages are not
    for name, text in files.items():
        path = folder / name
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(text, encoding="utf-8", newline="\n")


def _previous(folder: Path) -> Path:
    return folder.with_name(f".{folder.name}.previous")


def _restore_interrupted(folder: Path) -> None:
    previous = _previous(folder)
    if not previous.exists():
        return
    require_own(previous)
    if folder.exists():
        shutil.rmtree(previous)
    else:
        previous.rename(folder)


def _exchange(folder: Path, fresh: Path) -> None:
    previous = _previous(folder)
    if folder.exists():
        folder.rename(previous)
    try:
        fresh.rename(folder)
    except BaseException:
        if previous.exists():
            previous.rename(folder)
        raise
    if previous.exists():
        shutil.rmtree(previous)
