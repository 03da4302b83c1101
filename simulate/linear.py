# SPDX-License-Identifier: BSD-3-Clause
"""Linear models of the robot under a law of its motors, as vibration modes."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from softimpact.symbolic import Chain, ImpactModel, InvalidValue, chain, generalised_velocity
from softimpact.symbolic.impact.chain import ChainEnd
from softimpact.symbolic.impact.motors import PRESCRIBED, MotorLaw
from softimpact.symbolic.robot.rigid import Array

from .arrival import Arrival
from .mechanism import BodyKind, Mechanism
from .scene import Motion
from .simulator import Simulator, build_simulator


@dataclass(frozen=True, eq=False)
class LinearSystem:
    """M z̈ + D ż + K z = −Jᵀ f_c + forces that do not depend on the impact.

    z is the deviation from the motion before the impact, of the coordinates ``moving``, which are
    some of the model's; those ``given`` move as the motors' law has it. Arrays of many systems have
    a leading axis.

    Attributes:
        shapes: how the coordinates that move do so with each of the system's own, N×r; a chain
            has fewer than there are coordinates.
        mass: M, r×r.
        stiffness: K, r×r.
        damping: D, r×r, or None.
        jacobian: J, length r.
        moving: indices of the coordinates that move, length N.
        given: indices of the others.
        whole: M0, K0, D and J_c over all coordinates, as arrays; D is zero where nothing damps.
        drift: K_pot q̇0, with which gravity and the file's springs pull as the robot moves on, per
            second and 1 m/s of approach; of held motors also what K_p pulls back.
    """

    shapes: Array
    mass: Array
    stiffness: Array
    damping: Array | None
    jacobian: Array
    moving: list[int]
    given: list[int]
    whole: tuple[Array, Array, Array, Array]
    drift: Array


def linear_system(
    model: ImpactModel,
    arrival: Arrival,
    law: MotorLaw,
    order: int | None = None,
    end: ChainEnd | None = None,
) -> LinearSystem:
    """Return the robot around its motion before the impact, or a chain of it.

    Args:
        model: the robot.
        arrival: how it arrives.
        law: of the motors.
        order: number of the chain's masses; fewer where it closes before; None keeps all.
        end: of the chain; None drops its spring to ground where motors are free.

    Raises:
        InvalidValue: there is no chain of that order, or an elastic joint without a rotor.
    """
    q, n = arrival.q, arrival.direction
    moving = model.moving(law)
    given = [i for i in range(model.size) if i not in moving]
    linear = model.linear(q, n, law)
    M, K, J = (_array(x) for x in (linear.mass.matrix, linear.stiffness, linear.jacobian))
    D = None if linear.damping is None else _array(linear.damping)
    S: Array = np.eye(len(moving))
    m: Array = M
    k: Array = K
    if order is not None and moving:
        check_order(model, order)
        masses = chain(
            linear,
            min(order, len(moving)),
            end or ("free" if law == "free" else "grounded"),
            reorthogonalise=True,
        )
        m, k = np.diag([float(x) for x in masses.mass]), chain_stiffness(masses)
        S = _array(np.linalg.solve(M, _array(masses.displacement) @ m))
    return LinearSystem(
        shapes=S,
        mass=m,
        stiffness=k,
        damping=None if D is None else S.T @ D @ S,
        jacobian=J.ravel() @ S,
        moving=moving,
        given=given,
        whole=_whole(model, arrival, law),
        drift=_drift(model, arrival, law),
    )


def _whole(
    model: ImpactModel, arrival: Arrival, law: MotorLaw
) -> tuple[Array, Array, Array, Array]:
    """Return M0, K0, D and J_c over all coordinates, with gains where a servo has them."""
    model = model if law in ("servo", "held") else _without_gains(model)
    q, size = arrival.q, model.size
    damping = model.generalised_damping(q)
    return (
        _array(model.generalised_mass(q).matrix),
        _array(model.generalised_stiffness(q)),
        np.zeros((size, size)) if damping is None else _array(damping),
        _array(model.contact_jacobian(q, arrival.direction)).ravel(),
    )


def _drift(model: ImpactModel, arrival: Arrival, law: MotorLaw) -> Array:
    pulls = model if law == "held" else _without_gains(model)
    return _array(pulls.generalised_stiffness(arrival.q)) @ generalised_velocity(
        model, arrival.link_velocity
    )


def _without_gains(model: ImpactModel) -> ImpactModel:
    return model.with_drives(model.drives.without_gains())


def check_order(model: ImpactModel, order: int) -> None:
    """Raise InvalidValue if a robot has no chain of so many masses."""
    if not 1 <= order <= model.size:
        raise InvalidValue("order", f"must be from 1 to {model.size}, the robot's coordinates")


def chain_stiffness(masses: Chain) -> Array:
    """Return the stiffness matrix of a chain's springs, r×r."""
    K = np.zeros((masses.order, masses.order))
    for i, stiffness in enumerate(masses.stiffness):
        K[i, i] += float(stiffness)
        if i + 1 < masses.order:
            K[i + 1, i + 1] += float(stiffness)
            K[i, i + 1] = K[i + 1, i] = -float(stiffness)
    return K


def _array(matrix: ArrayLike) -> Array:
    return np.array(matrix, dtype=float)


@dataclass(frozen=True, eq=False)
class Modes:
    """A linear system by its modes y, of mass one: ÿ + ω² y + C ẏ = −φ f_c + given forces.

    Those of many systems have a leading axis.

    Attributes:
        squared_frequency: ω², length r [1/s²].
        shape: φ, length r [1/√kg]; the contact point moves by φᵀ y.
        basis: how the system's moving coordinates move with the modes, N×r.
        into: from these to the modes, r×N.
        damping: C, r×r, or None.
    """

    squared_frequency: Array
    shape: Array
    basis: Array
    into: Array
    damping: Array | None


def modes(system: LinearSystem) -> Modes:
    """Return the modes of a linear system, or of many."""
    root = np.asarray(np.linalg.cholesky(system.mass), dtype=float)
    half = np.asarray(np.linalg.solve(root, system.stiffness), dtype=float)
    squared_frequency, vectors = np.linalg.eigh(np.linalg.solve(root, _turned(half)))
    own = np.linalg.solve(_turned(root), vectors)
    basis = system.shapes @ own
    M = _block(system.whole[0], system.moving, system.moving)
    damping = None if system.damping is None else _turned(own) @ system.damping @ own
    shape = _on(_turned(own), system.jacobian)
    return Modes(squared_frequency, shape, basis, _turned(basis) @ M, damping)


def _turned(matrix: Array) -> Array:
    return np.swapaxes(matrix, -1, -2)


def _block(matrix: Array, rows: list[int], columns: list[int]) -> Array:
    return np.asarray(matrix[..., rows, :][..., columns])


def _on(matrix: Array, vector: Array) -> Array:
    return np.asarray((matrix @ vector[..., None])[..., 0])


@dataclass(frozen=True, eq=False)
class Given:
    """What does not depend on the impact, as polynomials in the time since a stage began.

    Everything is for an approach of 1 m/s; of many impacts with a leading axis.

    Attributes:
        force: on each mode, coefficients of 1, τ, τ², r×3.
        displacement: of the contact point [m], coefficients of the same, length 3.
    """

    force: Array
    displacement: Array


def given_motion(
    system: LinearSystem,
    found: Modes,
    law: MotorLaw,
    motion: Motion,
    arrival_rate: Array,
    begin: float | Array,
    stopping_time: float,
) -> tuple[Given, Array]:
    """Return the given forces and displacement of a stage, and the motors' given deviation.

    Args:
        system: of the stage.
        found: its modes.
        law: of the motors.
        motion: of all coordinates when it begins, coordinates last.
        arrival_rate: q̇0 over all coordinates per 1 m/s of approach.
        begin: of the stage since first touch [s].
        stopping_time: of motors that brake [s].

    Returns:
        The polynomials, and coefficients of 1, τ, τ² of the motors' deviation, P×3.
    """
    P, F = system.given, system.moving
    position, rate = motion.position[..., P], motion.velocity[..., P]
    deviation = np.zeros((*position.shape, 3))
    if law in PRESCRIBED:
        bend = -(arrival_rate[..., P] + rate) / stopping_time if law == "braking" else 0 * rate
        if law == "stopped":
            rate = 0 * rate - arrival_rate[..., P]
        deviation = np.stack([position, rate, bend / 2], axis=-1)
    M, K, D, J = system.whole
    bent = 2 * deviation[..., 2]
    rates = np.stack([deviation[..., 1], bent, 0 * bent], axis=-1)
    forces = -_block(K, F, P) @ deviation - _block(D, F, P) @ rates
    since = np.asarray(begin)
    forces[..., 0] -= _on(_block(M, F, P), bent) + system.drift[..., F] * since[..., None]
    forces[..., 1] -= system.drift[..., F]
    ahead = np.stack([since, since**0, 0 * since], axis=-1)
    displacement = ahead + (J[..., P, None] * deviation).sum(axis=-2)
    return Given(_turned(found.basis) @ forces, displacement), deviation


@lru_cache(maxsize=64)
def modal_simulator(size: int, kind: BodyKind, damped: bool, tolerance: float) -> Simulator:
    """Return the simulator of any linear system of ``size`` modes.

    Its parameters are v, ω², φ, the given force's and displacement's coefficients, and C (if the
    system is damped); its memory is v times the time since the stage began.
    """
    y, rate, force = ca.SX.sym("y", size), ca.SX.sym("dy", size), ca.SX.sym("f_c")
    speed, moved = ca.SX.sym("v"), ca.SX.sym("vt")
    squared_frequency, shape = ca.SX.sym("w2", size), ca.SX.sym("phi", size)
    given, ahead = ca.SX.sym("g", size, 3), ca.SX.sym("c", 3)
    C = ca.SX.sym("C", size if damped else 0, size if damped else 0)
    powers = ca.vertcat(speed, moved, moved**2 / speed)
    acceleration = -squared_frequency * y - shape * force + ca.mtimes(given, powers)
    if damped:
        acceleration -= ca.mtimes(C, rate)
    robot = Mechanism(
        position=y,
        velocity=rate,
        force=force,
        parameters=ca.vertcat(speed, squared_frequency, shape, ca.vec(given), ahead, ca.vec(C)),
        acceleration=acceleration,
        displacement=ca.dot(shape, y) + ca.dot(ahead, powers),
        memory=moved,
        memory_rate=speed,
    )
    return build_simulator(robot, kind, tolerance)
