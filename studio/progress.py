# SPDX-License-Identifier: BSD-3-Clause
"""Progress of long searches, on stderr."""

from __future__ import annotations

import threading
from collections.abc import Iterator
from contextlib import contextmanager

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    SpinnerColumn,
    TextColumn,
    TimeElapsedColumn,
)

PATIENCE = 2.0
"""Time after which a terminal shows that a command is at work [s]."""


@contextmanager
def working(what: str | None) -> Iterator[None]:
    """Show a clock on stderr after ``PATIENCE``, if that is a terminal and there is something."""
    console = Console(stderr=True)
    if what is None or not console.is_terminal:
        yield
        return
    clock = Progress(
        SpinnerColumn(), TextColumn(what), TimeElapsedColumn(), console=console, transient=True
    )
    clock.add_task(what, total=None)
    timer = threading.Timer(PATIENCE, clock.start)
    timer.daemon = True
    timer.start()
    try:
        yield
    finally:
        timer.cancel()
        timer.join()
        clock.stop()


def progress_bar() -> Progress:
    """Return a bar to use with ``with``."""
    columns = ("{task.description}", BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    return Progress(*columns, console=Console(stderr=True))


def optimiser_bar() -> Progress:
    """Return the bar of an optimiser, and say first if it has no C compiler."""
    from softimpact.optimize.compiled import c_compiler

    bar = progress_bar()
    if c_compiler() is None:
        bar.console.print(
            "No C compiler found: CasADi's virtual machine does the work, some ten times slower."
        )
    return bar
