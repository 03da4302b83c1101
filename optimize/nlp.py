# SPDX-License-Identifier: BSD-3-Clause
"""The co-design problem as a nonlinear program: least peak force over posture and stiffness.

Variables are the link angles q, s = log10 k_s and the peak force F (in units of a reference
force). F is minimised over its epigraph F ≥ f_k at nodes along the first contact, subject to the
tip's pose, the springs' deflection under given forces, joint limits and stiffness bounds. The
impact is simulated inside the constraints (``impact_forces``), so there are no states.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from softimpact.symbolic import (
    ImpactModel,
    Matrix,
    contact_point_jacobian,
    direction_jacobian,
    frame_pose,
    least_velocity,
)
from softimpact.symbolic.matrices import Factorisation
from softimpact.symbolic.robot.rigid import Array

from .impact_forces import FEW_DIRECTIONS, ContactParameters, ImpactDynamics, contact_forces
from .study import Study

HALF_TURN = 1e-12
"""Keeps the pose error of a tip turned by exactly half a turn finite, and from vanishing there."""


@dataclass(frozen=True, eq=False)
class DesignNlp:
    """Functions of the problem; numbers of a study enter as parameters.

    Attributes:
        oracle: (x, p) -> (f, g) of the NLP, x = [q, s, F].
        n: number of joints.
        wrenches: number of forces on the tip that bound the deflection.
        nodes: times at which the force bounds F from below.
    """

    oracle: ca.Function
    n: int
    wrenches: int
    nodes: int

    @property
    def pose(self) -> slice:
        """Entries of g that are the tip's pose error."""
        return slice(0, 6)

    @property
    def forces(self) -> slice:
        """Entries of g that are f_k − F."""
        return slice(6 + self.wrenches, 6 + self.wrenches + self.nodes)


def tip_pose_error(model: ImpactModel, q: Matrix, position: Matrix, rotation: Matrix) -> Matrix:
    """Return the tip's pose error, length 6: position [m] and 2 sin(angle/2) about its axis [rad].

    The half angle matters: the sine of the whole angle also vanishes for a tip turned round.
    """
    pose = frame_pose(model.robot, model.tip, q)
    E = ca.mtimes(rotation.T, pose.rotation)
    sine = ca.vertcat(E[2, 1] - E[1, 2], E[0, 2] - E[2, 0], E[1, 0] - E[0, 1])
    square = ca.fmax(1 + ca.trace(E), 0) + HALF_TURN  # 4 cos²(angle/2)
    return ca.vertcat(pose.position - position, sine / ca.sqrt(square) + HALF_TURN / square)


def deflections(model: ImpactModel, q: Matrix, springs: Matrix, forces: Matrix) -> Matrix:
    """Return the tip's displacements by the springs alone, 3×k [m], under forces 3×k [N].

    The motors hold their positions, so that K⁻¹ = J k_s⁻¹ Jᵀ.
    """
    J = contact_point_jacobian(model.robot, model.tip, q)
    return ca.mtimes(J, ca.mtimes(J.T, forces) / ca.repmat(springs, 1, forces.shape[1]))


def build_nlp(model: ImpactModel, wrenches: int, nodes: int, substeps: int) -> DesignNlp:
    """Return the NLP of a robot whose joints are all elastic.

    Args:
        model: robot, tip and drives; its springs are replaced by the variables.
        wrenches: number of forces that bound the deflection.
        nodes: times at which the force bounds F from below.
        substeps: time steps of the impact from node to node.
    """
    n = model.robot.n
    x = ca.MX.sym("x", 2 * n + 1)
    q, s, peak = ca.vertsplit(x, [0, n, 2 * n, 2 * n + 1])
    p = ca.MX.sym("p", _parameter_size(wrenches))
    direction, speed, contact, step, position, rotation, forces, bound, unit = ca.vertsplit(
        p, _parameter_offsets(wrenches)
    )
    rotation, forces = ca.reshape(rotation, 3, 3), ca.reshape(forces, 3, wrenches)
    springs = 10**s
    mobility, jacobian, velocity, gains, error, given_way = _posture(model, wrenches)(
        q, springs, direction, position, rotation, forces
    )
    rotors = model.drives.rotors
    dynamics = ImpactDynamics(mobility, jacobian, springs, rotors, gains, velocity * speed)
    pressed = contact_forces(
        dynamics, ContactParameters(*ca.vertsplit(contact)), step, nodes, substeps
    )
    slack = ca.sum1(given_way**2).T / bound**2 - 1
    g = ca.vertcat(error, slack, pressed / unit - peak)
    oracle = ca.Function("oracle", [x, p], [peak, g], ["x", "p"], ["f", "g"], FEW_DIRECTIONS)
    return DesignNlp(oracle, n, wrenches, nodes)


def _posture(model: ImpactModel, wrenches: int) -> ca.Function:
    """Return everything that depends on the posture alone, as one scalar expression graph."""
    n = model.robot.n
    q, springs = ca.SX.sym("q", n), ca.SX.sym("k_s", n)
    direction, position = ca.SX.sym("n", 3), ca.SX.sym("position", 3)
    rotation, forces = ca.SX.sym("R", 3, 3), ca.SX.sym("forces", 3, wrenches)
    outputs = [
        Factorisation(model.mass_matrix(q)).solve(ca.SX.eye(n)),
        direction_jacobian(model.robot, model.tip, q, direction),
        least_velocity(model.jacobian(q), direction),
        ca.SX(model.position_gains(q)),
        tip_pose_error(model, q, position, rotation),
        deflections(model, q, springs, forces),
    ]
    inputs = [q, springs, direction, position, rotation, forces]
    return ca.Function("posture", inputs, ca.cse(outputs), FEW_DIRECTIONS)


def _parameter_sizes(wrenches: int) -> list[int]:
    return [3, 1, 4, 1, 3, 9, 3 * wrenches, 1, 1]


def _parameter_offsets(wrenches: int) -> list[int]:
    return [0, *np.cumsum(_parameter_sizes(wrenches)).tolist()]


def _parameter_size(wrenches: int) -> int:
    return sum(_parameter_sizes(wrenches))


def parameters(study: Study, position: Array, rotation: Array, step: float, unit: float) -> Array:
    """Return a study's numbers in the order of the NLP's parameters.

    Args:
        study: the study.
        position: where the tip is held, length 3 [m].
        rotation: how the tip is held, 3×3.
        step: time step of the impact [s].
        unit: force that F = 1 stands for [N].
    """
    return np.concatenate(
        [
            study.direction,
            [study.speed],
            np.array(ContactParameters.of(study.contact), dtype=float),
            [step],
            position,
            rotation.ravel(order="F"),
            study.forces.ravel(),
            [study.max_deflection, unit],
        ]
    )
