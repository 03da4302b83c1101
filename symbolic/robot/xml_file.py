# SPDX-License-Identifier: BSD-3-Clause
"""XML as robot files have it: judged by its content, and read without trusting it."""

from __future__ import annotations

import re
from dataclasses import dataclass, field
from pathlib import Path
from xml.parsers import expat

from ..errors import ModelFileError

LARGEST_FILE = 64 * 2**20
"""Bytes of a robot file above which something else must be meant."""

COMMENT = re.compile(r"<!--.*?(-->|\Z)", re.DOTALL)

FIRST_TAG = re.compile(r"<\s*([A-Za-z_][\w.:-]*)")

DECLARATION = re.compile(r"<[?!][^>]*>")


@dataclass(eq=False)
class Element:
    """An XML element: prefixes stay part of its name, declared or not."""

    tag: str
    attributes: dict[str, str]
    line: int
    children: list[Element] = field(default_factory=list)

    def all(self, tag: str) -> list[Element]:
        """Return the children of a name."""
        return [child for child in self.children if child.tag == tag]

    def first(self, tag: str) -> Element | None:
        """Return the first child of a name."""
        return next((child for child in self.children if child.tag == tag), None)

    def get(self, name: str) -> str | None:
        """Return an attribute."""
        return self.attributes.get(name)


def text_of(path: Path) -> str:
    """Return a file's text without comments and byte order mark; lines stay where they are.

    Raises:
        ModelFileError: there is no such file, or it is no text.
    """
    if not path.is_file():
        raise ModelFileError(str(path), "no such file")
    if path.stat().st_size > LARGEST_FILE:
        raise ModelFileError(str(path), f"larger than {LARGEST_FILE // 2**20} MB")
    raw = path.read_bytes()
    try:
        wide = raw.startswith((b"\xff\xfe", b"\xfe\xff"))
        text = raw.decode("utf-16" if wide else "utf-8-sig")
    except UnicodeDecodeError:
        if re.search(rb"encoding\s*=\s*[\"'](?!utf)", raw[:200], re.IGNORECASE) is None:
            raise ModelFileError(str(path), "its names are not in UTF-8") from None
        text = raw.decode("latin-1")
    return COMMENT.sub(lambda match: "\n" * match[0].count("\n"), text)


def root_tag(text: str) -> str | None:
    """Return the name of a text's first element, if it has one."""
    found = FIRST_TAG.search(DECLARATION.sub("", text[:100_000]))
    return found[1] if found else None


def parsed(text: str, source: str) -> Element:
    """Return the root of an XML text; entities are refused, prefixes need no declaration.

    Raises:
        ModelFileError: it is not well-formed.
    """
    parser = expat.ParserCreate("utf-8")
    top = Element("", {}, 0)
    stack = [top]

    def start(tag: str, attributes: dict[str, str]) -> None:
        element = Element(tag, attributes, parser.CurrentLineNumber)
        stack[-1].children.append(element)
        stack.append(element)

    def end(_: str) -> None:
        stack.pop()

    def entity(name: str, *_: object) -> None:
        raise ModelFileError(source, f"declares the entity '{name}', which is not read")

    parser.StartElementHandler = start
    parser.EndElementHandler = end
    parser.EntityDeclHandler = entity
    try:
        parser.Parse(text.strip().encode("utf-8", errors="replace"), True)
    except expat.ExpatError as error:
        raise ModelFileError(source, f"not a URDF or MJCF: {error}") from None
    return top.children[0]
