# SPDX-License-Identifier: BSD-3-Clause
"""What every command has: ``--csv`` for its tables, ``--verbose``, and a sign of life."""

from __future__ import annotations

import inspect
import logging
import sys
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from functools import wraps
from typing import Annotated, Any

import typer

from ..typed.groups import groups_of

LOGGER = logging.getLogger("softimpact")

CsvOption = Annotated[bool, typer.Option("--csv", help="Print tables as CSV, numbers in full.")]
VerboseOption = Annotated[
    bool, typer.Option("--verbose", "-v", help="Say on stderr what is being done.")
]


def common(command: Callable[..., None], waiting: str | None = None) -> Callable[..., None]:
    """Return a command with the options that all have.

    Args:
        command: its parameters are the command line's; groups of them stand in ``typed``.
        waiting: what it is about, shown on a terminal once it has taken two seconds; None where
            the command shows its progress itself.
    """
    own = inspect.signature(command, eval_str=True)
    groups = groups_of(own.parameters)

    @wraps(command)
    def with_common(*, csv: bool, verbose: bool, **options: Any) -> None:
        from softimpact.symbolic import InvalidValue

        from ..output.printed import tables_as_csv
        from ..output.progress import working

        if csv and options.get("json"):
            raise InvalidValue("csv", "excludes json; give one of them")
        with spoken(command.__name__, verbose), tables_as_csv(csv), working(waiting):
            command(**{name: group.taken(options) for name, group in groups.items()}, **options)

    ours = [
        inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=False, annotation=kind)
        for name, kind in (("csv", CsvOption), ("verbose", VerboseOption))
    ]
    parameters = [
        each.replace(kind=inspect.Parameter.KEYWORD_ONLY)
        for name, parameter in own.parameters.items()
        for each in (groups[name].parameters if name in groups else (parameter,))
    ]
    with_common.__signature__ = own.replace(parameters=[*parameters, *ours])  # type: ignore[attr-defined]
    with_common.__annotations__ = {p.name: p.annotation for p in [*parameters, *ours]}
    return with_common


@contextmanager
def spoken(name: str, wanted: bool) -> Iterator[None]:
    """Print what the project's loggers say to stderr, if wanted, and how long it all took."""
    if not wanted:
        yield
        return
    handler = logging.StreamHandler(sys.stderr)
    handler.setFormatter(logging.Formatter("%(relativeCreated)6.0f ms  %(message)s"))
    level, begin = LOGGER.level, time.perf_counter()
    LOGGER.addHandler(handler)
    LOGGER.setLevel(logging.INFO)
    try:
        yield
        LOGGER.info("%s took %.2f s", name.replace("_", "-"), time.perf_counter() - begin)
    finally:
        LOGGER.removeHandler(handler)
        LOGGER.setLevel(level)
