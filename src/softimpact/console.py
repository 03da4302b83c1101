# SPDX-License-Identifier: BSD-3-Clause
"""Consoles that do not know every letter: a result is printed, its symbols in plain words."""

from __future__ import annotations

import codecs
import sys
import unicodedata
from html.entities import codepoint2name

PLAIN = "softimpact.plain"

WORDS = str.maketrans(
    {
        "→": "->", "↑": "up", "≤": "<=", "≥": ">=", "×": "x", "·": "*", "−": "-", "–": "-", "…": "...", "∫": "int ", "≻": ">",
        "⪰": ">=",
        "√": "sqrt ", "∞": "inf", "°": " deg", "∂": "d", "∇": "grad ", "∝": "~", "±": "+-",
        "─": "-", "━": "-", "│": "|", "╸": "-", "µ": "u", "‖": "||", "§": "section ", "⟨": "<", "⟩": ">",
    }
)  # fmt: skip


def accept_any_console() -> None:
    """Let stdout and stderr spell what their encoding lacks (cp1252, ASCII) instead of failing."""
    codecs.register_error(PLAIN, _spelled)
    for stream in (sys.stdout, sys.stderr):
        reconfigure = getattr(stream, "reconfigure", None)
        if reconfigure is not None:  # not for what a caller put in its place
            reconfigure(errors=PLAIN)


def _spelled(error: UnicodeError) -> tuple[str, int]:
    if not isinstance(error, UnicodeEncodeError):
        raise error
    lacking = error.object[error.start : error.end]
    return "".join(_plain(character) for character in lacking), error.end


def _plain(character: str) -> str:
    """Return a character in ASCII: its word, its Greek name or its base letter."""
    word = character.translate(WORDS)
    base = word if word.isascii() else unicodedata.normalize("NFKD", word)[0].translate(WORDS)
    if base.isascii():
        return base
    if unicodedata.name(base, "").startswith("GREEK"):
        return codepoint2name.get(ord(base), "?")
    return "" if unicodedata.combining(base) else "?"
