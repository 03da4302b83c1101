# SPDX-License-Identifier: BSD-3-Clause
"""A folder of results that is replaced as a whole or not at all."""

from __future__ import annotations

import json
import shutil
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from softimpact.symbolic import SoftImpactError

RESULTS = "results.json"


class ForeignFolder(SoftImpactError):
    """The output folder holds files that an earlier run of the same command did not write."""

    def __init__(self, folder: Path, generator: str) -> None:
        self.folder, self.generator = folder, generator
        super().__init__(
            f"{folder}: exists and holds no earlier results of '{generator}'; choose another --out"
        )


class FolderNotWritable(SoftImpactError):
    """The operating system refuses the output folder."""

    def __init__(self, folder: Path, reason: str) -> None:
        self.folder, self.reason = folder, reason
        super().__init__(f"{folder}: cannot be written ({reason}); choose another --out")


def require_replaceable(folder: Path, generator: str) -> None:
    """Raise ForeignFolder or FolderNotWritable if results could not be written.

    Called before long work, so that it is not lost for want of a place.
    """
    place = folder.resolve()
    if place.is_mount() or Path.cwd().is_relative_to(place):
        raise FolderNotWritable(folder, "a folder in use cannot be replaced: name one in it")
    try:
        place.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=f".{place.name}.", dir=place.parent):
            pass
    except OSError as error:
        raise FolderNotWritable(folder, error.strerror or str(error)) from error
    if not folder.exists():
        return
    if not folder.is_dir() or (any(folder.iterdir()) and not _is_ours(folder, generator)):
        raise ForeignFolder(folder, generator)


def _is_ours(folder: Path, generator: str) -> bool:
    try:
        record = json.loads((folder / RESULTS).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return False
    return isinstance(record, dict) and record.get("generator") == generator


@contextmanager
def replaced_folder(folder: Path, generator: str) -> Iterator[Path]:
    """Give a fresh folder to fill; on success it takes the place of an older one.

    Args:
        folder: where the results belong.
        generator: that marks the results of earlier runs.
    """
    require_replaceable(folder, generator)
    place = folder.resolve()  # of a link, the folder that it leads to
    fresh = Path(tempfile.mkdtemp(prefix=f".{place.name}.", dir=place.parent))
    old = fresh.with_name(f"{fresh.name}.old")
    try:
        yield fresh
        fresh.chmod(0o755)
        if place.exists():
            place.rename(old)
        fresh.rename(place)
    finally:
        if old.exists() and not place.exists():
            old.rename(place)
        for left in (fresh, old):
            shutil.rmtree(left, ignore_errors=True)
