# SPDX-License-Identifier: BSD-3-Clause
"""A report as data, and the page that it becomes."""

from __future__ import annotations

import io
import json
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import jinja2
from markupsafe import Markup
from matplotlib.figure import Figure

from softimpact.symbolic.record import plain
from softimpact.symbolic.robot.rigid import Array

from ..output.printed import Cell, shown

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
class Hit:
    """Where an arm hits something.

    Attributes:
        place: of the contact point [m], length 3.
        direction: in which it moves, length 3; None draws no arrow.
        share: of the limit that the impact uses, which colours it.
    """

    place: Array
    direction: Array | None
    share: float


@dataclass(frozen=True)
class ArmPicture:
    """An arm that one can turn.

    Attributes:
        points: from the base to the end of the arm [m], k×3.
        hits: on the way, coloured by their share of the limit.
        words: what the picture shows, for who cannot see it.
        faint: other postures, drawn behind.
    """

    points: Array
    hits: Sequence[Hit]
    words: str
    faint: Sequence[Array] = ()


@dataclass(frozen=True, eq=False)
class Section:
    """A part of a report.

    Attributes:
        title: of the part.
        words: paragraphs before the rest.
        figure: a picture, if any, and what it shows.
        caption: of the figure; also its words for who cannot see it.
        arms: to turn.
        tables: after the figures.
        lines: a list at the end.
    """

    title: str
    words: Sequence[str] = ()
    figure: Figure | None = None
    caption: str = ""
    arms: Sequence[ArmPicture] = ()
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
    environment.filters["data"] = _as_data
    text = environment.get_template("report.html.jinja").render(page=page)
    path.write_text(text, encoding="utf-8")
    return path


def _as_data(value: Any) -> str:
    """Return something as JSON, which the template escapes."""
    return json.dumps(plain(value), ensure_ascii=False)


def as_svg(figure: Figure) -> Markup:
    """Return a figure as SVG that stands inside of a page; the same figure, the same bytes."""
    from matplotlib import rc_context

    stream = io.StringIO()
    with rc_context({"svg.hashsalt": "softimpact", "svg.fonttype": "path"}):
        figure.savefig(stream, format="svg", metadata={"Date": None}, transparent=True)
    text = stream.getvalue()
    return Markup(text[text.index("<svg") :])
