# SPDX-License-Identifier: BSD-3-Clause
"""Why figures of impacts do not apply, for the tables that show them as dashes."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from typing import Protocol

from .printed import say, tables_are_csv


class _Figures(Protocol):
    """Figures of one impact; see ``softimpact.symbolic.Analysis``."""

    @property
    def k_r(self) -> float | None: ...
    @property
    def m_a(self) -> float | None: ...
    @property
    def giaf(self) -> float | None: ...


FEWER = "the point cannot move in all three directions there"

NO_PUSH = "– k_c: no spring or servo (--position-gain) holds all that a slow push moves"


def reasons(found: Iterable[_Figures]) -> Iterator[str]:
    """Yield a line for each kind of figure that some impact lacks."""
    figures = list(found)
    if any(each.k_r is None for each in figures):
        yield "– k_r, m_a: the impact loads no spring (--joint-stiffness)"
    if any(each.m_a is None and each.k_r is not None for each in figures):
        yield "– m_a: nothing moves behind the spring"
    if any(each.giaf is None for each in figures):
        yield f"– GIAF and its kin: {FEWER}"


def explain(lines: Iterable[str]) -> None:
    """Print the reasons below a table, with an empty line after them; CSV has no dashes."""
    said = list(lines)
    if said and not tables_are_csv():
        say("\n".join([*said, ""]))
