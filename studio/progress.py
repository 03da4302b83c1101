# SPDX-License-Identifier: BSD-3-Clause
"""Progress of long searches, on stderr."""

from __future__ import annotations

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TimeElapsedColumn

from softimpact.optimize.compiled import c_compiler


def progress_bar() -> Progress:
    """Return a bar to use with ``with``; says first if there is no C compiler."""
    console = Console(stderr=True)
    if c_compiler() is None:
        console.print(
            "No C compiler found: CasADi's virtual machine does the work, some ten times slower."
        )
    columns = ("{task.description}", BarColumn(), MofNCompleteColumn(), TimeElapsedColumn())
    return Progress(*columns, console=console)
