# SPDX-License-Identifier: BSD-3-Clause
"""What a package computes: its C functions as expressions over one set of symbols."""

from __future__ import annotations

from dataclasses import replace

import casadi as ca
import numpy as np

from softimpact.symbolic import (
    Drives,
    ImpactModel,
    Matrix,
    Robot,
    closed_chain,
    directional_giaf,
    extreme_directional_giaf,
    giaf,
    giif,
    loop_gaps,
)
from softimpact.symbolic.rigid import Array

from .approach import approach_rates, directions_of_motion, share_outside
from .description import CFunction, Guard, Output, Parameter

IMMOVABLE = 1e3
"""A contact point counts as unable to move where it feels this many times the robot's mass."""

LOOP_OPEN = 1e-3
"""Gap of a loop, over the size of the robot, from which on a configuration is refused."""
OUTSIDE = 1e-6
"""Squared share of n that may point where the contact point never moves."""

FASTEST = 100.0
"""Joint velocity for 1 m/s, times the largest entry of J, from which on an approach is singular."""

CHAIN_ENDS = 1e-10
"""Square of the share of a mass's pull that must reach further masses for a chain to go on."""


def parameters_of(robot: Robot) -> tuple[Parameter, ...]:
    """Return the fields of a robot's parameter struct."""
    rotors = "rotor inertia, reflected to the joint"
    gains = "proportional gain of the motor's controller"
    if not is_elastic(robot):
        return (
            Parameter("rotor_inertia", "kg m^2", f"{rotors}; may be 0", positive=False),
            Parameter("position_gain", "N m/rad", f"{gains}", positive=False),
        )
    return (
        Parameter("joint_stiffness", "N m/rad", "stiffness of the joint's spring", positive=True),
        Parameter("rotor_inertia", "kg m^2", rotors, positive=True),
        Parameter("position_gain", "N m/rad", f"{gains}", positive=False),
    )


def is_elastic(robot: Robot) -> bool:
    """Whether every joint gets a spring behind its motor.

    A robot with passive joints, loops or springs of its own describes its compliance itself.
    """
    plain = not robot.loops and not any(joint.stiffness for joint in robot.joints)
    return plain and all(robot.actuated)


def coordinates_of(robot: Robot) -> int:
    """Number of generalised coordinates."""
    return len(closed_chain(robot).independent) * (2 if is_elastic(robot) else 1)


def functions_of(
    robot: Robot, tip: str, gravity: tuple[float, float, float], chain_order: int
) -> tuple[CFunction, ...]:
    """Return all functions of a robot's package.

    Those of the operational space inertia are left out where the contact point cannot move in all
    three directions at any configuration, and two masses where there is one coordinate.
    """
    builder = _Builder(robot, tip, gravity)
    functions = [
        builder.mass_matrix(),
        builder.jacobian(),
        builder.generalised_mass_matrix(),
        builder.stiffness_matrix(),
        builder.contact_jacobian(),
        builder.reflected_mass(),
    ]
    if coordinates_of(robot) > 1:
        functions.append(builder.reduced_model())
    functions.append(builder.chain(chain_order))
    if builder.moves_in_space():
        functions += [
            builder.osim(),
            builder.giaf(),
            builder.directional_giaf(),
            builder.absorption_extremes(),
        ]
    return tuple(functions)


def model_of(robot: Robot, tip: str, gravity: tuple[float, float, float]) -> ImpactModel:
    """Return the model that a package's functions are made of, over symbols."""
    return _Builder(robot, tip, gravity).model


def impact_chain_of(
    robot: Robot, tip: str, gravity: tuple[float, float, float], order: int
) -> CFunction | None:
    """Return what a package's impacts start from: masses, springs and velocities of a chain.

    None if motors cannot move the contact point along n alone, or only in directions that depend
    on the configuration.
    """
    return _Builder(robot, tip, gravity).impact_chain(order)


def linear_model_of(
    robot: Robot, tip: str, gravity: tuple[float, float, float]
) -> CFunction | None:
    """Return the whole linear robot, by which chains are judged; None as ``impact_chain_of``."""
    return _Builder(robot, tip, gravity).linear_model()


class _Builder:
    """Holds the symbols that all functions share."""

    def __init__(self, robot: Robot, tip: str, gravity: tuple[float, float, float]) -> None:
        n = robot.n
        self.q, self.n = ca.SX.sym("q", n), ca.SX.sym("n", 3)
        self.values = {p.name: ca.SX.sym(p.name, n) for p in parameters_of(robot)}
        elastic = (is_elastic(robot),) * n
        gains = self.values["position_gain"] * ca.sparsify(
            ca.DM([float(a) for a in robot.actuated])
        )
        springs = self.values.get("joint_stiffness", ca.SX(n, 1))
        drives = Drives(self.values["rotor_inertia"], springs, elastic, gains)
        self.model = ImpactModel(robot, tip, drives, gravity)
        moved = sum(joint.inertia.mass for joint in robot.joints)
        self.heaviest = float(f"{IMMOVABLE * moved:.2g}")

    def moves_in_space(self) -> bool:
        """Whether the contact point can move in all directions somewhere."""
        q = np.random.default_rng(1).uniform(-1, 1, self.model.robot.n)
        return bool(np.linalg.matrix_rank(np.array(self.model.jacobian(ca.DM(q))), 1e-6) == 3)

    def _function(
        self, name: str, summary: str, outputs: tuple[Output, ...], guards: tuple[Guard, ...] = ()
    ) -> CFunction:
        symbols = (self.q, self.n, *self.values.values())
        read = {symbol.name() for output in outputs for symbol in ca.symvar(output.value)}

        def reads(vector: Matrix) -> bool:
            return any(vector[i].name() in read for i in range(vector.numel()))

        parameters = tuple(key for key, symbol in self.values.items() if reads(symbol))
        guards = (*self._closed(), *guards)
        return CFunction(name, summary, outputs, symbols, reads(self.n), parameters, guards)

    def _closed(self) -> tuple[Guard, ...]:
        robot = self.model.robot
        if not robot.loops:
            return ()
        gap = loop_gaps(robot, self.q)
        lengths = [float(np.linalg.norm(joint.placement.translation)) for joint in robot.joints]
        widest = float(f"{(LOOP_OPEN * sum(lengths)) ** 2:.2g}")
        return (Guard(widest - ca.dot(gap, gap), 0.0, status="LOOP_OPEN"),)

    def _movable(self, mass: Matrix) -> Guard:
        return Guard(mass, 0.0, self.heaviest)

    def mass_matrix(self) -> CFunction:
        M = Output("M", self.model.mass_matrix(self.q), "kg m^2", "links only", symmetric=True)
        return self._function("mass_matrix", "Mass matrix M(q) of the links, without rotors.", (M,))

    def jacobian(self) -> CFunction:
        J = Output("J", self.model.jacobian(self.q), "m/rad", "base axes")
        summary = "Translational Jacobian J(q) of the contact point: velocity = J dq/dt."
        return self._function("jacobian", summary, (J,))

    def generalised_mass_matrix(self) -> CFunction:
        M0 = self.model.generalised_mass(self.q).matrix
        output = Output("M0", ca.densify(M0), "kg m^2", "", symmetric=True)
        summary = "Mass matrix M0 over the generalised coordinates (MSM Eq. 42)."
        return self._function("generalised_mass_matrix", summary, (output,))

    def stiffness_matrix(self) -> CFunction:
        K0 = ca.densify(self.model.generalised_stiffness(self.q))
        output = Output("K0", K0, "N m/rad", "", symmetric=True)
        summary = "Stiffness matrix K0 over the generalised coordinates (MSM Eq. 45)."
        return self._function("stiffness_matrix", summary, (output,))

    def contact_jacobian(self) -> CFunction:
        row = ca.densify(self.model.contact_jacobian(self.q, self.n))
        summary = "Row J_c = n'J over the generalised coordinates (MSM Eq. 4)."
        return self._function("contact_jacobian", summary, (Output("J_c", row, "m/rad", ""),))

    def reflected_mass(self) -> CFunction:
        m_c = self.model.reflected_mass(self.q, self.n)
        output = Output("m_c", m_c, "kg", "mass felt at the contact point")
        summary = "Mass m_c that the contact point feels along n (MSM Eq. 36)."
        return self._function("reflected_mass", summary, (output,), (self._movable(m_c),))

    def reduced_model(self) -> CFunction:
        reduced = self.model.reduced(self.q, self.n)
        outputs = (
            Output("m_c", reduced.m_c, "kg", "mass felt at the contact point"),
            Output("k_r", reduced.k_r, "N/m", "reflected stiffness"),
            Output("m_a", reduced.m_a, "kg", "mass on the actuators' side"),
        )
        summary = "Two masses and a spring that stand for the robot along n (MSM Eq. 36-38)."
        guards = (self._movable(reduced.m_c),)
        return self._function("reduced_model", summary, outputs, guards)

    def chain(self, order: int) -> CFunction:
        chain = self.model.chain(self.q, self.n, order)
        mass, k = list(chain.mass), list(chain.stiffness)
        guards = [self._movable(mass[0])]
        for i in range(1, order):  # how much of the pull of mass i goes on to the next
            own = (k[i - 1] + k[i - 2] if i > 1 else k[i - 1]) ** 2 / mass[i - 1]
            guards.append(Guard(k[i - 1] ** 2 / (mass[i] * own), CHAIN_ENDS))
        outputs = (
            Output("mass", ca.vertcat(*mass), "kg", "the contact force acts on the first"),
            Output("stiffness", ca.vertcat(*k), "N/m", "[i] joins mass i and i+1; last to ground"),
        )
        summary = f"Chain of {order} masses that stands for the robot along n."
        return self._function("chain", summary, outputs, tuple(guards))

    def impact_chain(self, order: int) -> CFunction | None:
        directions = directions_of_motion(self.model)
        if directions is None:
            return None
        chain = self.model.chain(self.q, self.n, order, reorthogonalise="once")
        mass: Matrix = ca.vertcat(*chain.mass)
        rates = approach_rates(self.model, self.q, self.n, directions)
        motors = chain.displacement[list(range(self.model.robot.n)), :]
        velocity = ca.mtimes(motors.T, rates)
        outputs = (
            Output("mass", mass, "kg", "the contact force acts on the first"),
            Output("stiffness", ca.vertcat(*chain.stiffness), "N/m", "to the next, last to ground"),
            Output("velocity", velocity, "m/s", "at first touch, for an approach of 1 m/s"),
        )
        guards = self._arriving(mass[0], rates, directions)
        summary = f"Chain of {order} masses as it arrives at an impact; it may end before its last."
        built = self._function("impact_chain", summary, outputs, guards)
        return replace(built, open_ended=True)

    def linear_model(self) -> CFunction | None:
        """Return M0, K0, J_c and the velocities of all coordinates, of which chains are made."""
        directions = directions_of_motion(self.model)
        if directions is None:
            return None
        linear = self.model.linear(self.q, self.n)
        rates = approach_rates(self.model, self.q, self.n, directions)
        velocity = ca.vertcat(rates, ca.SX(self.model.size - self.model.robot.n, 1))
        outputs = (
            Output("M0", ca.densify(linear.mass.matrix), "kg m^2", ""),
            Output("K0", ca.densify(linear.stiffness), "N m/rad", ""),
            Output("J_c", ca.densify(linear.jacobian), "m/rad", ""),
            Output("velocity", ca.densify(velocity), "rad/s", ""),
        )
        m_c = self.model.reflected_mass(self.q, self.n)
        guards = self._arriving(m_c, rates, directions)
        return self._function("linear_model", "Linear model.", outputs, guards)

    def _arriving(self, m_c: Matrix, rates: Matrix, directions: Array) -> tuple[Guard, ...]:
        """Guards of an approach: along n alone, and without wild joint velocities."""
        guards = [self._movable(m_c), Guard(ca.sumsqr(rates), 0.0, self._too_fast())]
        if len(directions) < 3:
            guards.append(Guard(1 - share_outside(self.n, directions), 1 - OUTSIDE))
        return tuple(guards)

    def _too_fast(self) -> float:
        q = np.random.default_rng(3).uniform(-1, 1, (8, self.model.robot.n))
        arm = max(float(abs(np.array(self.model.jacobian(ca.DM(x)))).max()) for x in q)
        return float(f"{(FASTEST / arm) ** 2:.2g}")

    def osim(self) -> CFunction:
        real, free = self.model.mobility(self.q), self.model.free_mobility(self.q)
        outputs = (
            Output("Lambda", real.inertia, "kg", "with rotors (GIAF Eq. 13)", symmetric=True),
            Output("Lambda_F", free.inertia, "kg", "without (GIAF Eq. 24)", symmetric=True),
        )
        guards = (self._in_space(real.inertia), self._in_space(free.inertia))
        summary = "Operational space inertias of the contact point, in the base's axes."
        return self._function("osim", summary, outputs, guards)

    def _in_space(self, inertia: Matrix) -> Guard:
        return self._movable(ca.trace(inertia))

    def giaf(self) -> CFunction:
        """Return GIAF and GIIF in the axes in which they take the fewest operations."""
        path = self.model.robot.ancestors(self.model.robot.frame(self.model.tip).joint)
        candidates = [self._giaf_in(axes) for axes in (-1, *reversed(path))]
        return min(candidates, key=lambda function: function.flops)

    def _giaf_in(self, axes: int) -> CFunction:
        real, free = self.model.mobility(self.q, axes), self.model.free_mobility(self.q, axes)
        outputs = (
            Output(
                "giaf",
                giaf(free, real),
                "dimensionless",
                "absorption factor (GIAF Eq. 28)",
                share=True,
            ),
            Output(
                "giif",
                giif(free, real),
                "dimensionless",
                "increment factor (GIAF Eq. 27)",
                share=True,
            ),
        )
        guards = (self._in_space(real.inertia), self._in_space(free.inertia))
        return self._function("giaf", "Generalised impact factors.", outputs, guards)

    def directional_giaf(self) -> CFunction:
        real, free = self.model.mobility(self.q), self.model.free_mobility(self.q)
        value = directional_giaf(free, real, self.n)
        guards = (self._in_space(real.inertia), self._in_space(free.inertia))
        output = Output("giaf", value, "dimensionless", "1 if rotors do not count", share=True)
        summary = "Share of the inertia along n that is not the rotors' (GIAF Eq. 29)."
        return self._function("directional_giaf", summary, (output,), guards)

    def absorption_extremes(self) -> CFunction:
        real, free = self.model.mobility(self.q), self.model.free_mobility(self.q)
        found = extreme_directional_giaf(free, real)
        outputs = (
            Output("least", found.least, "dimensionless", "smallest value", share=True),
            Output("greatest", found.greatest, "dimensionless", "largest value", share=True),
            Output(
                "least_direction",
                found.least_direction,
                "dimensionless",
                "unit vector; where two values meet, one of many",
            ),
            Output(
                "greatest_direction", found.greatest_direction, "dimensionless", "the same for it"
            ),
        )
        guards = (self._in_space(real.inertia), self._in_space(free.inertia))
        summary = "Directions of least and greatest absorption, base axes (GIAF Eq. 29)."
        extremes = self._function("absorption_extremes", summary, outputs, guards)
        return replace(extremes, divides=True)  # directions magnify rounding
