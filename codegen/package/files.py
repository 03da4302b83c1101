# SPDX-License-Identifier: BSD-3-Clause
"""Writing a package, and telling it from other folders."""

from __future__ import annotations

import hashlib
import json
import os
from collections.abc import Mapping
from pathlib import Path

from ..record.manifest import GENERATOR, MANIFEST
from .folder import ForeignFolder, refusals, replaced, require_replaceable


def sha256(text: str) -> str:
    """Return the hash under which the manifest lists a file."""
    return hashlib.sha256(text.encode()).hexdigest()


def replace_package(folder: Path, files: Mapping[str, str]) -> None:
    """Write a package, replacing an older one as a whole.

    Args:
        folder: of the package.
        files: texts by path in it.

    Raises:
        ForeignFolder: it holds files that the generator did not write.
        FolderNotWritable: the operating system refuses.
    """
    folder = Path(os.path.abspath(folder))
    with replaced(folder, require_own) as fresh, refusals(folder):
        for name, text in files.items():
            path = fresh / name
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(text, encoding="utf-8", newline="\n")


def require_place(folder: Path) -> None:
    """Raise ForeignFolder or FolderNotWritable if a package could not be written."""
    require_replaceable(Path(os.path.abspath(folder)), require_own)


def require_own(folder: Path) -> None:
    """Raise ForeignFolder if a folder holds anything but a package as it was generated."""
    if not folder.exists() and not folder.is_symlink():
        return
    if folder.is_symlink() or not folder.is_dir():
        raise ForeignFolder(folder, "no package")
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
        shown = ", ".join(foreign[:5]) + (", …" if len(foreign) > 5 else "")
        raise ForeignFolder(folder, f"what was not generated or was edited since ({shown})")


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
