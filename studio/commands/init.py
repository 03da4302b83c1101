# SPDX-License-Identifier: BSD-3-Clause
"""``softimpact init``: a study file to begin with."""

from __future__ import annotations

from ..typed import options as o


def init(
    model: o.ModelArgument,
    tip: o.TipOption = None,
    hold_base: o.HoldBaseOption = False,
    json: o.JsonOption = False,
) -> None:
    """Print a study file for a robot, with what its file has and what is missing."""
    import tomllib

    from ..output.printed import print_json, print_warnings
    from ..robot.first_study import first_study

    text, warnings = first_study(model, tip, hold_base=hold_base)
    print_warnings(warnings)
    if json:
        print_json({"text": text, "study": tomllib.loads(text), "warnings": warnings})
    else:
        print(text, end="")
