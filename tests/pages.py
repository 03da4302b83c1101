# SPDX-License-Identifier: BSD-3-Clause
"""Whether a page of HTML is well-formed and needs nothing else."""

from __future__ import annotations

import re
from html.parser import HTMLParser


class _Checker(HTMLParser):
    """Notes open elements, so that a page that is not well-formed is seen, and all targets."""

    VOID = frozenset({"meta", "line", "circle", "path", "use", "br"})

    def __init__(self) -> None:
        super().__init__()
        self.open: list[str] = []
        self.targets: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.targets += [value or "" for name, value in attrs if name in ("src", "href")]
        if tag not in self.VOID:
            self.open.append(tag)

    def handle_endtag(self, tag: str) -> None:
        if tag not in self.VOID:
            assert self.open.pop() == tag


def well_formed(page: str) -> bool:
    """Whether all elements are closed, and nothing is loaded from elsewhere."""
    checker = _Checker()
    checker.feed(page)
    inside = all(target == "" or target.startswith("#") for target in checker.targets)
    return checker.open == [] and inside and "url(" not in re.sub(r"url\(#\w+\)", "", page)
