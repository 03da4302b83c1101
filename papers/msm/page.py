# SPDX-License-Identifier: BSD-3-Clause
"""The page of a reproduction: what agrees, what does not, and the figures."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from typing import get_args

from softimpact.simulate import Decoupling
from softimpact.studio.output.printed import shown

from .compare import Comparison, PrintedVerdict, mean_error
from .compute import DECOUPLED, Results
from .ladder import DEFINITIONS, LADDER, REGIONS
from .scenarios import SCENARIOS

READINGS = """\
What the text leaves open, and how it is read here:

- K_p = k_p M_θθ in K0: the motors' block of M0, rotors included.
- Eq. 38's norm is Frobenius' with orthonormal rows J_a.
- The contact normal is the direction in which the contact point moves.
- The PID is multiplied by the same M_θθ; Coriolis and potential forces are compensated. After first
  touch the motors' reference moves on with the speed of arrival. 20 ms later the torques only hold
  potential forces. A reference that is held instead changes the full model itself by more than
  most models differ from it (see the ladder).
- The "peak of the first impact" is the first local maximum of the force (`first_peak`). Where two
  peaks merge it jumps, so an error there says where each model has them merge. The largest force
  until separation is `first_contact`.
- Mean errors are over twelve joint stiffnesses on a logarithmic scale, 5·10² to 5·10⁴ N·m/rad for
  RR and 10² to 10⁴ for R-Min: 4056 and 351 N·m/rad are steps of these grids.
- c_h is 10 N·s/m (the unit printed is a slip); m_0 is left out. The joint stiffness of Fig. 9 is
  10⁴ N·m/rad as in its caption (the text's 10⁵ is a slip: k_r and m_a beside it are those of 10⁴).
- R-Min's distance O11-O21 is 0.263 m, inferred from the two printed m_c.
"""

LADDER_NOTE = """\
Once the linear model feels the controller, only the change of geometry while the robot moves is
left between it and the full one. Held by K_p alone (MSM Eq. 5) the motors neither
follow a reference that moves on nor are they damped by k_d: that is where the linearised model
parts from the full one, the more the longer the contact lasts (chest) and the nearer it is to the
motors (elbow). Two masses that both arrive with the contact point's speed make up for part of it.
"""

VERDICTS = """\
*input*: a datum of the robot, which our model must repeat; no result. *agrees*: to the last printed
digit (which may be cut off) or within 0.5 %; mean errors within one percentage point. *Difference*
is in percent of the printed number, for numbers in % in points.
"""


def msm_page(
    results: Results, comparisons: Sequence[Comparison], captions: Mapping[str, str]
) -> str:
    """Return the report as Markdown; figures are expected beside it."""
    counts = Counter(line.verdict for line in comparisons)
    summary = ", ".join(f"{v} {counts[v]}" for v in get_args(PrintedVerdict))
    parts = [
        "# A reduced mass-spring-mass model of compliant robots, recomputed",
        "Jeanneau, Bégoc, Briot, J. Mechanisms Robotics 16(4), 041012, 2024: our numbers beside "
        "the printed ones.",
        f"**Of {len(comparisons)} printed numbers: {summary}.**",
        READINGS,
        VERDICTS,
        *_sections(comparisons),
        *_decoupling(results),
        *_ladder(results),
        "## Figures",
        *(f"![{caption}]({name})\n\n{caption}" for name, caption in captions.items()),
    ]
    return "\n\n".join(part.strip() for part in parts) + "\n"


def table(head: Sequence[str], rows: Iterable[Sequence[float | str | None]]) -> str:
    """Return a Markdown table; numbers to four digits."""
    lines = [head, ["---"] * len(head), *([shown(cell) for cell in row] for row in rows)]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def _sections(comparisons: Sequence[Comparison]) -> list[str]:
    parts = []
    for section in dict.fromkeys(line.section for line in comparisons):
        lines = [line for line in comparisons if line.section == section]
        head = ("quantity", "of", "unit", "printed", "ours", "difference", "verdict")
        rows = [
            (
                line.what,
                line.scenario,
                line.unit,
                line.printed,
                line.ours,
                f"{line.difference:+.2f}" if abs(line.difference) >= 0.005 else "0",
                f"{line.verdict}: {line.note}" if line.note else line.verdict,
            )
            for line in lines
        ]
        parts += [f"## {section}", table(head, rows)]
    return parts


def _decoupling(results: Results) -> list[str]:
    rows = []
    for name in results.decoupling:
        for region in REGIONS:
            found = results.decoupling[name][region]
            cells = [cell for rung in DECOUPLED for cell in _stiffnesses(found.get(rung))]
            rows.append((name, region, *cells))
    head = ["scenario", "region"]
    for rung in DECOUPLED:
        head += [f"isolated, {LADDER[rung].title}", f"distinct, {LADDER[rung].title}"]
    text = (
        "Isolated: the largest k_s [N·m/rad] up to which the contact is lost after the first peak. "
        "Distinct: up to which that peak, though not isolated, is a maximum of its own."
    )
    return ["## Joint stiffness that decouples, all scenarios", text, table(head, rows)]


def _stiffnesses(found: Decoupling | None) -> tuple[str, str]:
    if found is None:
        return "softer than searched", "–"
    isolated, distinct = found.isolated, found.distinct
    return (
        "always" if isolated is None else shown(isolated),
        "always" if distinct is None else shown(distinct),
    )


def _ladder(results: Results) -> list[str]:
    text = "Mean absolute error [%] over the grid of k_s against `{}`, {}."
    parts = ["## The ladder", LADDER_NOTE]
    against = {"full": [r for r in LADDER if r != "full"], "linearised": ["chain", "two_mass"]}
    for reference, rungs in against.items():
        for definition in DEFINITIONS:
            rows = [
                (
                    LADDER[rung].title,
                    *(
                        f"{mean_error(results.sweeps[s], region, rung, definition, reference):.2f}"
                        for region in REGIONS
                        for s in results.sweeps
                    ),
                )
                for rung in rungs
            ]
            head = ["model", *(f"{s} {region}" for region in REGIONS for s in results.sweeps)]
            shown_as = LADDER[reference].title
            parts += [text.format(shown_as, definition), table(head, rows)]
    return parts


def titles() -> dict[str, str]:
    """Return the scenarios' titles by name."""
    return {name: scenario.title for name, scenario in SCENARIOS.items()}
