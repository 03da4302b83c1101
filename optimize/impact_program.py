# SPDX-License-Identifier: BSD-3-Clause
"""The force of one impact and its derivatives, as functions of posture, springs and numbers.

Whatever a study asks, its impacts differ in numbers alone: direction, speed, contact, load and
motors. So one program serves them all, compiled once for a robot and its contact point.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path

import casadi as ca
import numpy as np

from softimpact.symbolic import (
    Contact,
    ImpactModel,
    Matrix,
    Motors,
    contact_point_jacobian,
    direction_jacobian,
    least_velocity,
)
from softimpact.symbolic.matrices import Factorisation
from softimpact.symbolic.robot.rigid import Array
from softimpact.toolchain import c_compiler

from .compiled import compiled_functions
from .impact_forces import FEW_DIRECTIONS, ContactParameters, ImpactDynamics, contact_forces
from .motor_laws import MotorLaws
from .peaks import peaks_in_windows

SIZES = {"direction": 3, "speed": 1, "contact": 4, "motors": 5, "payload": 1, "step": 1}
"""Numbers of an impact, in order."""

NUMBERS = sum(SIZES.values())


@dataclass(frozen=True)
class ImpactProgram:
    """Functions of x = [q, log10 k_s] and an impact's numbers p, that a process can load.

    Attributes:
        functions: names and serialised functions, none where there is a library, since every job
            carries them: ``forces`` (x, p) -> all nodes [N]; ``peaks`` (x, p,
            boundary) -> one for each window [N]; ``slopes``, the same and its derivative by x.
        library: their compiled form, None to run in CasADi's virtual machine.
        n: number of joints.
        nodes: times at which the force is taken.
    """

    functions: tuple[tuple[str, str], ...]
    library: Path | None
    n: int
    nodes: int

    def __getitem__(self, name: str) -> ca.Function:
        """Return a function by name."""
        return _loaded(name, dict(self.functions).get(name), self.library)


@lru_cache(maxsize=64)
def _loaded(name: str, serialised: str | None, library: Path | None) -> ca.Function:
    if library is not None:
        return ca.external(name, str(library))
    return ca.Function.deserialize(serialised)


def impact_numbers(
    direction: Array,
    speed: float,
    contact: Contact,
    motors: Motors,
    step: float,
    payload: float = 0.0,
) -> Array:
    """Return an impact's numbers in the program's order, length ``NUMBERS``.

    Args:
        direction: unit vector of the contact point's velocity.
        speed: along it [m/s].
        contact: what is hit.
        motors: what they do.
        step: time step of the leapfrog [s].
        payload: point mass at the end of the arm [kg].
    """
    parameters = np.array(ContactParameters.of(contact), dtype=float)
    laws = np.array(MotorLaws.of(motors), dtype=float)
    return np.concatenate([direction, [speed], parameters, laws, [payload, step]])


def impact_program(
    model: ImpactModel, nodes: int, substeps: int, point: str | None = None, *, compiled: bool
) -> ImpactProgram:
    """Return the program of a robot whose joints are all elastic.

    Args:
        model: robot, its end and its drives; the springs are variables.
        nodes: times at which the force is taken.
        substeps: time steps from node to node.
        point: frame that hits; default the model's tip, which carries the load.
        compiled: whether to compile, if there is a compiler.
    """
    functions = impact_functions(model, nodes, substeps, point or model.tip)
    library = compiled_functions(functions, c_compiler()) if compiled else None
    serialised = tuple((function.name(), function.serialize()) for function in functions)
    carried = serialised if library is None else ()
    return ImpactProgram(carried, library, model.robot.n, nodes)


def impact_functions(
    model: ImpactModel, nodes: int, substeps: int, point: str
) -> tuple[ca.Function, ...]:
    """Return the functions of ``ImpactProgram``.

    The derivative goes backwards through the impact, once for each window, to what the posture
    gives (masses, Jacobian, springs), and from there forwards to the posture: three to four times
    the price of the forces, whatever the number of joints.
    """
    x, p = ca.MX.sym("x", 2 * model.robot.n), ca.MX.sym("p", NUMBERS)
    boundary = ca.MX.sym("boundary")
    posture, slope = _posture(model, point)
    given = ca.MX.sym("given", posture.numel_out(0))
    forces = _forces(model, given, p, nodes, substeps)
    peaks = peaks_in_windows(forces, boundary)
    arguments = [given, p, boundary]
    backwards = ca.Function(
        "backwards", arguments, [peaks, ca.jacobian(peaks, given)], FEW_DIRECTIONS
    )
    forwards = ca.Function("forwards", [given, p], [forces], FEW_DIRECTIONS)
    at, along = slope(x, p)
    found, by_given = backwards(at, p, boundary)
    pressed = forwards(posture(x, p), p)
    return (
        ca.Function("forces", [x, p], [pressed]),
        ca.Function("peaks", [x, p, boundary], [peaks_in_windows(pressed, boundary)]),
        ca.Function("slopes", [x, p, boundary], [found, ca.mtimes(by_given, along)]),
    )


def _posture(model: ImpactModel, point: str) -> tuple[ca.Function, ca.Function]:
    """Return what an impact needs of a posture, in one column, and its derivative by x."""
    n = model.robot.n
    x, p = ca.SX.sym("x", 2 * n), ca.SX.sym("p", NUMBERS)
    q, s = ca.vertsplit(x, n)
    numbers = _split(p)
    mass = model.mass_matrix(q)
    end = contact_point_jacobian(model.robot, model.tip, q)
    loaded = mass + numbers["payload"] * ca.mtimes(end.T, end)
    J = contact_point_jacobian(model.robot, point, q)
    given = ca.vertcat(
        ca.vec(Factorisation(loaded).solve(ca.SX.eye(n))),
        direction_jacobian(model.robot, point, q, numbers["direction"]).T,
        least_velocity(J, numbers["direction"]) * numbers["speed"],
        10**s,
        ca.vec(ca.densify(ca.SX(model.position_gains(q)))),
    )
    value = ca.Function("posture", [x, p], ca.cse([given]))
    both = ca.Function("slope", [x, p], ca.cse([given, ca.densify(ca.jacobian(given, x))]))
    return value, both


def _split(p: Matrix) -> dict[str, Matrix]:
    offsets = np.cumsum([0, *SIZES.values()]).tolist()
    return dict(zip(SIZES, ca.vertsplit(p, offsets), strict=True))


def _forces(model: ImpactModel, given: Matrix, p: Matrix, nodes: int, substeps: int) -> Matrix:
    n = model.robot.n
    parts = ca.vertsplit(given, np.cumsum([0, n * n, n, n, n, n * n]).tolist())
    mobility, jacobian, velocity, springs, gains = parts
    pattern = ca.DM(model.position_gains(ca.SX.sym("q", n)).sparsity(), 1)
    damping = model.drives.damping_gains
    dynamics = ImpactDynamics(
        mobility=ca.reshape(mobility, n, n),
        jacobian=jacobian.T,
        springs=springs,
        rotors=known_rotors(model),
        gains=ca.project(ca.reshape(gains, n, n), pattern.sparsity()),
        damping=ca.DM.zeros(n) if damping is None else damping,
        velocity=velocity,
    )
    numbers = _split(p)
    contact = ContactParameters(*ca.vertsplit(numbers["contact"]))
    laws = MotorLaws(*ca.vertsplit(numbers["motors"]))
    return contact_forces(dynamics, contact, laws, numbers["step"], nodes, substeps)


def known_rotors(model: ImpactModel) -> ca.DM:
    """Return the rotor inertias; 1 kg m² where none is known, which driven motors do not feel."""
    rotors = np.array(model.drives.rotors, dtype=float)
    return ca.DM(np.where(rotors > 0, rotors, 1.0))
