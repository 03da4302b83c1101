# SPDX-License-Identifier: BSD-3-Clause
"""``softimpact studio``: the interactive page of a robot, a study or results."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from .options import Json

GENERATOR = "softimpact studio"
"""Marks a folder as one that may be replaced."""

PAGE = "index.html"

What = Annotated[
    str,
    typer.Argument(
        metavar="[MODEL|STUDY|RESULTS]",
        help="Built-in robot, model file, study (.toml), or folder that design, pareto or program "
        "wrote.",
        show_default=False,
    ),
]
Out = Annotated[
    Path | None,
    typer.Option(
        "--out", metavar="DIR", help="Write the page there as static files, and open nothing."
    ),
]


def studio(what: What = "panda", out: Out = None, json: Json = False) -> None:
    """Explore impacts in the browser: posture, direction, springs, motors; the C computes there."""
    import webbrowser

    from platformdirs import user_cache_path

    from .output import print_json
    from .page.opened import opened
    from .page.write import page_of
    from .results_folder import replaced_folder, require_replaceable

    if out is not None:
        require_replaceable(out, GENERATOR)
    text = page_of(opened(what))
    folder = out or user_cache_path("softimpact") / "studio"
    with replaced_folder(folder, GENERATOR) as fresh:
        _write(text, fresh, what)
    page = (folder / PAGE).resolve()
    if json:
        print_json({"page": page})
    elif out is not None:
        print(f"wrote {page}")
    if out is None and not webbrowser.open(page.as_uri()) and not json:
        print(f"open {page} in a browser")


def _write(text: str, folder: Path, what: str) -> None:
    from .design_report import versions
    from .output import write_json
    from .results_folder import RESULTS

    (folder / PAGE).write_text(text, encoding="utf-8")
    record = {"generator": GENERATOR, "versions": versions(), "opened": what, "page": PAGE}
    write_json(folder / RESULTS, record)
