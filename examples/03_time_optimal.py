# SPDX-License-Identifier: BSD-3-Clause
"""A motion as fast as it may be: time-optimal under the speed factor, and checked by ``program``.

The Panda swings from one posture to another. Ipopt chooses angles, velocities and the time between
the knots; at each knot neither the hand nor the forearm may exceed the chest's limits.

python examples/03_time_optimal.py [FILE.csv]
"""

from __future__ import annotations

import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import casadi as ca
import numpy as np

from softimpact import Contact, Motors, body_region, drives, impact_model, load_robot
from softimpact.optimize.impact.speed_factor import Watch, speed_factor
from softimpact.simulate.program import program_dangers, safe_program
from softimpact.simulate.trajectory import Trajectory, trajectory
from softimpact.symbolic.robot.rigid import Array

PANDA = load_robot("panda")
MODEL = impact_model(PANDA, drives=drives(PANDA, joint_stiffness=1e4))
ENDS = {"free": Motors("free"), "driven": Motors("driven")}
POINTS = ["hand_tcp", "link5"]
CHEST = Contact(body_region("chest"), clamped=False)
HORIZON = 0.1
START = np.array([-0.8, 0.3, 0.0, -2.0, 0.0, 2.0, 0.8])
END = np.array([0.8, 0.5, 0.2, -1.6, 0.3, 2.2, 0.8])
ACCELERATION = 10.0  # of all joints, rad/s²
SMOOTHNESS = 1e-5  # weight of the squared accelerations, which alone would chatter


IPOPT: dict[str, Any] = {
    "hessian_approximation": "limited-memory",
    "max_iter": 1000,
    "print_level": 0,
    "sb": "yes",
    "tol": 1e-4,
}


@dataclass(frozen=True, eq=False)
class Swing:
    """A motion between two postures.

    Attributes:
        motion: joint angles over time, finely sampled.
        factor: that ``program`` finds for each sample.
    """

    motion: Trajectory
    factor: Array


def fastest(knots: int = 13, limited: bool = True) -> Swing:
    """Return the fastest motion, with or without the limit, and what ``program`` says of it."""
    opti = ca.Opti()
    q, rate = opti.variable(PANDA.n, knots), opti.variable(PANDA.n, knots)
    push, time = opti.variable(PANDA.n, knots - 1), opti.variable()
    step = time / (knots - 1)
    for k in range(knots - 1):  # constant acceleration from knot to knot
        opti.subject_to(rate[:, k + 1] == rate[:, k] + step * push[:, k])
        opti.subject_to(q[:, k + 1] == q[:, k] + step * rate[:, k] + step**2 / 2 * push[:, k])
    opti.subject_to(opti.bounded(-ACCELERATION, ca.vec(push), ACCELERATION))
    for k in range(knots):
        opti.subject_to(opti.bounded(-PANDA.speed_limits, rate[:, k], PANDA.speed_limits))
        opti.subject_to(opti.bounded(PANDA.limits[0], q[:, k], PANDA.limits[1]))
    for k, posture in ((0, START), (knots - 1, END)):
        opti.subject_to(q[:, k] == posture)
        opti.subject_to(rate[:, k] == 0)
    if limited:
        factor = speed_factor(MODEL, [Watch(POINTS, CHEST)], list(ENDS.values()), horizon=HORIZON)
        for k in range(1, knots - 1):
            opti.subject_to(1 / factor(q[:, k], rate[:, k]) <= 1)
    opti.minimize(time + SMOOTHNESS * ca.sumsqr(push))
    share = np.linspace(0, 1, knots)
    opti.set_initial(time, 4.0)
    opti.set_initial(q, START[:, None] + (END - START)[:, None] * (3 * share**2 - 2 * share**3))
    opti.set_initial(rate, (END - START)[:, None] * 6 * share * (1 - share) / 4.0)
    opti.solver("ipopt", {"print_time": False}, IPOPT)
    found = opti.solve()
    angles, rates, pushes = (np.array(found.value(x)) for x in (q, rate, push))
    return checked(angles, rates, pushes, float(found.value(step)))


def checked(q: Array, rate: Array, push: Array, step: float, fine: int = 8) -> Swing:
    """Return a motion sampled between its knots, with the factors that ``program`` finds."""
    within = step * np.arange(fine) / fine
    parts = [
        q[:, k, None] + rate[:, k, None] * within + push[:, k, None] / 2 * within**2
        for k in range(push.shape[1])
    ]
    angles = np.vstack([np.hstack(parts).T, q[:, -1]])
    motion = trajectory(step / fine * np.arange(len(angles)), angles)
    dangers = program_dangers(MODEL, motion, POINTS, [CHEST], ENDS, horizon=HORIZON)
    return Swing(motion, safe_program(motion, dangers).factor)


def main(path: Path | None) -> None:
    """Solve it with and without the limit."""
    for limited in (False, True):
        swing = fastest(limited=limited)
        words = "kept" if limited else "not looked at"
        print(
            f"limit {words}: {swing.motion.time[-1]:.3f} s; program would slow it down to "
            f"{100 * swing.factor.min():.1f} % at worst"
        )
    if path is not None:
        table = np.column_stack([swing.motion.time, swing.motion.q])
        header = ",".join(("t", *PANDA.joint_names))
        np.savetxt(path, table, delimiter=",", header=header, comments="", fmt="%.9g")


if __name__ == "__main__":
    main(Path(sys.argv[1]) if len(sys.argv) > 1 else None)
