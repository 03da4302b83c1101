# SPDX-License-Identifier: BSD-3-Clause
"""The C compiler, and where compiled code is kept, for whatever is compiled at run time."""

from __future__ import annotations

import atexit
import os
import shlex
import shutil
import tempfile
from functools import cache
from pathlib import Path

from platformdirs import user_cache_path

Command = tuple[str, ...]
"""Words of a command line."""

WELL_KNOWN = [["cc"], ["gcc"], ["clang"]]


def c_compiler() -> Command | None:
    """Return the C compiler: $CC, or the first of cc, gcc and clang; None if there is none.

    $CC may be a command of several words, such as ``ccache gcc``.
    """
    named = os.environ.get("CC")
    commands = [[named], shlex.split(named, posix=os.name != "nt")] if named else WELL_KNOWN
    for first, *others in filter(None, commands):
        found = shutil.which(first)
        if found:
            return (found, *others)
    return None


def cache_folder() -> Path | None:
    """Return the folder of compiled functions: $SOFTIMPACT_CACHE, or the user's cache.

    None for a user without a home.
    """
    named = os.environ.get("SOFTIMPACT_CACHE")
    if named:
        return Path(named)
    try:
        found = user_cache_path("softimpact", appauthor=False)
    except RuntimeError:
        return None
    return found if found.is_absolute() else None  # older versions of platformdirs return ~


def usable_cache() -> Path | None:
    """Return ``cache_folder``, made if need be; None where there is none or it cannot be written."""
    folder = cache_folder()
    return folder if folder is not None and _made(folder) else None


@cache
def passing_folder() -> Path:
    """Return a folder for this process alone, where no cache can be used."""
    folder = Path(tempfile.mkdtemp(prefix="softimpact-"))
    atexit.register(shutil.rmtree, folder, ignore_errors=True)
    return folder


def zig_environment() -> dict[str, str]:
    """Return this process's environment with a cache for Zig, without which it does not run."""
    told = os.name == "nt" or any(os.environ.get(name) for name in ("XDG_CACHE_HOME", "HOME"))
    if told and _made(user_cache_path("zig", appauthor=False)):
        return dict(os.environ)
    place = (usable_cache() or passing_folder()) / "zig"
    return {"ZIG_GLOBAL_CACHE_DIR": str(place), **os.environ}


def _made(folder: Path) -> bool:
    """Return whether a folder is there or could be made, and can be written."""
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return False
    return os.access(folder, os.W_OK)
