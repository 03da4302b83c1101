# SPDX-License-Identifier: BSD-3-Clause
"""``softimpact factors-study``: impact factors over a study's configurations, with figures."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from softimpact.studio.typed import options as o

if TYPE_CHECKING:
    from .factor_study import FactorStudy

TipsOption = Annotated[
    list[str] | None,
    typer.Option("--tip", metavar="FRAME", help="Contact frame, repeatable; default the study's."),
]


def factors_study(
    study: o.StudyFileArgument, out: o.OutOption, tip: TipsOption = None, json: o.JsonOption = False
) -> None:
    """Show impact factors over the poses and the self-motion, and how well they foretell force."""
    from softimpact.optimize import load_study
    from softimpact.studio.output.printed import print_json, say_beside, write_json
    from softimpact.studio.output.results_folder import (
        RESULTS,
        replaced_folder,
        require_replaceable_results,
    )

    from .factor_figures import draw_factor_figures
    from .factor_study import factor_study
    from .factor_study.record import GENERATOR, factor_study_record

    problem = load_study(study)
    require_replaceable_results(out, GENERATOR)
    found = factor_study(problem, tip or (), say_beside)
    record = factor_study_record(found)
    with replaced_folder(out, GENERATOR) as fresh:
        write_json(fresh / RESULTS, record)
        draw_factor_figures(found, fresh)
    if json:
        print_json({"out": out, **record})
    else:
        _print(found, out)


def _print(found: FactorStudy, folder: Path) -> None:
    from softimpact.studio.output.printed import print_table, say

    rows = []
    for (tip, name), factors in found.factors.items():
        least, most = factors.giaf.argmin(), factors.giaf.argmax()
        single = factors.single_joint_giaf.mean(axis=0)
        weakest = found.study.robot.joint_names[single.argmin()]
        best = found.along[tip, name].most_giaf
        rows.append(
            (
                tip,
                name,
                f"{factors.giaf[least]:.4f} ({found.names[least]})",
                f"{factors.giaf[most]:.4f} ({found.names[most]})",
                best.value,
                f"{weakest} ({single.min():.3f})",
            )
        )
    print_table(
        f"GIAF over {len(found.names)} poses of {found.study.robot.name}",
        ("tip", "rotors", "least", "most", "most on the\nself-motion", "joint that\nmatters most"),
        rows,
    )
    say(f"\nResults and figures: {folder}")
