# SPDX-License-Identifier: BSD-3-Clause
"""What a report's numbers come from: the command that repeats it, and digests of what went in."""

from __future__ import annotations

import hashlib
import shlex
import sys
from pathlib import Path


def command() -> str:
    """Return the command line that was typed."""
    return shlex.join(["softimpact", *sys.argv[1:]])


def digest_of(path: Path) -> str:
    """Return the SHA-256 of a file, read in parts."""
    with path.open("rb") as file:
        return hashlib.file_digest(file, "sha256").hexdigest()
