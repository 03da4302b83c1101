# SPDX-License-Identifier: BSD-3-Clause
"""Progress of long searches, on stderr: a bar, or where nobody can see one, a line now and then."""

from __future__ import annotations

from time import monotonic
from typing import Any

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TaskID, TimeElapsedColumn

from softimpact.toolchain import c_compiler

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
    columns = ("{task.description}", BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    return Progress(*columns, console=console)


def optimiser_bar() -> Progress:
    """Return the bar of an optimiser, and say first if it has no C compiler."""
    bar = progress_bar()
    if c_compiler() is None:
        bar.console.print(
            "No C compiler found: CasADi's virtual machine does the work, some ten times slower."
        )
    return bar
