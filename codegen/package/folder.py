# SPDX-License-Identifier: BSD-3-Clause
"""A folder of results that is replaced as a whole or not at all."""

from __future__ import annotations

import shutil
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

from softimpact.symbolic import SoftImpactError

FolderCheck = Callable[[Path], None]
"""Raises ForeignFolder if a folder holds anything but what was written by us."""


class ForeignFolder(SoftImpactError):
    """An output folder holds what we did not write, or what was edited since."""

    def __init__(self, folder: Path, held: str) -> None:
        self.folder, self.held = folder, held
        super().__init__(
            f"{folder}: not overwritten, because it holds {held}; "
            "move that away or choose another folder"
        )


class FolderNotWritable(SoftImpactError):
    """The operating system refuses an output folder."""

    def __init__(self, folder: Path, reason: str) -> None:
        self.folder, self.reason = folder, reason
        super().__init__(f"{folder}: cannot be written ({reason}); choose another folder")


@contextmanager
def refusals(folder: Path, inside: Path | None = None) -> Iterator[None]:
    """Raise FolderNotWritable for what the operating system refuses.

    Args:
        folder: that is to be written.
        inside: what another file than one in here meets goes on as it is; a full disk has no file.
    """
    try:
        yield
    except OSError as error:
        name = error.filename
        if inside and name is not None and not Path(name).is_relative_to(inside):
            raise
        raise FolderNotWritable(folder, error.strerror or str(error)) from error


@contextmanager
def replaced(folder: Path, check: FolderCheck) -> Iterator[Path]:
    """Give a fresh folder to fill; on success it takes the place of an older one.

    It lies beside the folder, which is then exchanged for it. Whatever interrupts this, the older
    one stays whole: in its place, or as ``.NAME.previous`` beside it, from where the next call
    brings it back.

    Args:
        folder: where the results belong, an absolute path.
        check: of what is in the way.
    """
    require_replaceable(folder, check)
    with refusals(folder):
        fresh = Path(tempfile.mkdtemp(prefix=f".{folder.name}.", dir=folder.parent))
    try:
        with refusals(folder, fresh):
            yield fresh
        with refusals(folder):
            fresh.chmod(0o755)  # temporary folders are private, results are not
            _exchange(folder, fresh)
    finally:
        shutil.rmtree(fresh, ignore_errors=True)


def require_replaceable(folder: Path, check: FolderCheck) -> None:
    """Raise ForeignFolder or FolderNotWritable if a folder could not be replaced.

    Called before long work, so that it is not lost for want of a place.
    """
    if folder.is_mount() or Path.cwd().is_relative_to(folder):
        raise FolderNotWritable(folder, "a folder in use cannot be replaced: name one in it")
    with refusals(folder):
        folder.parent.mkdir(parents=True, exist_ok=True)
        with tempfile.TemporaryDirectory(prefix=f".{folder.name}.", dir=folder.parent):
            pass
        _restore_interrupted(folder, check)
        check(folder)


def _previous(folder: Path) -> Path:
    return folder.with_name(f".{folder.name}.previous")


def _restore_interrupted(folder: Path, check: FolderCheck) -> None:
    previous = _previous(folder)
    if not previous.exists():
        return
    check(previous)
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
