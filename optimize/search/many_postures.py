# SPDX-License-Identifier: BSD-3-Clause
"""Peak forces of many postures at once, the hardware given."""

from __future__ import annotations

import numpy as np

from softimpact.symbolic.robot.rigid import Array

from ..impact.impact_program import impact_program
from ..impact.timing import impact_timing
from ..running.workers import cores
from ..study.study import Study
from .problem import study_impacts

IMPACTS_IN_A_CALL = 200
"""Impacts simulated in one call."""

TRIALS = 24
"""Postures of which the duration of impacts is taken."""


def peaks_of_postures(study: Study, postures: Array) -> Array:
    """Return the largest peak of each posture with the nominal springs, m [N].

    Of what the motors may do the worst counts. Forces are those that a design sees: the linear
    model, to 0.1 %.

    Args:
        study: whose own impact hits.
        postures: m×n.
    """
    spread = np.unique(np.linspace(0, len(postures) - 1, TRIALS).astype(int))
    timing = impact_timing(study, [postures[i] for i in spread])
    program = impact_program(study.model, timing.nodes, timing.substeps, compiled=True)
    count, padding = len(postures), (-len(postures)) % IMPACTS_IN_A_CALL
    padded = np.pad(postures, ((0, padding), (0, 0)), mode="edge")
    springs = np.tile(np.log10(study.nominal), (IMPACTS_IN_A_CALL, 1))
    peaks = program["peaks"].map(IMPACTS_IN_A_CALL, "thread", cores())
    rows = study_impacts(study, timing.step)
    found = []
    for begin in range(0, count + padding, IMPACTS_IN_A_CALL):
        x = np.column_stack([padded[begin : begin + IMPACTS_IN_A_CALL], springs]).T
        forces = [
            np.array(
                peaks(x, np.tile(row[:, None], IMPACTS_IN_A_CALL), np.zeros((1, IMPACTS_IN_A_CALL)))
            ).max(axis=0)
            for row in rows
        ]
        found.append(np.max(forces, axis=0))
    return np.concatenate(found)[:count]
