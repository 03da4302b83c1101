# SPDX-License-Identifier: BSD-3-Clause
"""docs/python.md lists every public name, grouped, each with the first line of its docstring.

Renew it with ``python tests/docs/test_python_page.py``.
"""

from __future__ import annotations

import inspect
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path
from typing import Any

PAGE = Path(__file__).resolve().parents[2] / "docs" / "python.md"

GROUPS = {
    "robot": "Robots: reading, welding, payload",
    "dynamics": "Kinematics and dynamics",
    "loops": "Closed chains",
    "impact": "Impacts: motors, springs, reductions",
    "body": "What is hit: regions, laws, limits",
    "factors": "Impact factors",
    "matrices": "Matrices",
    "eigen": "Matrices",
    "errors": "Errors",
}
"""Modules and folders of ``symbolic``, in the order in which a reader needs them."""

DATA = {
    "AREAS": ("body", "Areas of the body and their limits, by name."),
    "REGIONS": ("body", "Regions of the body and their limits, by name."),
    "STANDARD_GRAVITY": ("dynamics", "Acceleration of gravity along the base's axes [m/s²]."),
    "Matrix": ("matrices", "A CasADi matrix: SX, MX or DM."),
    "MotorKind": ("impact", "Names of what motors do: free, servo, driven, held."),
    "HORIZON": ("", "How long forces count by default [s]."),
    "Fidelity": ("", "Names of the models of a robot, from the simplest to the most faithful."),
    "PeakDefinition": ("", "Names of what a peak may be."),
    "ControllerReference": ("", "What motion the papers' controller wants after first touch."),
    "Mode": ("", "``table``: the posture is given and k_s is sought; ``free``: both are sought."),
    "MODES": ("", "Both modes of a design."),
}
"""What is neither function nor class has no docstring of its own at run time."""

HEAD = """# From Python

What the command line can do, a function does. The names that most people need are in `softimpact`
itself; the packages below have them all. Functions of a robot take CasADi matrices (`SX`, `MX`) and
return the kind that they are given, and `DM` for numbers. Errors are classes with data: of input,
all of them `SoftImpactError`; of searches, `SolverFailure`, `Infeasible`, `Unavailable`. To begin
with: [the README](../README.md#in-python) and [the first five minutes](first-five-minutes.md).
"""

PACKAGES = {
    "simulate": "`softimpact.simulate`: impacts over time",
    "optimize": "`softimpact.optimize`: studies and designs",
    "codegen": "`softimpact.codegen`: C packages",
}


def entry(module: Any, name: str) -> str:
    """Return a name's line."""
    value = getattr(module, name)
    what = DATA[name][1] if name in DATA else str(inspect.getdoc(value)).split("\n\n")[0]
    return f"- `{name}`: {' '.join(what.split())}"


def group_of(symbolic: Any, name: str) -> str:
    """Return the title of the group to which a name of ``symbolic`` belongs."""
    if name in DATA:
        return GROUPS[DATA[name][0]]
    return GROUPS[getattr(symbolic, name).__module__.split(".")[2]]


def page() -> Iterator[str]:
    """Yield the page's lines."""
    yield HEAD
    symbolic = import_module("softimpact.symbolic")
    yield "## `softimpact.symbolic`: the physics\n"
    for title in dict.fromkeys(GROUPS.values()):
        yield f"### {title}\n"
        yield from (entry(symbolic, n) for n in symbolic.__all__ if group_of(symbolic, n) == title)
        yield ""
    for package, title in PACKAGES.items():
        module = import_module(f"softimpact.{package}")
        yield f"## {title}\n"
        yield from (entry(module, name) for name in module.__all__)
        yield ""


def text() -> str:
    return "\n".join(page()).rstrip() + "\n"


def test_the_page_lists_every_public_name() -> None:
    renew = "a public name or its docstring has changed: python tests/docs/test_python_page.py"
    assert PAGE.read_text(encoding="utf-8") == text(), renew


def test_every_name_says_what_it_is() -> None:
    for line in text().splitlines():
        if line.startswith("- `"):
            _, _, what = line.partition(": ")
            assert what.endswith((".", "``.", ":")) or what[-1] in ".)", line
            assert len(what) > 10, line


if __name__ == "__main__":
    PAGE.write_text(text(), encoding="utf-8")
