# SPDX-License-Identifier: BSD-3-Clause
"""C that calls a package's functions for many rows of arrays.

Closed forms are computed for many rows side by side, in a loop that compilers vectorise: the same
statements over lanes, with sines of their own. Rows that such a loop cannot answer for, be it a
singular one or an angle of many turns, are left to the function itself, whose status they get.
"""

from __future__ import annotations

from dataclasses import fields
from functools import cached_property

import numpy as np

from ..bindings.interface import SIZES, CVariable, Entry, interface_of
from ..inputs.parameters import SCALARS
from ..sources.function import CSource
from .render import Package, Templates

ROWS = "batch/rows.c"

WHOLE = [f for f in fields(CSource) if f.name != "split"]
"""Lanes have a function's graph as a whole: calls would break them up."""


def batch_sources(package: Package, header: str, show: Templates) -> dict[str, str]:
    """Return a source for each function that maps rows to one result, by its path.

    Args:
        package: whose functions they are.
        header: text of its header.
        show: its templates.
    """
    name, closed = package.prefix, {f.function.name: f for f in package.functions}
    interface = interface_of(header, name)
    files = {f"batch/{name}_lanes.h": show("batch/lanes.h")}
    for entry in interface.entries.values():
        if is_mapped(entry):
            source = closed.get(entry.name)
            lanes = Lanes(*(getattr(source, f.name) for f in WHOLE)) if source else None
            files[f"batch/{entry.name}.c"] = show(ROWS, lanes=lanes, **_call(name, entry))
    return files


def is_mapped(entry: Entry) -> bool:
    """Whether a function reads rows of known size and writes one result."""
    read = [a for a in entry.arguments if not a.written]
    sized = all(None not in a.shape for a in entry.arguments)
    plain = all(a.shape or not a.pointer or a.type not in SIZES for a in read)
    return len(entry.arguments) == len(read) + 1 and read[0].name == "q" and sized and plain


def _call(prefix: str, entry: Entry) -> dict[str, object]:
    """Return how rows are passed to a function."""
    arguments = []
    for k, a in enumerate(a for a in entry.arguments if not a.written):
        row = f"ROW({k}, const {_type(prefix, a)} *, i)"
        arguments.append(row if a.pointer else f"*{row}")
    (out,) = [a for a in entry.arguments if a.written]
    kind = _type(prefix, out)
    inner = "".join(f"[{size}]" for size in out.shape[1:])
    target = f"({kind} (*){inner})row" if inner else f"({kind} *)row"
    sizes = "".join(f"[{size}]" for size in out.shape)
    return {"entry": entry, "arguments": arguments, "target": target, "written": f"{kind}{sizes}"}


def _type(prefix: str, a: CVariable) -> str:
    plain = a.type in ("int", "unsigned int", "unsigned char")
    return a.type if plain else f"{prefix}_{a.type}"


class Lanes(CSource):
    """A closed form over lanes: lane ``l`` of a block ``b``."""

    angles = None

    @property
    def places(self) -> list[list[str]]:
        """Where each entry of the inputs stands."""
        return [
            [f"b->q[{i}][l]" for i in range(self.joints)],
            [f"b->n[{i}][l]" for i in range(3)],
            *([f"p->{place}" for place in p.places] for p in self.parameters),
            *([f"b->{p.name}[l]"] for p in SCALARS),
        ]

    @cached_property
    def flat(self) -> list[str]:
        """Return what stands at each place of the outputs, one after the other."""
        found = []
        for output, texts in zip(self.outputs, self.statements.results, strict=False):
            known = dict(zip(output.places, texts, strict=True))
            known |= {place[::-1]: text for place, text in known.items() if output.symmetric}
            found += [known[place] for place in np.ndindex(output.shape)]
        return found
