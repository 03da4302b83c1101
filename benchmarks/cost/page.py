# SPDX-License-Identifier: BSD-3-Clause
"""Numbers of all contenders as a page."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path

Table = dict[str, dict[str, float]]
"""A number by quantity and contender."""

QUANTITIES = {
    "mass_matrix": "M(q)",
    "osim": "Λ and Λ_F",
    "reflected_mass": "m_c",
    "reduced_model": "m_c, k_r, m_a",
    "giaf": "GIAF and GIIF",
    "peak_force": "peak force",
    "safe_speed": "safe speed",
}
IMPACTS = ("peak_force", "safe_speed")

HEAD = """# Cost against other ways to the same numbers

Written by `python benchmarks/cost/run.py` (`make bench-c`) for the Panda, tip at its hand. All
contenders of a table run in turns in one process, and their values agree to 1e-9 (impacts: within
twice the 0.1 % that all of them aim at; safe speeds: and within what they leave of the limit)
before a time counts.

- **ours**: the generated package, with its checks of inputs.
- **Pinocchio**: `crba` and its Jacobian, fixed-size Eigen matrices, Cholesky factors, and the block
  structure of M0 and K0 instead of a 14×14 inverse (`pinocchio_arm.hpp`).
- **CasADi**: CasADi's own C code of our expressions, after its elimination of common ones.
- **adam**, **urdf2casadi**: CasADi's C code of what they make of the same robot from a URDF; they
  give M(q) and J(q), on which the papers' formulas are built.

## On a PC

{machine}, {compiler}, double. Time of the fastest batch, and that of others over ours.

"""

IMPACT = """
Impacts are those of free motors up to a horizon of 0.1 s, the one case that both can compute; what
the bracket over 0.5 s costs is in [embedded.md](embedded.md). The other contender is a textbook
Runge-Kutta method of order 4 in C (`rk4.c`) on the same chain of masses, made by the same package;
its steps follow the fastest rate there is, and are as long as stability and 0.1 % allow. Its safe
speed corrects a guess by limit over force until it leaves as much of the limit free as ours does, 1
to 2.3 %.

"""

FLOPS = """
Operations, sines and cosines not counted:

"""

DIVISIONS = """
Divisions and square roots among them, which take some fourteen times as long as products, though
an instruction each in the tables below:

"""

EMBEDDED = """
## On a microcontroller

Instructions in float, counted under QEMU as in [embedded.md](embedded.md), over the package's
golden inputs. CasADi's `casadi_real=float` still calls the double `sin` and `cos` and writes double
constants, which the M4F emulates; "by hand" is its code after replacing the calls and with
`-fsingle-precision-constant`. Only ours checks its inputs, takes n of any length and tells singular
configurations, for some hundred instructions a call; and it computes sines in single precision
throughout, where the C library uses the M7's double registers.

"""


def page(
    machine: str,
    compiler: str,
    times: Table,
    flops: Table,
    divisions: Table,
    counts: Mapping[str, Table],
) -> str:
    """Return the page.

    Args:
        machine: its processor.
        compiler: with its flags.
        times: nanoseconds.
        flops: operations.
        divisions: divisions and square roots among them.
        counts: instructions by core; empty if they could not be counted.
    """
    still = {quantity: row for quantity, row in times.items() if quantity not in IMPACTS}
    hits = {quantity: row for quantity, row in times.items() if quantity in IMPACTS}
    parts = [HEAD.format(machine=machine, compiler=compiler), _ratios(still, "{:.0f} ns")]
    parts += [IMPACT, _ratios(hits, "{:.0f} ns"), FLOPS, _plain(flops)]
    parts += [DIVISIONS, _plain(divisions)]
    if counts:
        parts.append(EMBEDDED)
    for core, table in counts.items():
        parts += [f"{core}:\n\n", _ratios(table, "{:.0f}"), "\n"]
    return "".join(parts).rstrip() + "\n"


def processor() -> str:
    """Return the processor's name."""
    info = Path("/proc/cpuinfo")
    lines = info.read_text(encoding="utf-8").splitlines() if info.is_file() else []
    names = [line.split(":")[1].strip() for line in lines if line.startswith("model name")]
    return names[0] if names else "unknown processor"


def _ratios(table: Table, form: str) -> str:
    rivals = _contenders(table)[1:]
    rows = {}
    for quantity, row in table.items():
        over = {name: row[name] / row["ours"] for name in rivals if name in row}
        rows[quantity] = [form.format(row["ours"]), *(_times(over.get(name)) for name in rivals)]
    return _table(["ours", *rivals], rows)


def _times(ratio: float | None) -> str:
    if ratio is None:
        return "–"
    digits = 2 if ratio < 2 else 1 if ratio < 10 else 0
    return f"{ratio:.{digits}f} ×"


def _plain(table: Table) -> str:
    names = _contenders(table)
    return _table(names, {q: [f"{row[name]:.0f}" for name in names] for q, row in table.items()})


def _contenders(table: Table) -> list[str]:
    return list(dict.fromkeys(name for row in table.values() for name in row))


def _table(columns: list[str], rows: Mapping[str, list[str]]) -> str:
    lines = ["| | " + " | ".join(columns) + " |", "|---|" + "---:|" * len(columns)]
    lines += [f"| {QUANTITIES[q]} | " + " | ".join(cells) + " |" for q, cells in rows.items()]
    return "\n".join(lines) + "\n"
