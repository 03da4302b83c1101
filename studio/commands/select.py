# SPDX-License-Identifier: BSD-3-Clause
"""``softimpact select``: which configuration of a study is the safest, the springs given."""

from __future__ import annotations

from typing import Annotated

import typer

from ..typed import options as o
from ..typed.groups import TypedStudy

ByOption = Annotated[
    str,
    typer.Option(
        metavar="FIGURE", help="What ranks the poses: peak_force, m_c, giaf or directional_giaf."
    ),
]


def select(
    study: TypedStudy,
    by: ByOption = "peak_force",
    fidelity: o.FidelityOption = "linearised",
    report: o.ReportOption = None,
    json: o.JsonOption = False,
) -> None:
    """Rank the configurations of a study at its nominal joint stiffness."""
    from softimpact.simulate import Fidelity

    from ..design.selection import Criterion, print_ranking, ranking, record
    from ..output.printed import print_json, print_warnings
    from ..typed.values import one_of

    criterion: Criterion = one_of("criterion", by, Criterion)
    model: Fidelity = one_of("impact model", fidelity, Fidelity)
    problem = study.read()
    ranked = ranking(problem, criterion, model)
    if report is not None:
        from ..report.pareto_pages import write_selection_report

        write_selection_report(problem, criterion, ranked, report)
    told = record(problem, criterion, model, ranked)
    print_warnings(told["warnings"])
    if json:
        print_json(told)
    else:
        print_ranking(problem, criterion, ranked)
