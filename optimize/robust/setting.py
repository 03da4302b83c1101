# SPDX-License-Identifier: BSD-3-Clause
"""A study and its scenarios made ready to search: time steps, compiled impacts and bounds."""

from __future__ import annotations

from concurrent.futures import Executor

from ..impact.impact_program import impact_program
from ..impact.timing import Timing, scenario_timing
from ..running.workers import Progress
from ..search.ipopt import VariableBounds
from ..search.problem import sought_parts, study_program
from ..study.scenarios import Scenarios
from ..study.study import Study
from .certificate import Setting


def setting_of(
    study: Study,
    scenarios: Scenarios,
    pool: Executor,
    on_progress: Progress | None = None,
    timing: Timing | None = None,
    *,
    elsewhere: bool,
) -> Setting:
    """Return what all searches of scenarios share.

    Args:
        study: the robot, its variables, bounds and objective.
        scenarios: to bear.
        pool: where screenings and searches run.
        on_progress: called with what is being done, how much of it is, and how much there is.
        timing: of the impacts; default from trials of some scenarios.
        elsewhere: whether jobs may run on other machines.

    Raises:
        InvalidValue: as ``scenario_timing``.
    """
    timing = timing or scenario_timing(study, scenarios)
    parts = sought_parts(study)
    impacts = tuple(
        impact_program(
            study.model,
            timing.nodes,
            timing.substeps,
            point,
            parts,
            compiled=True,
            elsewhere=elsewhere,
        )
        for point in scenarios.points
    )
    return Setting(
        study,
        scenarios,
        study_program(study, impacts),
        timing,
        VariableBounds.of(study),
        pool,
        on_progress or (lambda *_: None),
    )
