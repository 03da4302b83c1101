# SPDX-License-Identifier: BSD-3-Clause
"""Names of packages: what a robot is called, as C, CMake, linkers and file systems can have it."""

from __future__ import annotations

import re
import unicodedata
import zlib

LONGEST_NAME = 40
"""Letters of a name; with those of a function they stay below the 63 that C99 tells apart."""

HEADERS = frozenset((
    "assert", "complex", "ctype", "errno", "fenv", "float", "inttypes", "iso646", "limits",
    "locale", "math", "setjmp", "signal", "stdalign", "stdarg", "stdatomic", "stdbit", "stdbool",
    "stdckdint", "stddef", "stdint", "stdio", "stdlib", "stdnoreturn", "string", "tgmath",
    "threads", "time", "uchar", "wchar", "wctype", "golden",
))  # fmt: skip
"""Headers of C, and of a package's own test."""

LIMITS = frozenset(("dbl", "flt", "ldbl", "math", "size", "int", "fp", "arm"))
"""Prefixes of macros or types of C's headers and of DSP libraries (``arm_status``)."""

TARGETS = frozenset((
    "all", "clean", "edit_cache", "help", "install", "package", "rebuild_cache", "test",
    "c", "dl", "gcc", "m", "pthread", "rt", "util",
))  # fmt: skip
"""Targets of CMake, and libraries that linkers look for by such a name."""

DEVICES = re.compile(r"aux|con|nul|prn|(com|lpt)\d")
"""Files that Windows cannot have."""

INNER = frozenset((
    "body", "check", "config", "contact", "damping", "default", "directional", "driven", "fill",
    "find", "foreign", "frame", "free", "generalised", "generalised_mass", "golden", "impact",
    "internal", "is", "joint", "kinds_of", "law", "mass", "may", "phase", "reduced", "select",
    "servo", "single_joint", "state", "steps_of", "stiffness", "twice_energy_of",
))  # fmt: skip
"""What packages' own names begin with: ``arm_contact_jacobian`` is a function of ``arm``, and would
be one of a package ``arm_contact``; linkers would take either for both."""


def c_name(name: str) -> str:
    """Return a C identifier in lower case for a robot's name, fit for headers, CMake and linkers.

    Packages with different names of this kind can be parts of one program.
    """
    plain = unicodedata.normalize("NFKD", name).encode("ascii", "ignore").decode()
    words = re.sub(r"[^a-z0-9]+", "_", plain.lower()).strip("_")
    if len(words) > LONGEST_NAME:
        words = f"{words[: LONGEST_NAME - 9].rstrip('_')}_{zlib.crc32(words.encode()):08x}"
    taken = words in HEADERS | LIMITS | TARGETS or DEVICES.fullmatch(words)
    if taken or not words[:1].isalpha():
        words = f"robot_{words}".rstrip("_")
    inner = any(words.endswith(f"_{end}") for end in INNER)
    return f"{words}_robot" if inner else words
