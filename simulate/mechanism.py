# SPDX-License-Identifier: BSD-3-Clause
"""A robot as the integrator sees it, and the body it presses on."""

from __future__ import annotations

from dataclasses import dataclass, field

import casadi as ca

from softimpact.symbolic.body.contact import Contact, hertz_force
from softimpact.symbolic.matrices import Matrix


@dataclass(frozen=True, eq=False)
class Mechanism:
    """Equations of motion of a robot that is pushed at its contact point (SX).

    Attributes:
        position: coordinates, symbols of length k, zero at first touch.
        velocity: their rates, symbols of length k.
        force: contact force f_c [N], a symbol.
        parameters: numbers that vary from one impact to the next, symbols.
        acceleration: of the coordinates, over all the symbols above.
        displacement: x_c [m], how far the contact point has moved along n, over ``position`` and
            ``memory``.
        memory: what a controller keeps, symbols of the size of positions, zero at first touch.
        memory_rate: its rate, over all the symbols above.
    """

    position: Matrix
    velocity: Matrix
    force: Matrix
    parameters: Matrix
    acceleration: Matrix
    displacement: Matrix
    memory: Matrix = field(default_factory=lambda: ca.SX(0, 1))
    memory_rate: Matrix = field(default_factory=lambda: ca.SX(0, 1))

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return int(self.position.numel())

    @property
    def speed(self) -> Matrix:
        """ẋ_c [m/s]."""
        moving = ca.vertcat(self.position, self.memory)
        return ca.jtimes(self.displacement, moving, ca.vertcat(self.velocity, self.memory_rate))


@dataclass(frozen=True)
class BodyKind:
    """What decides the equations of the body's side.

    Attributes:
        clamped: whether the region is held; else it moves with its effective mass.
        damped: whether its spring has a damper; without one x_0 follows from statics.
    """

    clamped: bool
    damped: bool

    @staticmethod
    def of(contact: Contact) -> BodyKind:
        """Return the kind of a contact's body."""
        return BodyKind(contact.clamped, contact.region.damping > 0)


@dataclass(frozen=True, eq=False)
class Body:
    """A body region and the skin in front of it, as symbols (MSM §3.1).

    Attributes:
        hertz_stiffness: k_f of the skin [N/m^1.5].
        stiffness: k_h [N/m].
        damping: c_h [N·s/m].
        mass: m_h [kg].
        node: x_0 [m], between skin and spring.
        moved: x_h [m] and ẋ_h [m/s] of the region; nothing when it is clamped.
    """

    hertz_stiffness: Matrix
    stiffness: Matrix
    damping: Matrix
    mass: Matrix
    node: Matrix
    moved: Matrix

    @staticmethod
    def symbols(kind: BodyKind) -> Body:
        """Return a body of fresh symbols."""
        k_f, k_h, c_h, m_h, x_0 = (ca.SX.sym(name) for name in ("k_f", "k_h", "c_h", "m_h", "x_0"))
        return Body(k_f, k_h, c_h, m_h, x_0, ca.SX.sym("h", 0 if kind.clamped else 2))

    @property
    def parameters(self) -> Matrix:
        """The constants in the order of ``body_parameters``."""
        return ca.vertcat(self.hertz_stiffness, self.stiffness, self.damping, self.mass)

    @property
    def position(self) -> Matrix:
        """x_h [m]."""
        return self.moved[0] if self.moved.numel() else 0

    @property
    def velocity(self) -> Matrix:
        """ẋ_h [m/s]."""
        return self.moved[1] if self.moved.numel() else 0


def body_parameters(contact: Contact) -> list[float]:
    """Return k_f, k_h, c_h and m_h of a contact."""
    region = contact.region
    return [contact.hertz_stiffness, region.stiffness, region.damping, region.effective_mass]


@dataclass(frozen=True, eq=False)
class Press:
    """How the contact point presses on a body (SX).

    Attributes:
        depth: δ = x_c − x_0 [m].
        closing: dδ/dt [m/s].
        force: f_c [N].
        imbalance: f_c − k_h(x_0 − x_h) [N], which the damper carries.
    """

    depth: Matrix
    closing: Matrix
    force: Matrix
    imbalance: Matrix


def press(robot: Mechanism, body: Body, kind: BodyKind) -> Press:
    """Return how a robot presses on a body (MSM §3.1)."""
    depth = robot.displacement - body.node
    force = hertz_force(body.hertz_stiffness, depth)
    imbalance = force - body.stiffness * (body.node - body.position)
    approach = robot.speed - body.velocity
    if kind.damped:  # c_h(ẋ_0 − ẋ_h) = f_c − k_h(x_0 − x_h)
        closing = approach - imbalance / body.damping
    else:  # f_c = k_h(x_0 − x_h), hence f_c' δ̇ = k_h(ẋ_c − δ̇ − ẋ_h)
        tangent = -ca.jacobian(force, body.node)
        closing = body.stiffness * approach / (body.stiffness + tangent)
    return Press(depth, closing, force, imbalance)
