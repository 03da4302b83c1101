# SPDX-License-Identifier: BSD-3-Clause
"""Progress of long searches, on stderr: a bar, or where nobody can see one, a line now and then."""

from __future__ import annotations

import threading
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from time import monotonic
from typing import Any

from rich.console import Console
from rich.progress import (
    BarColumn,
    MofNCompleteColumn,
    Progress,
    SpinnerColumn,
    TaskID,
    TextColumn,
    TimeElapsedColumn,
    TimeRemainingColumn,
)

from softimpact.toolchain import c_compiler

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


BETWEEN_LINES = 10.0
"""Seconds between two lines of progress in a file or a pipe."""


class _Lines(Progress):
    """A bar's stand-in for consoles that are no terminals."""

    def __init__(self, console: Console) -> None:
        super().__init__(console=console, disable=True)
        self.begun = self.said = monotonic()

    def update(self, task_id: TaskID, **fields: Any) -> None:
        super().update(task_id, **fields)
        self._say(task_id)

    def advance(self, task_id: TaskID, advance: float = 1) -> None:
        super().advance(task_id, advance)
        self._say(task_id)

    def _say(self, task_id: TaskID) -> None:
        now = monotonic()
        if now - self.said < BETWEEN_LINES:
            return
        self.said = now
        task = next(task for task in self.tasks if task.id == task_id)
        of = "" if task.total is None else f" of {task.total:.0f}"
        line = f"{task.description}: {task.completed:.0f}{of}, {now - self.begun:.0f} s"
        self.console.print(line, soft_wrap=True, highlight=False, markup=False)


def progress_bar() -> Progress:
    """Return a bar to use with ``with``."""
    console = Console(stderr=True)
    if not console.is_terminal:
        return _Lines(console)
    columns = (
        "{task.description}",
        BarColumn(),
        MofNCompleteColumn(),
        TimeElapsedColumn(),
        "gone,",
        TimeRemainingColumn(),
        "left",
    )
    return Progress(*columns, console=console)


@contextmanager
def optimiser_stages() -> Iterator[Callable[[str, int, int], None]]:
    """Show the bar of an optimiser; yield what tells it what is done of what."""
    with optimiser_bar() as bar:
        task = bar.add_task("compile", total=None)

        def advance(what: str, done: int, total: int) -> None:
            bar.update(task, description=what, completed=done, total=total)

        yield advance


def optimiser_bar() -> Progress:
    """Return the bar of an optimiser, and say first if it has no C compiler."""
    bar = progress_bar()
    if c_compiler() is None:
        bar.console.print(
            "No C compiler found: CasADi's virtual machine does the work, some ten times slower."
        )
    return bar
