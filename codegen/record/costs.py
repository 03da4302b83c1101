# SPDX-License-Identifier: BSD-3-Clause
"""What a package's functions cost on a microcontroller, where that has been measured.

Generating needs no cross compiler: the numbers are data beside this file, written by
``make bench-c`` for the built-in robots. Each belongs to certain sources and no others.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from .cost_digests import cost_digests

COSTS = Path(__file__).parent / "costs"
"""One file a package, named by its prefix."""

FEW_STEPS = 185
"""Budget of the safe speed that is counted apart: motors drive on, released after 20 ms, 0.1 s. The
largest round number whose proven bound on time is within the design's 240,000 instructions."""


@dataclass(frozen=True)
class Instructions:
    """Instructions of a call, on average over a package's golden inputs and at most."""

    mean: int
    most: int


@dataclass(frozen=True)
class FunctionCost:
    """Cost of a function in a float build.

    Attributes:
        name: of the C function, and in brackets the case that was measured, if it is special.
        m4: instructions on a Cortex-M4F.
        m7: instructions on a Cortex-M7.
        text: code of the source it stands in, on the M7 [bytes].
        rodata: constants of that source [bytes].
        stack: deepest of it and whatever it calls in the package, on the M7 [bytes].
        digest: of what was measured, see ``cost_digests``.
        bound: instructions on the M7 that no input exceeds, by the longest path through the
            compiled code; None where that was not looked for.
    """

    name: str
    m4: Instructions
    m7: Instructions
    text: int
    rodata: int
    stack: int
    digest: str
    bound: int | None = None

    @property
    def function(self) -> str:
        """Name of the C function."""
        return self.name.split()[0]


@dataclass(frozen=True)
class SharedCost:
    """Code and constants [bytes] of a source that holds none of the functions above."""

    name: str
    text: int
    rodata: int
    digest: str


@dataclass(frozen=True)
class Costs:
    """Costs of a package.

    Attributes:
        compiler: and its version.
        flags: that optimise.
        functions: costs of each.
        shared: sources that they share.
    """

    compiler: str
    flags: str
    functions: tuple[FunctionCost, ...]
    shared: tuple[SharedCost, ...]

    def to_json(self) -> str:
        """Return the text of the file that ``stored_costs`` reads."""
        return json.dumps(asdict(self), indent=2) + "\n"


def stored_costs(prefix: str, files: Mapping[str, str]) -> Costs | None:
    """Return what was measured of a package's present sources; None if nothing was.

    Args:
        prefix: of the package's names.
        files: texts by path.
    """
    path = COSTS / f"{prefix}.json"
    if not path.is_file():
        return None
    costs = _from_json(path.read_text(encoding="utf-8"))
    digests = cost_digests(prefix, files)
    functions = tuple(f for f in costs.functions if f.digest == digests.get(f.function))
    shared = tuple(s for s in costs.shared if s.digest == digests.get(s.name))
    return replace(costs, functions=functions, shared=shared) if functions else None


def _from_json(text: str) -> Costs:
    read = json.loads(text)
    functions = [
        FunctionCost(**{**f, "m4": Instructions(**f["m4"]), "m7": Instructions(**f["m7"])})
        for f in read["functions"]
    ]
    shared = [SharedCost(**s) for s in read["shared"]]
    return Costs(**{**read, "functions": tuple(functions), "shared": tuple(shared)})
