# SPDX-License-Identifier: BSD-3-Clause
"""What decides the cost of each source of a package, as a digest.

These are the source, those that it calls, the headers and declarations that they need and the
golden inputs, all without comments. So a further function of a package leaves the others'
measurements valid.
"""

from __future__ import annotations

import hashlib
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import PurePosixPath

from ..bindings.interface import ENUM, FUNCTION, LAYOUT, STRUCT, TABLE

COMMENT = re.compile(r"/\*.*?\*/", re.DOTALL)

DEFINED = re.compile(r"^(?!static |extern )\w[\w *]*\b(\w+)[([]", re.MULTILINE)
"""Names of functions and tables that a source defines, at the beginning of a line."""

ALWAYS = ("VERSION", "MODEL_DIGEST", "LAYOUT")
"""Macros of the header that cost the same whatever they stand for."""


def cost_digests(prefix: str, files: Mapping[str, str]) -> dict[str, str]:
    """Return a digest for each source of a package by its stem.

    Args:
        prefix: of the package's names.
        files: texts by path; those that are no sources, headers or golden inputs do not count.
    """
    package = _Texts(prefix, {path: COMMENT.sub("", text) for path, text in files.items()})
    return {stem: package.digest(stem) for stem in package.sources}


def needed_sources(prefix: str, files: Mapping[str, str], stem: str) -> set[str]:
    """Return the stems of a source and of those that it needs."""
    return _Texts(prefix, {p: COMMENT.sub("", text) for p, text in files.items()}).closure(stem)


@dataclass(frozen=True)
class _Texts:
    """A package's files without comments."""

    prefix: str
    files: Mapping[str, str]

    @cached_property
    def sources(self) -> dict[str, str]:
        """Sources by stem."""
        return {
            PurePosixPath(path).stem: text
            for path, text in self.files.items()
            if path.startswith("src/") and path.endswith(".c")
        }

    @cached_property
    def homes(self) -> dict[str, set[str]]:
        """The sources that define each name; of several the preprocessor takes one."""
        found: dict[str, set[str]] = {}
        for stem, text in self.sources.items():
            for name in DEFINED.findall(text):
                found.setdefault(name, set()).add(stem)
        return found

    def digest(self, stem: str) -> str:
        """Return what decides a source's cost."""
        impacts = f"{self.prefix}_impact.h" in self.sources[stem]
        needed = self.closure(stem) | ({f"{self.prefix}_common"} if impacts else set())  # regions
        sources = [self.sources[s] for s in sorted(needed)]
        texts = [*sources, *self.headers(sources)]
        golden = list(self.golden(impacts=impacts))
        names = set(re.findall(r"\w+", "".join([*texts, *golden])))
        counted = [*texts, *self.declarations(names), *golden]
        squeezed = "\n".join(" ".join(text.split()) for text in counted)
        return hashlib.sha256(squeezed.encode()).hexdigest()[:32]

    def headers(self, texts: list[str]) -> list[str]:
        """Return the headers beside the sources that these, or each other, include."""
        found: dict[str, str] = {}
        waiting = list(texts)
        while waiting:
            for name in re.findall(r'^#include "(.*)"', waiting.pop(), re.MULTILINE):
                path = f"src/{name}"
                if path in self.files and path not in found:
                    found[path] = self.files[path]
                    waiting.append(found[path])
        return [found[path] for path in sorted(found)]

    def closure(self, stem: str) -> set[str]:
        """Return a source and those that it calls, those that these call, and so on."""
        found: set[str] = set()
        waiting = [stem]
        while waiting:
            here = waiting.pop()
            found.add(here)
            named = set(re.findall(r"\w+", self.sources[here]))
            called = set().union(*(self.homes[name] for name in named & self.homes.keys()))
            waiting += sorted(called - found)
        return found

    def declarations(self, names: set[str]) -> Iterator[str]:
        """Yield what the package's header declares of some names."""
        header = LAYOUT.sub("", self.files.get(f"include/{self.prefix}.h", ""))
        for pattern, group in ((STRUCT, 2), (ENUM, 2), (FUNCTION, "name"), (TABLE, 2)):
            yield from (m[0] for m in pattern.finditer(header) if m[group] in names)
        for macro in re.finditer(r"^#define (\w+) .*$", header, re.MULTILINE):
            name = macro[1].removeprefix(f"{self.prefix.upper()}_")
            if macro[1] in names and name not in ALWAYS:
                yield macro[0]

    def golden(self, *, impacts: bool) -> Iterator[str]:
        """Yield the inputs over which costs are counted."""
        tables = ("golden_impacts",) if impacts else ("golden_inputs", "golden_motors")
        text = self.files.get("test/golden.c", "")
        for table in tables:
            yield from re.findall(
                rf"^const \w+ \w+_{table}\[.*?^}};", text, re.DOTALL | re.MULTILINE
            )
