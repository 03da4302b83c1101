# SPDX-License-Identifier: BSD-3-Clause
"""The page of GIAF's reproduction: its statements, what is left open, and the figures."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from typing import get_args

from softimpact.papers.factor_study import FactorStudy

from ..msm.page import table
from .statements import Holding, Statement

READINGS = """\
No factor is printed as a number, and no rotor inertia of the robot: every statement is checked for
each named set of rotors and for both ends of the tool. Also read here:

- J is the translational Jacobian; the poses of Table I are moved to the nearest ones that hold the
  tip exactly. q19 is not printed: it is recovered on the self-motion between its neighbours.
  q22-q24 are printed turned by 0.31 rad about the vertical, which no factor of a fixed base sees.
- Whose axes Fig. 4 means is not said: both are shown.
"""

CAPTIONS = {
    "giaf_of_poses": "Fig. 1: GIAF of the poses, for every tip and set of rotors.",
    "giaf_sweeps": "Fig. 2: GIAF over reflected inertia and gear ratio, {}.",
    "single_joint_giaf": "Fig. 3: GIAF with the rotor of one joint alone.",
    "directional_giaf": "Fig. 4: directional GIAF of the first pose.",
    "postures": "Fig. 5: some of the postures.",
    "fixed_base_imf": "A fixed base as a very heavy floating one: why GIAF exists.",
    "self_motion": "Factors, masses and peak force along the whole self-motion, {}.",
    "rank_correlation": "How well each figure orders the poses by their peak force.",
    "giaf_against_force": "GIAF against the peak force of the elastic robot.",
}
"""By the beginning of a figure's file name, in the order of the page."""


def giaf_page(found: FactorStudy, lines: Sequence[Statement], figures: Sequence[str]) -> str:
    """Return the report as Markdown; figures are expected beside it."""
    counts = Counter(line.verdict for line in lines)
    summary = ", ".join(f"{verdict} {counts[verdict]}" for verdict in get_args(Holding))
    rows = [(x.source, x.claim, x.tip, x.rotors, x.ours, x.verdict) for x in lines]
    head = ("source", "statement", "tip", "rotors", "ours", "verdict")
    parts = [
        "# Impact response factors of the Panda, recomputed",
        "Relaño, Sanz-Merodio, López, Monje, Generalization of Impact Response Factors for "
        "Proprioceptive Collaborative Robots: what it says in words, and what we find.",
        f"**Of {len(lines)} statements checked: {summary}.**",
        READINGS,
        "## Statements",
        table(head, rows),
        f"## Figures\n\n{len(found.names)} poses of {found.study.robot.name}.",
        *(f"![{caption}]({name})\n\n{caption}" for name, caption in _captions(figures)),
    ]
    return "\n\n".join(part.strip() for part in parts) + "\n"


def _captions(figures: Sequence[str]) -> list[tuple[str, str]]:
    """Return file names and captions in the order of the page."""
    found = []
    for start, caption in CAPTIONS.items():
        for name in sorted(name for name in figures if name.startswith(start)):
            rest = name.removeprefix(start).removesuffix(".png").strip("_")
            found.append((name, caption.format(rest)))
    return found
