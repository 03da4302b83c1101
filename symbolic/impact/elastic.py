# SPDX-License-Identifier: BSD-3-Clause
"""Elastic joints: motors, springs and links as one linear model around rest.

Coordinates put the n motor angles θ first, then the deflections δ of the elastic joints
(MSM §2.2): a link's angle is θ_i + δ_i, or θ_i where the joint is rigid.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import casadi as ca

from ..matrices import Factorisation, Matrix


class MassOperator(Protocol):
    """A mass matrix M0 by what it does to columns."""

    @property
    def matrix(self) -> Matrix:
        """The matrix itself."""
        ...

    def apply(self, x: Matrix) -> Matrix:
        """Return M0 x."""
        ...

    def solve(self, x: Matrix) -> Matrix:
        """Return M0⁻¹ x."""
        ...


@dataclass(frozen=True, eq=False)
class DenseMass:
    """Any symmetric positive definite mass matrix."""

    matrix: Matrix

    def apply(self, x: Matrix) -> Matrix:
        """Return M0 x."""
        return ca.mtimes(self.matrix, x)

    def solve(self, x: Matrix) -> Matrix:
        """Return M0⁻¹ x."""
        return Factorisation(self.matrix).solve(x)


@dataclass(frozen=True, eq=False)
class ElasticMass:
    """Mass matrix of a robot whose joints are all elastic: M0 = [[M+B, M], [M, M]].

    Its inverse is [[B⁻¹, −B⁻¹], [−B⁻¹, M⁻¹+B⁻¹]], so only M is ever factorised.

    Attributes:
        links: M, n×n.
        rotors: diagonal of B, length n.
    """

    links: Matrix
    rotors: Matrix

    @property
    def matrix(self) -> Matrix:
        """M0, 2n×2n."""
        M = self.links
        return ca.blockcat([[M + ca.diag(self.rotors), M], [M, M]])

    def apply(self, x: Matrix) -> Matrix:
        """Return M0 x."""
        motors, deflections = ca.vertsplit(x, x.shape[0] // 2)
        links = ca.mtimes(self.links, motors + deflections)
        return ca.vertcat(links + ca.diag(self.rotors) @ motors, links)

    def solve(self, x: Matrix) -> Matrix:
        """Return M0⁻¹ x."""
        on_motors, on_deflections = ca.vertsplit(x, x.shape[0] // 2)
        relative = ca.diag(1 / self.rotors) @ (on_motors - on_deflections)
        links = Factorisation(self.links).solve(on_deflections)
        return ca.vertcat(relative, links - relative)


@dataclass(frozen=True, eq=False)
class LinearModel:
    """The robot around its motion before the impact: M0 z̈ + D ż + K0 z = −J_cᵀ f_c (MSM Eq. 5).

    Attributes:
        mass: M0, N×N [kg m², kg].
        stiffness: K0, N×N [N·m/rad, N/m].
        jacobian: J_c, 1×N.
        damping: D, N×N [N·m·s/rad, N·s/m]; None where nothing damps.
    """

    mass: MassOperator
    stiffness: Matrix
    jacobian: Matrix
    damping: Matrix | None = None


def elastic_mass(links: Matrix, rotors: Matrix, elastic: Sequence[bool]) -> MassOperator:
    """Return M0 of a robot with some elastic joints.

    Args:
        links: mass matrix M of the links, n×n.
        rotors: reflected rotor inertias, length n.
        elastic: whether each joint is elastic; the others' links turn with their rotors.
    """
    if all(elastic):
        return ElasticMass(links, rotors)
    E = _deflecting(elastic)
    motors = links + ca.diag(rotors)
    if not E:
        return DenseMass(motors)
    return DenseMass(ca.blockcat([[motors, links[:, E]], [links[E, :], links[E, E]]]))


def elastic_stiffness(
    springs: Matrix, gains: Matrix, potential: Matrix, elastic: Sequence[bool]
) -> Matrix:
    """Return K0, the Hessian of springs, controller and gravity (MSM Eq. 45, its footnote 4).

    Args:
        springs: joint stiffnesses k_s, length n; entries of rigid joints are not read.
        gains: proportional gains K_p on the motors, n×n (sparse where it is diagonal).
        potential: Hessian of gravity over link angles, n×n (sparse zero without gravity).
        elastic: whether each joint is elastic.
    """
    E = _deflecting(elastic)
    motors = gains + potential
    if not E:
        return motors
    return ca.blockcat(
        [[motors, potential[:, E]], [potential[E, :], ca.diag(springs[E]) + potential[E, E]]]
    )


def elastic_jacobian(jacobian: Matrix, elastic: Sequence[bool]) -> Matrix:
    """Return J_c = [J, J_E]: motors and deflections move the links alike."""
    return ca.horzcat(jacobian, jacobian[:, _deflecting(elastic)])


def _deflecting(elastic: Sequence[bool]) -> list[int]:
    return [i for i, is_elastic in enumerate(elastic) if is_elastic]
