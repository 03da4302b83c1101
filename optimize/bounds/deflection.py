# SPDX-License-Identifier: BSD-3-Clause
"""How far the springs let the tip move under loads."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import casadi as ca

from softimpact.symbolic import STANDARD_GRAVITY, Matrix, frame_jacobian

from ..machine.coordinates import onto
from ..machine.machine import Machine
from .bound import AtMost

ROUNDED = 1e-30
"""Square of a length [m²] that keeps the slope of a deflection of zero finite."""

TipLoad = tuple[float, float, float]


@dataclass(frozen=True)
class Deflection(AtMost):
    """Largest displacement of the tip by the springs, the motors held, under each load.

    It is linear: δ = J k_s⁻¹ (Jᵀf + τ_g), a spring beside a motor being added to k_s. Of springs
    k_s that may be off by a share x, each for itself, it is what no choice of them exceeds: |Σδ_i|
    for the middle of 1/k_s, plus Σ|δ_i| times half the width.

    Attributes:
        most: displacement [m].
        forces: on the tip, base axes [N].
        moments: on the tip, one for each force [N·m]; none: zero.
        payload: point mass at the tip, whose weight acts beside each force [kg].
        sag: whether the links' own weight, and the pull of springs beside motors, counts, too; else
            the motors are set so that it does not.
    """

    kind: ClassVar[str] = "deflection"
    unit: ClassVar[str] = "m"

    most: float
    forces: tuple[TipLoad, ...]
    moments: tuple[TipLoad, ...] = ()
    payload: float = 0.0
    sag: bool = False

    @property
    def name(self) -> str:
        """The field of a study file that it stands in."""
        return "accuracy.max_deflection"

    def figures(self, machine: Machine, q: Matrix) -> Matrix:
        """Return the displacement under each load [m]."""
        J = machine.jacobian(q)
        torques = self.torques(machine, q)
        x = machine.margin
        soft, stiff = machine.compliance(-x), machine.compliance(x)
        found = []
        for k in range(torques.shape[1]):
            torque = torques[:, k]
            moved = ca.mtimes(J, torque * (soft + stiff) / 2)
            length = ca.sqrt(ca.sumsqr(moved) + ROUNDED)
            if x:
                apart = torque * (soft - stiff) / 2
                lengths = ca.sqrt(ca.sum1(J**2).T + ROUNDED)
                length = length + ca.dot(lengths, ca.fabs(apart))
            found.append(length)
        return ca.vertcat(*found)

    def torques(self, machine: Machine, q: Matrix) -> Matrix:
        """Return what each load does to the coordinates, m×k [N·m]."""
        J = machine.jacobian(q)
        forces = ca.DM(self.forces).T
        if self.payload:
            forces = forces + self.payload * ca.DM(STANDARD_GRAVITY)
        torques = ca.mtimes(J.T, forces)
        if any(any(moment) for moment in self.moments):
            turning = frame_jacobian(machine.robot, machine.model.tip, q)[3:, :]
            moments = ca.mtimes(turning.T, ca.DM(self.moments).T)
            torques = torques + onto(machine.model, q, moments)
        if self.sag:  # the weight pulls with the opposite of what holds the links
            own = machine.holding_torques(q)
            torques = torques - ca.repmat(own, 1, torques.shape[1])
        return torques
