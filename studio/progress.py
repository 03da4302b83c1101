# SPDX-License-Identifier: BSD-3-Clause
"""Progress of long searches, on stderr."""

from __future__ import annotations

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TimeElapsedColumn

from softimpact.optimize.compiled import c_compiler


def progress_bar() -> Progress:
    """Return a bar to use with ``with``."""
    columns = ("{task.description}", BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    return Progress(*columns, console=Console(stderr=True))


def optimiser_bar() -> Progress:
    """Return the bar of an optimiser, and say first if it has no C compiler."""
    bar = progress_bar()
    if c_compiler() is None:
        bar.console.print(
            "No C compiler found: CasADi's virtual machine does the work, some ten times slower."
        )
    return bar
