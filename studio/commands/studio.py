# SPDX-License-Identifier: BSD-3-Clause
"""``softimpact studio``: the interactive page of a robot, a study or results."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from ..typed import options as o

GENERATOR = "softimpact studio"
"""Marks a folder as one that may be replaced."""

PAGE = "index.html"

WhatArgument = Annotated[
    str,
    typer.Argument(
        metavar="MODEL|STUDY|RESULTS",
        help="Built-in robot, model file, study (.toml), or folder that design, pareto, program "
        "or map wrote; default the Panda.",
        show_default=False,
    ),
]
OutOption = Annotated[
    Path | None,
    typer.Option(
        "--out", metavar="DIR", help="Write the page there as static files, and open nothing."
    ),
]


def studio(
    what: WhatArgument = "panda",
    out: OutOption = None,
    tip: o.TipOption = None,
    lock: o.LockOption = None,
    hold_base: o.HoldBaseOption = False,
    json: o.JsonOption = False,
) -> None:
    """Explore impacts in the browser: posture, direction, springs, motors; the C computes there."""
    import tempfile
    import webbrowser

    from softimpact.toolchain import usable_cache

    from ..output.printed import print_json, print_warnings, say
    from ..output.results_folder import replaced_folder, require_replaceable_results
    from ..page.opened import opened
    from ..page.write import page_of
    from ..typed.groups import TypedArm

    if out is not None:
        require_replaceable_results(out, GENERATOR)
    asked = TypedArm(what, tip, lock=lock, hold_base=hold_base)
    shown = opened(what, None if asked == TypedArm(what) else asked)
    text = page_of(shown)
    print_warnings(shown.warnings)
    folder = out or (usable_cache() or Path(tempfile.mkdtemp())) / "studio"
    with replaced_folder(folder, GENERATOR) as fresh:
        _write(text, fresh, what)
    page = (folder / PAGE).resolve()
    if json:
        print_json({"page": page, "warnings": shown.warnings})
        return
    if out is not None:
        say(f"wrote {page}")
    if out is None:
        is_open = webbrowser.open(page.as_uri())
        say(f"opened {page}" if is_open else f"open {page} in a browser")


def _write(text: str, folder: Path, what: str) -> None:
    from ..design.report import versions
    from ..output.printed import write_json
    from ..output.results_folder import RESULTS

    (folder / PAGE).write_text(text, encoding="utf-8")
    record = {"generator": GENERATOR, "versions": versions(), "opened": what, "page": PAGE}
    write_json(folder / RESULTS, record)
