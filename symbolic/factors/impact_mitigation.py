# SPDX-License-Identifier: BSD-3-Clause
"""Impact mitigation of floating robots: what the joints take off the locked robot's impact."""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca

from ..impact.floating import BASE_COORDINATES
from ..matrices import Factorisation, Matrix, symmetric
from .contact_mobility import ContactMobility


@dataclass(frozen=True, eq=False)
class ImpactMitigation:
    """A floating robot's contact point with all joints locked, and what unlocking them adds.

    Attributes:
        locked: mobility G_L = Λ_L⁻¹ with all joints locked (GIAF Eq. 18).
        yielding: G − G_L ⪰ 0, what the joints add to it.
    """

    locked: ContactMobility
    yielding: ContactMobility

    @property
    def real(self) -> ContactMobility:
        """Mobility G = Λ⁻¹ of the robot as it is."""
        return ContactMobility(self.locked.matrix + self.yielding.matrix)

    @property
    def matrix(self) -> Matrix:
        """Impact mitigation matrix Ξ = I − Λ Λ_L⁻¹, 3×3 (GIAF Eq. 20)."""
        return ca.mtimes(self.real.inertia, self.yielding.matrix)

    @property
    def factor(self) -> Matrix:
        """Impact mitigation factor ξ = det Ξ, from 0 to 1 (GIAF Eq. 21)."""
        return self.yielding.determinant / self.real.determinant

    def directional(self, direction: Matrix) -> Matrix:
        """Return ξ_n = 1 − nᵀΛ_L⁻¹n / nᵀΛ⁻¹n, the share of the impulse along n that is spared."""
        spared, whole = (
            ca.dot(direction, ca.mtimes(mobility.matrix, direction))
            for mobility in (self.yielding, self.real)
        )
        return spared / whole


def impact_mitigation(mass_matrix: Matrix, jacobian: Matrix) -> ImpactMitigation:
    """Return the impact mitigation of a floating robot.

    Elimination of the base's six coordinates first splits G = G_L + (G − G_L) into two sums of
    squares, so that nothing cancels.

    Args:
        mass_matrix: H with rotors, the base's coordinates first, (6+n)×(6+n).
        jacobian: translational J = [J_b, J_j], 3×(6+n).
    """
    factors = Factorisation(mass_matrix)
    y = [factors.halfway(jacobian[k, :].T) for k in range(3)]

    def part(where: slice) -> ContactMobility:
        def entry(i: int, j: int) -> Matrix:
            terms = zip(y[i][where], y[j][where], factors.d[where], strict=True)
            return sum((a * b / d for a, b, d in terms), start=ca.DM(0.0))

        return ContactMobility(symmetric(entry, 3))

    return ImpactMitigation(part(slice(0, BASE_COORDINATES)), part(slice(BASE_COORDINATES, None)))
