# SPDX-License-Identifier: BSD-3-Clause
"""The speed factor as a function of joint angles and velocities: a constraint for other optimisers.

Smooth, and on the safe side of ``simulate.program``: the largest of many forces is taken by
log Σ exp, which lies above it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import ceil, inf

import casadi as ca
import numpy as np

from softimpact.symbolic import Contact, ImpactModel, InvalidValue, Matrix, Motors, limits_of
from softimpact.symbolic.body.verdict import QUASI_STATIC_FROM, Limits
from softimpact.symbolic.dynamics.equations_of_motion import mass_matrix
from softimpact.symbolic.dynamics.kinematics import contact_point_jacobian
from softimpact.symbolic.impact.motors import refuse_held
from softimpact.symbolic.matrices import Factorisation, MatrixExpression
from softimpact.toolchain import c_compiler

from .compiled import compiled_functions
from .impact_forces import FEW_DIRECTIONS, ContactParameters, ImpactDynamics, contact_forces
from .impact_program import known_rotors
from .motor_laws import MotorLaws

STEP = 2e-4
"""Time between two forces [s]: a fifth of the shortest peaks' width at half their height."""

SHARE_KEPT_FREE = 0.01
"""Share of a limit that is kept free: for peaks between two forces, and the leapfrog's error."""

SHARP = 600.0
"""Sharpness of the largest force: n alike ones count log(n)/SHARP of the limit too much."""

FADING_SPEED = 1e-3
"""Speed [m/s] below which a point's direction fades out, so that it has one at rest, too."""


@dataclass(frozen=True)
class Watch:
    """Who may be met by which points.

    Attributes:
        points: frames of the robot.
        contact: with the body.
        limits: to be kept; default the region's without a shape.
    """

    points: Sequence[str]
    contact: Contact
    limits: Limits | None = None


def speed_factor(
    model: ImpactModel,
    watched: Sequence[Watch],
    motors: Sequence[Motors],
    *,
    horizon: float = 0.1,
    compiled: bool = True,
) -> ca.Function:
    """Return (q, q̇) -> factor, of which a constraint keeps ``factor >= 1``.

    Where it is below 1 the motion must be slowed down by it, at least; above 1 it says only that
    all limits are kept. Derivatives are exact; take ``hessian_approximation="limited-memory"``.

    Args:
        model: the arm, all of whose joints are elastic.
        watched: points and what they may meet.
        motors: what they may do; the worst counts.
        horizon: up to which forces count [s]; what presses on a held body counts if it is beyond
            0.5 s.
        compiled: whether to compile it, if there is a compiler.

    Raises:
        InvalidValue: joints that are rigid, sprung by the file or coupled, a body that does not
            follow Hertz's law, or motors that are held.
    """
    _check(model, motors)
    n = model.robot.n
    q, rate = ca.MX.sym("q", n), ca.MX.sym("dq", n)
    shares = []
    for watch in watched:
        limits = watch.limits or limits_of(watch.contact.region, watch.contact.clamped)
        for point in watch.points:
            mobility, row = _arrival(model, point)(q, rate)
            for kind in motors:
                force = _forces(model, mobility, row, rate, watch.contact, kind, horizon)
                shares.append(force * _one_over(limits, force.numel()))
    share = ca.logsumexp(SHARP * ca.vertcat(*shares)) / SHARP
    factor = ca.Function(
        "speed_factor",
        [q, rate],
        [(1 - SHARE_KEPT_FREE) / share],
        ["q", "dq"],
        ["factor"],
        FEW_DIRECTIONS,
    )
    if not compiled:
        return factor
    library = compiled_functions([factor, factor.reverse(1)], c_compiler())
    return factor if library is None else ca.external("speed_factor", str(library))


def _check(model: ImpactModel, motors: Sequence[Motors]) -> None:
    robot = model.robot
    for kind in motors:
        refuse_held(kind, "a speed factor")
    if not motors:
        raise InvalidValue("motors", "names none")
    if robot.loops or robot.has_springs or not all(model.drives.elastic):
        raise InvalidValue("joint_stiffness", "is needed for all joints, and no closed chain")


def _arrival(model: ImpactModel, point: str) -> ca.Function:
    """Return (q, q̇) -> ``ImpactDynamics.mobility`` and the row of J along the point's way."""
    n = model.robot.n
    q, rate = ca.SX.sym("q", n), ca.SX.sym("dq", n)
    J = contact_point_jacobian(model.robot, model.robot.frame(point).name, q)
    velocity = ca.mtimes(J, rate)
    direction = velocity / ca.sqrt(ca.dot(velocity, velocity) + FADING_SPEED**2)
    mass = mass_matrix(model.robot, q) + STEP / 2 * _joint_damping(model)
    mobility = Factorisation(mass).solve(ca.SX.eye(n))
    row = ca.SX(ca.densify(ca.mtimes(direction.T, J)))
    return ca.Function("arrival", [q, rate], [ca.SX(ca.densify(mobility)), row])


def _joint_damping(model: ImpactModel) -> ca.DM:
    """Return the joints' own damping, n×n [N·m·s/rad]."""
    return ca.sparsify(ca.diag(ca.DM(model.robot.damping)))


def _forces(
    model: ImpactModel,
    mobility: Matrix,
    jacobian: Matrix,
    rate: Matrix,
    contact: Contact,
    motors: Motors,
    horizon: float,
) -> MatrixExpression:
    drives, n = model.drives, model.robot.n
    gains = ca.sparsify(ca.diag(ca.DM(drives.gains)))
    damping = ca.DM.zeros(n) if drives.damping_gains is None else ca.DM(drives.damping_gains)
    dynamics = ImpactDynamics(
        mobility=mobility,
        jacobian=jacobian,
        springs=ca.MX(ca.DM(drives.springs)),
        rotor_mobility=ca.MX(1 / known_rotors(model)),
        gains=ca.MX(gains),
        damping=ca.MX(damping),
        velocity=rate,
        joint_damping=_joint_damping(model),
    )
    nodes = ceil(horizon / STEP)
    laws = MotorLaws.of(motors)
    return contact_forces(dynamics, ContactParameters.of(contact), laws, STEP, nodes, 1)


def _one_over(limits: Limits, nodes: int) -> ca.DM:
    """Return one over the limit that counts at each node [1/N]."""
    time = STEP * np.arange(1, nodes + 1)
    late = inf if limits.quasi_static is None else limits.quasi_static.force
    return ca.DM(
        np.where(
            time > QUASI_STATIC_FROM,
            1 / min(limits.transient.force, late),
            1 / limits.transient.force,
        )
    )
