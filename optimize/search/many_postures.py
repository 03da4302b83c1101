# SPDX-License-Identifier: BSD-3-Clause
"""Peak forces of many postures at once, the hardware given."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np

from softimpact.symbolic.robot.rigid import Array

from ..impact.impact_program import forces_alone
from ..impact.peaks import peaks_in_windows
from ..impact.timing import impact_timing, study_impacts
from ..running.workers import cores
from ..study.study import Study

IMPACTS_IN_A_CALL = 200
"""Impacts simulated in one call."""

TRIALS = 24
"""Postures of which the duration of impacts is taken."""


def peaks_of_postures(study: Study, postures: Array) -> Array:
    """Return the largest peak of each posture with the nominal springs [N].

    A row for each of ``study.motors``, m columns. Forces are those that a design sees: the linear
    model, to 0.1 %.

    Args:
        study: whose own impact hits.
        postures: m×n.
    """
    spread = np.unique(np.linspace(0, len(postures) - 1, TRIALS).astype(int))
    given = replace(study, lower=study.nominal, upper=study.nominal)
    timing = impact_timing(given, [postures[i] for i in spread])
    forces = forces_alone(study.model, timing.nodes, timing.substeps)
    x, p = forces.mx_in()
    peak = ca.mmax(peaks_in_windows(forces(x, p), ca.MX(0)))
    count, padding = len(postures), (-len(postures)) % IMPACTS_IN_A_CALL
    padded = np.pad(postures, ((0, padding), (0, 0)), mode="edge")
    springs = np.tile(np.log10(study.nominal), (IMPACTS_IN_A_CALL, 1))
    peaks = ca.Function("peak", [x, p], [peak]).map(IMPACTS_IN_A_CALL, "thread", cores())
    rows = study_impacts(study, timing.step)
    found: list[list[Array]] = []
    for begin in range(0, count + padding, IMPACTS_IN_A_CALL):
        at = np.column_stack([padded[begin : begin + IMPACTS_IN_A_CALL], springs]).T
        rows_of = (np.tile(row[:, None], IMPACTS_IN_A_CALL) for row in rows)
        found.append([peaks(at, each).full().ravel() for each in rows_of])
    return np.concatenate(found, axis=1)[:, :count]
