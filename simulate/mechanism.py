# SPDX-License-Identifier: BSD-3-Clause
"""A robot as the integrator sees it, and the body it presses on."""

from __future__ import annotations

from dataclasses import dataclass, field

import casadi as ca

from softimpact.symbolic import Contact, Law
from softimpact.symbolic.body.laws.law import form_of, numbers_of, with_numbers
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
        damped: whether its spring has a damper; without one x_0 follows from statics, unless a
            plate is there.
        plate: whether there is a mass between skin and spring.
        law: form of the law of contact.
    """

    clamped: bool
    damped: bool
    plate: bool
    law: Law

    @staticmethod
    def of(contact: Contact) -> BodyKind:
        """Return the kind of a contact's body."""
        region = contact.region
        plate = region.plate_mass > 0
        return BodyKind(contact.clamped, plate or region.damping > 0, plate, form_of(contact.law))


@dataclass(frozen=True, eq=False)
class BodySymbols:
    """A body region and the law of contact in front of it, as symbols (MSM §3.1).

    Attributes:
        law: of contact, with symbols for its parameters.
        stiffness: k_h [N/m].
        damping: c_h [N·s/m].
        mass: m_h [kg].
        plate_mass: at x_0 [kg].
        node: x_0 [m], between law and spring.
        moved: x_h [m] and ẋ_h [m/s] of the region; nothing when it is clamped.
        plate_velocity: ẋ_0 [m/s]; nothing without a plate.
        law_parameters: symbols in the law.
    """

    law: Law
    stiffness: Matrix
    damping: Matrix
    mass: Matrix
    plate_mass: Matrix
    node: Matrix
    moved: Matrix
    plate_velocity: Matrix
    law_parameters: Matrix

    @staticmethod
    def symbols(kind: BodyKind) -> BodySymbols:
        """Return a body of fresh symbols."""
        k_h, c_h, m_h, m_p, x_0 = (ca.SX.sym(name) for name in ("k_h", "c_h", "m_h", "m_p", "x_0"))
        numbers = ca.SX.sym("law", len(kind.law.parameters))
        return BodySymbols(
            with_numbers(kind.law, ca.vertsplit(numbers)),
            k_h,
            c_h,
            m_h,
            m_p,
            x_0,
            ca.SX.sym("h", 0 if kind.clamped else 2),
            ca.SX.sym("dx_0", 1 if kind.plate else 0),
            numbers,
        )

    @property
    def parameters(self) -> Matrix:
        """The constants in the order of ``body_parameters``."""
        numbers = (self.stiffness, self.damping, self.mass, self.plate_mass)
        return ca.vertcat(*numbers, self.law_parameters)

    @property
    def state(self) -> Matrix:
        """What the body adds to the state, x_0 last."""
        return ca.vertcat(self.moved, self.plate_velocity, self.node)

    @property
    def position(self) -> Matrix:
        """x_h [m]."""
        return self.moved[0] if self.moved.numel() else 0

    @property
    def velocity(self) -> Matrix:
        """ẋ_h [m/s]."""
        return self.moved[1] if self.moved.numel() else 0


def body_units(kind: BodyKind, time: float) -> list[float]:
    """Return units of the body's state per 1 m/s: ``time`` [s] for positions, 1 for velocities."""
    return [*([] if kind.clamped else [time, 1.0]), *([1.0] if kind.plate else []), time]


def body_parameters(contact: Contact) -> list[float]:
    """Return k_h, c_h, m_h, the plate's mass and the law's parameters of a contact."""
    region = contact.region
    spring = [region.stiffness, region.damping, region.effective_mass, region.plate_mass]
    return spring + numbers_of(contact.law)


@dataclass(frozen=True, eq=False)
class Press:
    """How the contact point presses on a body (SX).

    Attributes:
        depth: δ = x_c − x_0 [m].
        closing: dδ/dt [m/s].
        force: f_c [N].
        reading: of spring and damper [N], which is what a measuring device shows; f_c but for the
            inertia of a plate.
        imbalance: f_c − k_h(x_0 − x_h) [N], which damper and plate carry.
        rate: of the body's state.
    """

    depth: Matrix
    closing: Matrix
    force: Matrix
    reading: Matrix
    imbalance: Matrix
    rate: Matrix


def press(robot: Mechanism, body: BodySymbols, kind: BodyKind) -> Press:
    """Return how a robot presses on a body: a law, a plate if any, spring and damper, a mass."""
    depth = robot.displacement - body.node
    force = body.law.force(depth)
    squeezed = body.stiffness * (body.node - body.position)
    imbalance = force - squeezed
    approach = robot.speed - body.velocity
    reading, rate = force, []
    if kind.plate:  # m_p ẍ_0 = f_c − k_h(x_0 − x_h) − c_h(ẋ_0 − ẋ_h)
        closing = robot.speed - body.plate_velocity
        reading = squeezed + body.damping * (body.plate_velocity - body.velocity)
        rate = [(force - reading) / body.plate_mass]
    elif kind.damped:  # c_h(ẋ_0 − ẋ_h) = f_c − k_h(x_0 − x_h)
        closing = approach - imbalance / body.damping
    else:  # f_c = k_h(x_0 − x_h), hence f_c' δ̇ = k_h(ẋ_c − δ̇ − ẋ_h)
        tangent = -ca.jacobian(force, body.node)
        closing = body.stiffness * approach / (body.stiffness + tangent)
    if not kind.clamped:
        rate = [body.velocity, reading / body.mass, *rate]
    return Press(
        depth, closing, force, reading, imbalance, ca.vertcat(*rate, robot.speed - closing)
    )
