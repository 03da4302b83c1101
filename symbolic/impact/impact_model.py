# SPDX-License-Identifier: BSD-3-Clause
"""A robot about to hit something: everything its impact needs, as CasADi expressions."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, Literal, overload

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from ..content import ByContent
from ..dynamics.equations_of_motion import Gravity, mass_matrix, stiffness_of_potential
from ..dynamics.kinematics import contact_point_jacobian, direction_jacobian
from ..errors import InvalidValue, WrongLength
from ..factors.contact_mobility import ContactMobility, contact_mobility
from ..former_names import renamed
from ..loops.loops import closed_chain, constrained_stiffness, loop_tangent
from ..matrices import Kind, Matrix, Numbers, symmetric
from ..robot.rigid import Array, three_numbers
from ..robot.robot import BASE, Robot, vector_of
from .chain import Chain, ChainEnd, chain
from .drives import Drives, require_rotors
from .drives import drives as drives_with
from .elastic import (
    DenseMass,
    ElasticMass,
    LinearModel,
    MassOperator,
    elastic_jacobian,
    elastic_mass,
    elastic_stiffness,
)
from .motors import PRESCRIBED, MotorLaw
from .reduction import ReducedModel, reduce_to_two_masses, reflected_mass

WEIGHTLESS = (0.0, 0.0, 0.0)
"""Gravity of a model that leaves gravity out of K0."""


@dataclass(frozen=True, eq=False)
class ImpactModel(ByContent):
    """A robot, its contact point and its drives; methods take q and n of any matrix kind.

    Link angles q have one entry a joint. Generalised coordinates are the motor angles followed by
    the deflections of the elastic joints. In a closed chain they are those of the independent
    joints, over which all matrices are then, while q still has one entry a joint and closes the
    loops.

    Attributes:
        robot: the rigid robot.
        tip: frame whose origin is the contact point.
        drives: rotors, springs and gains; numbers or symbols.
        gravity: whose curvature enters K0 [m/s²]; zero leaves it out.
    """

    robot: Robot
    tip: str
    drives: Drives
    gravity: tuple[float, float, float] = WEIGHTLESS

    @property
    def independent(self) -> tuple[int, ...]:
        """Indices of the joints whose coordinates describe the robot: all, without loops."""
        return closed_chain(self.robot).independent

    @property
    def elastic(self) -> tuple[bool, ...]:
        """Whether each independent joint is elastic."""
        return tuple(self.drives.elastic[i] for i in self.independent)

    @property
    def actuated(self) -> tuple[bool, ...]:
        """Whether each independent joint has a motor."""
        return tuple(self.robot.actuated[i] for i in self.independent)

    @property
    def size(self) -> int:
        """Number of generalised coordinates."""
        return len(self.elastic) + sum(self.elastic)

    def vector(self, name: str, values: ArrayLike) -> Array:
        """Check that ``values`` has one entry an independent joint; raises WrongLength."""
        return vector_of([self.robot.joint_names[i] for i in self.independent], name, values)

    @overload
    def mass_matrix(self, q: Kind) -> Kind: ...
    @overload
    def mass_matrix(self, q: Numbers) -> ca.DM: ...
    def mass_matrix(self, q: Matrix) -> Matrix:
        """Return the links' mass matrix M (of a closed chain GᵀMG), n×n [kg m²]."""
        return self.congruent(q, mass_matrix(self.robot, q))

    def rotor_mass_matrix(self, q: Matrix) -> Matrix:
        """Return M + B, the mass matrix of the rigid robot with its rotors, n×n."""
        return self.mass_matrix(q) + self.congruent(q, ca.diag(self.drives.rotors))

    def generalised_mass(self, q: Matrix) -> MassOperator:
        """Return M0 over motors and deflections (MSM Eq. 42)."""
        links, rotors = self.mass_matrix(q), self.drives.rotors
        if self.robot.loops:  # rotors of joints that follow turn with the links
            free = list(self.independent)
            follows = ca.sparsify(ca.DM([float(i not in free) for i in range(self.robot.n)]))
            links = links + self.congruent(q, ca.diag(rotors * follows))
            rotors = rotors[free]
        return elastic_mass(links, rotors, self.elastic)

    def generalised_stiffness(self, q: Matrix) -> Matrix:
        """Return K0 over motors and deflections (MSM Eq. 45)."""
        springs = self.drives.springs[list(self.independent)]
        return elastic_stiffness(
            springs, self.position_gains(q), self.potential_stiffness(q), self.elastic
        )

    def generalised_damping(self, q: Matrix) -> Matrix | None:
        """Return D over motors and deflections: K_d on the motors, the joints' own on the links.

        None where nothing damps.
        """
        gains, own = self.drives.damping_gains, self.robot.damping
        is_symbol = gains is not None and not isinstance(gains, ca.DM)
        if not own.any() and not is_symbol and (gains is None or not np.any(np.array(gains))):
            return None
        n = self.robot.n
        links = self.congruent(q, ca.sparsify(ca.diag(ca.DM(own))))
        motors = self.congruent(q, ca.diag(ca.DM.zeros(n) if gains is None else gains))
        return elastic_stiffness(ca.DM.zeros(len(self.elastic)), motors, links, self.elastic)

    def contact_jacobian(self, q: Matrix, direction: Matrix) -> Matrix:
        """Return J_c over motors and deflections, 1×N (MSM Eq. 4)."""
        return elastic_jacobian(self.direction_row(q, direction), self.elastic)

    def linear(self, q: Matrix, direction: Matrix, law: MotorLaw | None = None) -> LinearModel:
        """Return M0, K0, D and J_c at q, hit along the unit vector ``direction``.

        Args:
            q: link angles, length n.
            direction: unit vector n.
            law: of the motors; None is a servo with the gains of the drives. Where it prescribes
                the motors' motion, the model is over ``moving(law)`` alone, and springs take the
                place of rotors and gains: M ẍ + k_s x = −Jᵀ f_c.
        """
        if law == "free":
            return self.with_drives(self.drives.without_gains()).linear(q, direction)
        if law == "held":
            return self.with_drives(replace(self.drives, damping_gains=None)).linear(q, direction)
        F = self.moving(law)
        stiffness, damping = self.generalised_stiffness(q), self.generalised_damping(q)
        jacobian = self.contact_jacobian(q, direction)
        driven = self.robot.actuated if law in PRESCRIBED else ()
        require_rotors(self.drives, self.robot.joint_names, driven)
        if law not in PRESCRIBED:
            return LinearModel(self.generalised_mass(q), stiffness, jacobian, damping)
        if damping is not None:
            damping = damping[F, F]
        mass = DenseMass(self.generalised_mass(q).matrix[F, F])
        return LinearModel(mass, stiffness[F, F], jacobian[:, F], damping)

    def moving(self, law: MotorLaw | None) -> list[int]:
        """Return the indices of the generalised coordinates that an impact moves under a law."""
        if law not in PRESCRIBED:
            return list(range(self.size))
        n = len(self.elastic)
        return [i for i in range(self.size) if i >= n or not self.actuated[i]]

    def reflected_mass(self, q: Matrix, direction: Matrix) -> Matrix:
        """Return m_c [kg] (MSM Eq. 36); rotors behind springs do not count."""
        mass = self.generalised_mass(q)
        if isinstance(mass, ElasticMass):
            return reflected_mass(mass.links, self.direction_row(q, direction))
        return reflected_mass(mass.matrix, self.contact_jacobian(q, direction))

    def reduced(self, q: Matrix, direction: Matrix) -> ReducedModel:
        """Return m_c, k_r and m_a (MSM Eq. 36-38)."""
        return reduce_to_two_masses(self.linear(q, direction))

    def chain(
        self,
        q: Matrix,
        direction: Matrix,
        order: int = 3,
        end: ChainEnd = "grounded",
        *,
        reorthogonalise: bool | Literal["once"] = False,
    ) -> Chain:
        """Return the chain of ``order`` masses, see ``softimpact.symbolic.impact.chain``."""
        return chain(self.linear(q, direction), order, end, reorthogonalise=reorthogonalise)

    @overload
    def jacobian(self, q: Kind, axes_of: int = BASE) -> Kind: ...
    @overload
    def jacobian(self, q: Numbers, axes_of: int = BASE) -> ca.DM: ...
    def jacobian(self, q: Matrix, axes_of: int = BASE) -> Matrix:
        """Return the contact point's translational J, 3×n, in the axes of a joint's frame."""
        J = contact_point_jacobian(self.robot, self.tip, q, axes_of)
        return ca.mtimes(J, loop_tangent(self.robot, q)) if self.robot.loops else J

    def free_mobility(self, q: Matrix, axes_of: int = BASE) -> ContactMobility:
        """Return J M⁻¹ Jᵀ = Λ_F⁻¹, the mobility without rotors (GIAF Eq. 24)."""
        return contact_mobility(self.mass_matrix(q), self.jacobian(q, axes_of))

    def mobility(self, q: Matrix, axes_of: int = BASE) -> ContactMobility:
        """Return J (M+B)⁻¹ Jᵀ = Λ⁻¹, the mobility with rotors (GIAF Eq. 23)."""
        return contact_mobility(self.rotor_mass_matrix(q), self.jacobian(q, axes_of))

    def with_springs(self, springs: Matrix) -> ImpactModel:
        """Return the model with other joint stiffnesses k_s, length n, numbers or symbols."""
        return replace(self, drives=replace(self.drives, springs=springs))

    def with_drives(self, drives: Drives) -> ImpactModel:
        """Return the model with other drives of the same robot."""
        return replace(self, drives=drives)

    def position_gains(self, q: Matrix) -> Matrix:
        """Return K_p = diag(gains) + k_p M_θθ over the motors, n×n, sparse where it is zero."""
        gains: Any = ca.diag(self.drives.gains)
        gains = self.congruent(q, ca.sparsify(gains) if isinstance(gains, ca.DM) else gains)
        if self.drives.computed_torque_gain is None:
            return gains
        motors = ca.sparsify(ca.DM(np.diag(np.array(self.actuated, dtype=float))))
        block = ca.mtimes([motors, self.rotor_mass_matrix(q), motors])
        return gains + self.drives.computed_torque_gain * block

    def potential_stiffness(self, q: Matrix) -> Matrix:
        """Return the curvature of gravity and of the model's own springs over the links, n×n."""
        if not self.robot.has_springs and not any(self.gravity):
            return ca.DM(len(self.independent), len(self.independent))
        if self.robot.loops:
            return constrained_stiffness(self.robot, q, self.gravity)
        return stiffness_of_potential(self.robot, q, self.gravity)

    def direction_row(self, q: Matrix, direction: Matrix) -> Matrix:
        """Return nᵀJ over the links, 1×n."""
        row = direction_jacobian(self.robot, self.tip, q, direction)
        return ca.mtimes(row, loop_tangent(self.robot, q)) if self.robot.loops else row

    def congruent(self, q: Matrix, matrix: Matrix) -> Matrix:
        """Return a symmetric X over all joints over the coordinates: GᵀXG, or X without loops."""
        if not self.robot.loops:
            return matrix
        G = loop_tangent(self.robot, q)
        product = ca.mtimes([G.T, matrix, G])
        return symmetric(lambda i, j: product[i, j], product.shape[0])


@renamed(drives_="drives")
def impact_model(
    robot: Robot,
    tip: str | None = None,
    *,
    drives: Drives | None = None,
    gravity: Gravity = WEIGHTLESS,
) -> ImpactModel:
    """Return the model of a robot at rest.

    Args:
        robot: any robot.
        tip: contact frame; default the robot's own.
        drives: rotors, springs and gains; default rigid joints with the file's armature.
        gravity: whose curvature enters K0 [m/s²]; zero leaves it out.

    Raises:
        FrameNotFound: the robot has no such tip.
        LoopError: a loop cannot close or is redundant.
        InvalidValue: neither ``tip`` nor the robot names a contact frame, gravity is not three
            finite numbers, or a joint that follows from others through a loop is to be elastic.
        WrongLength: the drives are another robot's.
    """
    name = tip if tip is not None else robot.tip
    if name is None:
        frames = ", ".join(robot.frames)
        raise InvalidValue("tip", f"robot '{robot.name}' has none of its own; choose of: {frames}")
    frame = robot.frame(name)
    x, y, z = three_numbers("gravity", gravity).tolist()
    known = drives or drives_with(robot)
    if len(known.elastic) != robot.n:
        raise WrongLength("drives", len(known.elastic), robot.n, robot.joint_names)
    for i in closed_chain(robot).dependent:
        if known.elastic[i]:
            raise InvalidValue(
                "joint_stiffness",
                f"joint '{robot.joints[i].name}' follows from others through a loop and cannot "
                "be elastic; give it inf, or name it among the independent joints",
            )
    return ImpactModel(robot, frame.name, known, (x, y, z))
