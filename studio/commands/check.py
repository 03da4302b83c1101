# SPDX-License-Identifier: BSD-3-Clause
"""``softimpact check``: everything that is wrong in a study file."""

from __future__ import annotations

import typer

from ..typed import options as o


def check(study: o.StudyFileArgument, json: o.JsonOption = False) -> None:
    """Say everything that is wrong in a study file, with line numbers, without running it."""
    from softimpact.optimize.study.study import load_study
    from softimpact.optimize.study_check import study_problems

    from ..output.printed import print_json, print_warnings, say, say_beside

    problems = study_problems(study)
    if json:
        print_json({"study": study, "problems": problems})
    for problem in problems:
        where = study if problem.line is None else f"{study}:{problem.line}"
        what = f"{problem.field}: " if problem.field else ""
        say_beside(f"error: {where}: {what}{' '.join(problem.reason.split())}")
    if problems:
        raise typer.Exit(2)
    found = load_study(study)
    print_warnings(found.robot.warnings)
    if not json:
        count = len(found.poses)
        poses = "one pose" if count == 1 else f"{count} poses"
        say(f"{study}: nothing is wrong; {found.robot.name}, {poses}")
