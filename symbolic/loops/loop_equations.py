# SPDX-License-Identifier: BSD-3-Clause
"""The equations of a closed chain: gaps of its loops, their derivatives, and what follows.

Every loop asks that two points coincide, every coupling that one coordinate follows from others:
φ(q) = 0. The coordinates of independent joints then
decide the others': q̇ = G q̇_ind. An open chain has no φ, and G = I.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from ..content import ByContent
from ..dynamics.equations_of_motion import potential_energy, stiffness_of_potential
from ..dynamics.kinematics import motions, poses
from ..matrices import Matrix, on_scalars
from ..robot.constraints import Coupling, Loop
from ..robot.joint_frames import customised
from ..robot.rigid import Array
from ..robot.robot import Robot

LONGEST_MINOR = 3
"""Most equations that are solved by minors, which take fewer operations and no square roots."""


@dataclass(frozen=True, eq=False)
class ClosedChain(ByContent):
    """A robot's loops as equations between its joints' coordinates.

    Attributes:
        robot: any robot.
        axes: for each loop the k×3 directions along which its ends could part; the others, such
            as the normal of a planar loop, are left out. A coupling's single equation has a row of
            one number.
        home: a configuration at which all loops are closed, length n.
        independent: indices of the joints that describe the chain: motors first, then springs.
        dependent: indices of the joints that follow, one for each equation.
    """

    robot: Robot
    axes: tuple[Array, ...]
    home: Array
    independent: tuple[int, ...]
    dependent: tuple[int, ...]


def gaps(chain: ClosedChain, q: Matrix) -> Matrix:
    """Return φ(q), how far apart the loops' ends are along the chain's axes [m], length r.

    Of a coupling, how far off its driven joints are [rad, m].
    """
    return on_scalars(_gaps, (chain,), q)


def gap_jacobian(chain: ClosedChain, q: Matrix) -> Matrix:
    """Return Φ = ∂φ/∂q, r×n."""
    return on_scalars(_jacobian, (chain,), q)


def gap_acceleration(chain: ClosedChain, q: Matrix, velocity: Matrix) -> Matrix:
    """Return Φ̇ q̇, length r: φ̈ = Φ q̈ + Φ̇ q̇."""
    return on_scalars(_acceleration, (chain,), q, velocity)


def tangent(chain: ClosedChain, q: Matrix) -> Matrix:
    """Return G = ∂q/∂q_ind, n×(n−r)."""
    return on_scalars(_tangent, (chain,), q)


def stiffness_along(chain: ClosedChain, gravity: tuple[float, ...], q: Matrix) -> Matrix:
    """Return Gᵀ ∇²(V + λᵀφ) G over the independent joints."""
    if not chain.dependent:
        return stiffness_of_potential(chain.robot, q, gravity)
    return on_scalars(_constrained_hessian, (chain, gravity), q)


def _gaps(chain: ClosedChain, q: Matrix) -> Matrix:
    robot = customised(chain.robot)
    known = poses(robot, motions(robot, q))
    place = {name: i for i, name in enumerate(robot.joint_names)}
    rows = []
    for loop, axes in zip(robot.loops, chain.axes, strict=True):
        if isinstance(loop, Coupling):
            rows.append(ca.SX(loop.gap(lambda name: q[place[name]])))
            continue
        assert isinstance(loop, Loop)  # others are refused before
        ends = []
        for name in (loop.first, loop.second):
            frame = robot.frame(name)
            carrier, offset = known[frame.joint], ca.DM(frame.placement.translation)
            ends.append(carrier.position + ca.mtimes(carrier.rotation, ca.SX(ca.sparsify(offset))))
        rows.append(ca.mtimes(ca.SX(ca.sparsify(ca.DM(axes))), ends[0] - ends[1]))
    return ca.densify(ca.vertcat(*rows))


def _jacobian(chain: ClosedChain, q: Matrix) -> Matrix:
    symbol = ca.SX.sym("q", chain.robot.n)
    jacobian = ca.jacobian(_gaps(chain, symbol), symbol)
    return ca.substitute(ca.densify(jacobian), symbol, q)


def _acceleration(chain: ClosedChain, q: Matrix, velocity: Matrix) -> Matrix:
    position, rate = ca.SX.sym("q", chain.robot.n), ca.SX.sym("dq", chain.robot.n)
    speed = ca.jtimes(_gaps(chain, position), position, rate)
    bent = ca.densify(ca.jtimes(speed, position, rate))
    return ca.substitute([bent], [position, rate], [ca.SX(q), ca.SX(velocity)])[0]


def _tangent(chain: ClosedChain, q: Matrix) -> Matrix:
    jacobian = _jacobian(chain, q)
    free, bound = list(chain.independent), list(chain.dependent)
    G = ca.SX(chain.robot.n, len(free))
    for column, joint in enumerate(free):
        G[joint, column] = 1
    if bound:
        G[bound, :] = -solve_few(jacobian[:, bound], jacobian[:, free])
    return G


def _constrained_hessian(chain: ClosedChain, gravity: tuple[float, ...], q: Matrix) -> Matrix:
    robot, bound = chain.robot, list(chain.dependent)
    symbol, force = ca.SX.sym("q", robot.n), ca.SX.sym("l", len(bound))
    energy, gaps = potential_energy(robot, symbol, gravity), _gaps(chain, symbol)
    pull = ca.substitute(ca.densify(ca.gradient(energy, symbol)), symbol, q)[bound]
    held = -solve_few(_jacobian(chain, q)[:, bound].T, pull)
    hessian, _ = ca.hessian(energy + ca.dot(force, gaps), symbol)
    H = ca.substitute([ca.densify(hessian)], [symbol, force], [ca.SX(q), held])[0]
    G = _tangent(chain, q)
    return ca.mtimes([G.T, H, G])


def solve_few(matrix: Matrix, right: Matrix) -> Matrix:
    """Solve a few linear equations without pivots that could vanish (SX)."""
    if matrix.shape[0] <= LONGEST_MINOR:
        return ca.mtimes(ca.inv_minor(matrix), right)
    return ca.solve(matrix, right)
