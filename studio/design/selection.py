# SPDX-License-Identifier: BSD-3-Clause
"""Rank the configurations of a study by what an impact in them does, the springs given."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any, Literal

import casadi as ca
import numpy as np

from softimpact.optimize import Candidate, Study, candidates
from softimpact.optimize.search.many_postures import peaks_of_postures
from softimpact.simulate import Fidelity
from softimpact.symbolic import InvalidValue, analyse, directional_giaf, giaf
from softimpact.symbolic.robot.rigid import Array

from ..output.cautions import study_warnings
from ..output.dashes import explain, reasons
from ..output.printed import AS_CSV, Cell, print_table, say
from .checks import simulated

Criterion = Literal["peak_force", "m_c", "giaf", "directional_giaf"]
"""What to rank by: least force, least mass, or largest absorption factor."""

NAMES: dict[Criterion, str] = {
    "peak_force": "peak force",
    "m_c": "reflected mass",
    "giaf": "absorption factor",
    "directional_giaf": "absorption factor along the impact",
}
"""What people call each."""


@dataclass(frozen=True, eq=False)
class PoseFigures:
    """A configuration in figures, which are those of ``softimpact.symbolic.Analysis``.

    Attributes:
        name: of the pose.
        q: link angles that were examined: those given, less their turn about the base [rad].
        turned: that turn [rad], zero for most.
        m_c: [kg].
        k_r: [N/m].
        m_a: [kg].
        giaf: generalised impact absorption factor.
        directional_giaf: along the impact.
        peak_force: largest over all contacts and all that the motors may do [N].
    """

    name: str
    q: Array
    turned: float
    m_c: float
    k_r: float | None
    m_a: float | None
    giaf: float | None
    directional_giaf: float | None
    peak_force: float


def ranking(study: Study, criterion: Criterion, fidelity: Fidelity) -> list[PoseFigures]:
    """Return the study's configurations, best first, at its nominal joint stiffness.

    Args:
        study: robot, impact and configurations.
        criterion: to rank by.
        fidelity: of the impacts simulated.

    Raises:
        InvalidValue: the criterion does not apply to the robot.
    """
    given = candidates(study)
    if fidelity == "linearised" and len(given) > MANY:
        found = _of_many(study, given)
    else:
        found = [_figures(study, candidate, fidelity) for candidate in given]
    if any(getattr(pose, criterion) is None for pose in found):
        raise InvalidValue("by", f"{criterion} does not apply to robot '{study.robot.name}'")
    more_is_better = criterion in ("giaf", "directional_giaf")
    return sorted(found, key=lambda pose: float(getattr(pose, criterion)), reverse=more_is_better)


def _figures(study: Study, candidate: Candidate, fidelity: Fidelity) -> PoseFigures:
    q = candidate.q
    figures = analyse(study.model, q, study.direction)
    return PoseFigures(
        name=candidate.pose.name,
        q=q,
        turned=candidate.turned,
        m_c=figures.m_c,
        k_r=figures.k_r,
        m_a=figures.m_a,
        giaf=figures.giaf,
        directional_giaf=figures.directional_giaf,
        peak_force=simulated(study, q, study.nominal, fidelity).peak,
    )


MANY = 100
"""Configurations beyond which all are looked at at once, by the program of a design: the same
model, to 0.1 %, in a thousandth of the time. The best are simulated again."""

DOUBT = 2e-3
"""Share by which the force of one of many may be wrong, so that any so near to the least may be the
best: as many are simulated, each for itself, but ``AGAIN`` at most."""

AGAIN = 3
"""Configurations that are simulated at most."""

SHOWN = 30
"""Configurations of a table for people."""


def _of_many(study: Study, given: Sequence[Candidate]) -> list[PoseFigures]:
    """Return the figures of many configurations."""
    postures = np.array([candidate.q for candidate in given])
    of_motors = peaks_of_postures(study, postures)
    forces = of_motors.max(axis=0)
    near = np.flatnonzero(forces <= forces.min() * (1 + DOUBT))
    for i in near[np.argsort(forces[near])][:AGAIN]:
        # of what the motors may do, only what may be the worst
        worst = np.flatnonzero(of_motors[:, i] >= forces[i] * (1 - DOUBT))
        some = replace(study, motors=tuple(study.motors[k] for k in worst))
        forces[i] = simulated(some, postures[i], study.nominal, "linearised").peak
    figures = np.array(_all_figures(study)(postures.T)).T
    found = []
    for candidate, row, force in zip(given, figures.tolist(), forces.tolist(), strict=True):
        named = dict(zip(FIGURES, row, strict=True))
        if not np.isfinite(row).all() or min(row) < SMALL:  # what may not apply there
            exact = analyse(study.model, candidate.q, study.direction)
            named = {name: getattr(exact, name) for name in FIGURES}
        found.append(
            PoseFigures(
                name=candidate.pose.name,
                q=candidate.q,
                turned=candidate.turned,
                **named,
                peak_force=force,
            )
        )
    return found


FIGURES = ("m_c", "k_r", "m_a", "giaf", "directional_giaf")
"""Names in ``PoseFigures`` and in ``softimpact.symbolic.Analysis``."""

SMALL = 1e-9
"""Figure below which it may not apply."""


def _all_figures(study: Study) -> ca.Function:
    """Return q -> ``FIGURES``."""
    model, n = study.model, ca.DM(study.direction)
    q = ca.SX.sym("q", model.robot.n)
    reduced = model.reduced(q, n)
    free, real = model.free_mobility(q), model.mobility(q)
    along = directional_giaf(free, real, n)
    found = [reduced.m_c, reduced.k_r, reduced.m_a, giaf(free, real), along]
    return ca.Function("figures", [q], [ca.vertcat(*found)], {"cse": True})


def record(
    study: Study, criterion: Criterion, fidelity: Fidelity, ranked: Sequence[PoseFigures]
) -> dict[str, Any]:
    """Return a ranking with what it rests on."""
    return {
        "study": study.source,
        "robot": study.robot.name,
        "tip": study.model.tip,
        "direction": study.direction,
        "region": study.contact.region.name,
        "clamped": study.contact.clamped,
        "speed": study.speed,
        "joint_stiffness": study.nominal,
        "model": fidelity,
        "peak_definition": "peak",
        "warnings": study_warnings(replace(study, scenarios=None)),  # it ranks by its own impact
        "motors": study.motors,
        "horizon": study.horizon,
        "by": criterion,
        "limit": study.limit,
        "winner": ranked[0].name,
        "poses": [{"rank": i + 1, **vars(pose)} for i, pose in enumerate(ranked)],
    }


def print_ranking(study: Study, criterion: Criterion, ranked: Sequence[PoseFigures]) -> None:
    """Print a ranking as a table, for people the first of it alone."""
    limit, shown = study.limit, ranked if AS_CSV.get() else ranked[:SHOWN]
    print_table(
        f"{study.title}: by {criterion}; {study.contact.region.name}, {study.speed:g} m/s, "
        f"limit {limit:.4g} N",
        *figures_table(shown),
    )
    explain(reasons(shown))
    if len(shown) < len(ranked):
        say(f"the first {len(shown)} of {len(ranked):,}; --csv and --json have all")


def figures_table(ranked: Sequence[PoseFigures]) -> tuple[Sequence[str], list[list[Cell]]]:
    """Return heads and rows of a ranking."""
    heads = ("rank", "pose", "m_c kg", "k_r kN/m", "m_a kg", "GIAF", "along n", "peak N")
    rows: list[list[Cell]] = [
        [
            str(i + 1),
            pose.name,
            pose.m_c,
            None if pose.k_r is None else 1e-3 * pose.k_r,
            pose.m_a,
            pose.giaf,
            pose.directional_giaf,
            pose.peak_force,
        ]
        for i, pose in enumerate(ranked)
    ]
    return heads, rows
