# SPDX-License-Identifier: BSD-3-Clause
"""Peak forces of many postures at once, the hardware given."""

from __future__ import annotations

import numpy as np

from softimpact.symbolic.robot.rigid import Array

from .impact_program import impact_program
from .problem import study_impacts
from .study import Study
from .timing import impact_timing
from .workers import cores

CHUNK = 200
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
    count, padding = len(postures), (-len(postures)) % CHUNK
    padded = np.pad(postures, ((0, padding), (0, 0)), mode="edge")
    springs = np.tile(np.log10(study.nominal), (CHUNK, 1))
    peaks = program["peaks"].map(CHUNK, "thread", cores())
    rows = study_impacts(study, timing.step)
    found = []
    for begin in range(0, count + padding, CHUNK):
        x = np.column_stack([padded[begin : begin + CHUNK], springs]).T
        forces = [
            np.array(peaks(x, np.tile(row[:, None], CHUNK), np.zeros((1, CHUNK)))).max(axis=0)
            for row in rows
        ]
        found.append(np.max(forces, axis=0))
    return np.concatenate(found)[:count]
