# SPDX-License-Identifier: BSD-3-Clause
"""A report as data, and the page that it becomes."""

from __future__ import annotations

import io
import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path

import jinja2
from markupsafe import Markup
from matplotlib.figure import Figure

from ..output import Cell, shown

TEMPLATES = Path(__file__).parent / "templates"


@dataclass(frozen=True)
class TableOfNumbers:
    """A table.

    Attributes:
        title: what it shows.
        columns: their heads.
        rows: numbers to four digits, words, or None for what does not apply.
    """

    title: str
    columns: Sequence[str]
    rows: Sequence[Sequence[Cell]]


@dataclass(frozen=True)
class ArmPicture:
    """An arm that one can turn.

    Attributes:
        points: from the base to the end of the arm [m], k×3.
        contact: where it is hit [m], length 3.
        direction: in which the contact point moves, length 3.
        share: of the limit that the impact uses, which colours the arrow.
        words: what the picture shows, for who cannot see it.
    """

    points: Sequence[Sequence[float]]
    contact: Sequence[float]
    direction: Sequence[float]
    share: float
    words: str


@dataclass(frozen=True, eq=False)
class Section:
    """A part of a report.

    Attributes:
        title: of the part.
        words: paragraphs before the rest.
        figure: a picture, if any, and what it shows.
        caption: of the figure; also its words for who cannot see it.
        arm: an arm to turn, if any.
        tables: after the figures.
        lines: a list at the end.
    """

    title: str
    words: Sequence[str] = ()
    figure: Figure | None = None
    caption: str = ""
    arm: ArmPicture | None = None
    tables: Sequence[TableOfNumbers] = ()
    lines: Sequence[str] = ()


@dataclass(frozen=True, eq=False)
class Page:
    """A report.

    Attributes:
        question: that was asked; the page's title.
        answer: in a sentence.
        is_good: whether the answer is what one hopes for; None where there is no such thing.
        sections: the rest.
        command: that repeats it.
        versions: of the software.
        digests: of what went in.
    """

    question: str
    answer: str
    sections: Sequence[Section]
    command: str
    versions: dict[str, str]
    is_good: bool | None = None
    digests: dict[str, str] = field(default_factory=dict)


def write_page(page: Page, path: Path) -> Path:
    """Write a report as one self-contained HTML file."""
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(TEMPLATES),
        undefined=jinja2.StrictUndefined,
        autoescape=True,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["shown"] = shown
    environment.filters["svg"] = as_svg
    environment.filters["data"] = lambda value: Markup(json.dumps(value).replace("<", "\\u003c"))
    text = environment.get_template("report.html.jinja").render(page=page)
    path.write_text(text, encoding="utf-8")
    return path


def as_svg(figure: Figure) -> Markup:
    """Return a figure as SVG that stands inside of a page; the same figure, the same bytes."""
    from matplotlib import rc_context

    stream = io.StringIO()
    with rc_context({"svg.hashsalt": "softimpact", "svg.fonttype": "path"}):
        figure.savefig(stream, format="svg", metadata={"Date": None}, transparent=True)
    text = stream.getvalue()
    return Markup(text[text.index("<svg") :])
