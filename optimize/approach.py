# SPDX-License-Identifier: BSD-3-Clause
"""Which of many postures cannot move their contact point along a direction."""

from __future__ import annotations

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from softimpact.symbolic import ImpactModel
from softimpact.symbolic.impact.approach import REACHED
from softimpact.symbolic.robot.rigid import Array


def singular_postures(model: ImpactModel, postures: Array, direction: Array) -> NDArray[np.int64]:
    """Return the numbers of postures in which ``approach_velocity`` raises, all looked at at once.

    Args:
        model: whose contact point moves.
        postures: m×n.
        direction: unit vector, length 3.
    """
    q = ca.SX.sym("q", model.robot.n)
    jacobians = np.array(ca.Function("J", [q], [model.jacobian(q)])(postures.T))
    J = jacobians.reshape(3, len(postures), -1).transpose(1, 0, 2)
    J = J * np.array(model.actuated, dtype=float)
    velocities = np.linalg.pinv(J, rcond=1e-9) @ direction
    missed = np.linalg.norm((J @ velocities[:, :, None])[:, :, 0] - direction, axis=1)
    return np.flatnonzero(missed > REACHED)
