# SPDX-License-Identifier: BSD-3-Clause
"""The C compiler, and where compiled code is kept, for whatever is compiled at run time."""

from __future__ import annotations

import os
import shlex
import shutil
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
    if folder is None:
        return None
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError:
        return None
    return folder if os.access(folder, os.W_OK) else None
