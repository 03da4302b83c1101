# SPDX-License-Identifier: BSD-3-Clause
"""The force of one impact and its derivatives, as functions of posture, hardware and numbers.

Whatever a study asks, its impacts differ in numbers alone: direction, speed, contact, load and
motors. So one program serves them all, compiled once for a robot, its contact point, and the parts
of the hardware that are sought.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
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
from softimpact.toolchain import c_compiler, cache_folder

from .compiled import compiled_functions
from .hardware import Hardware, Machine
from .impact_forces import FEW_DIRECTIONS, ContactParameters, ImpactDynamics, contact_forces
from .motor_laws import MotorLaws
from .peaks import WINDOWS, peaks_in_windows

SIZES = {"direction": 3, "speed": 1, "contact": 4, "motors": 5, "payload": 1, "step": 1}
"""Numbers of an impact, in order."""

NUMBERS = sum(SIZES.values())

PARTS = ("springs", "rotors", "masses", "cover", "speed")
"""What of the hardware an impact feels, and a factor on its speed, in the order of x."""

Parts = tuple[str, ...]
"""Those of ``PARTS`` that are sought; springs always are."""

SPRINGS: Parts = ("springs",)

PIECES = 8
"""Lengths of time among which a derivative has the shortest that will do."""


def part_sizes(parts: Parts, n: int) -> list[int]:
    """Return how many numbers each part has."""
    return [1 if part in ("cover", "speed") else n for part in parts]


@dataclass(frozen=True)
class ImpactProgram:
    """Functions of x = [q, log10 of the parts sought] and an impact's numbers p.

    A process can load them.

    Attributes:
        functions: names and serialised functions, none where there is a library that all workers
            share, since every job carries them: ``forces`` (x, p) -> all nodes [N]; ``peaks``
            (x, p, boundary) -> one for each window [N]; ``slopes``, the same and its derivative
            by x; ``slope`` (x, p, weights) -> that of a weighted sum of all nodes.
        library: their compiled form, None to run in CasADi's virtual machine.
        n: number of joints.
        nodes: times at which the force is taken.
        parts: of the hardware that are sought.
        compiles: whether a process that has no such library makes its own, if it can.
    """

    functions: tuple[tuple[str, str], ...]
    library: Path | None
    n: int
    nodes: int
    parts: Parts = SPRINGS
    compiles: bool = False

    def __getitem__(self, name: str) -> ca.Function:
        """Return a function by name."""
        return _loaded(name, self.functions, self.library, self.compiles)


@lru_cache(maxsize=64)
def _loaded(
    name: str, functions: tuple[tuple[str, str], ...], library: Path | None, compiles: bool
) -> ca.Function:
    if compiles:
        library = _library_here(functions, library)
    if library is not None:
        return ca.external(name, str(library))
    return ca.Function.deserialize(dict(functions)[name])


@lru_cache(maxsize=8)
def _library_here(functions: tuple[tuple[str, str], ...], library: Path | None) -> Path | None:
    """Return what is in this process's cache, or compile what was sent; None without a compiler."""
    folder = cache_folder()
    if folder is not None and library is not None and (folder / library.name).exists():
        return folder / library.name
    loaded = [ca.Function.deserialize(serialised) for _, serialised in functions]
    return compiled_functions(loaded, c_compiler())


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
    model: ImpactModel,
    nodes: int,
    substeps: int,
    point: str | None = None,
    parts: Parts = SPRINGS,
    *,
    compiled: bool,
    elsewhere: bool = False,
) -> ImpactProgram:
    """Return the program of a robot whose joints are all elastic.

    Args:
        model: robot, its end and its drives; the springs are variables.
        nodes: times at which the force is taken.
        substeps: time steps from node to node.
        point: frame that hits; default the model's tip, which carries the load.
        parts: of the hardware that are sought.
        compiled: whether to compile, if there is a compiler.
        elsewhere: whether the program must run without this machine's library, too.
    """
    functions = impact_functions(model, nodes, substeps, point or model.tip, parts)
    library = compiled_functions(functions, c_compiler()) if compiled else None
    carried: tuple[tuple[str, str], ...] = ()
    if library is None or elsewhere:
        carried = tuple((function.name(), function.serialize()) for function in functions)
    return ImpactProgram(carried, library, model.robot.n, nodes, parts, compiles=elsewhere)


def forces_alone(
    model: ImpactModel, nodes: int, substeps: int, point: str | None = None
) -> ca.Function:
    """Return a program's ``forces`` without derivatives, compiled if there is a compiler.

    Args:
        model: robot, its end and its drives; the springs are variables.
        nodes: times at which the force is taken.
        substeps: time steps from node to node.
        point: frame that hits; default the model's tip.
    """
    posture = _posture(model, point or model.tip, SPRINGS)
    x, p = posture.mx_in()
    forces = _forces(model, posture(x, p), p, nodes, substeps, SPRINGS)
    function = ca.Function("forces", [x, p], [forces])
    library = compiled_functions([function], c_compiler())
    return function if library is None else ca.external("forces", str(library))


def impact_functions(
    model: ImpactModel, nodes: int, substeps: int, point: str, parts: Parts = SPRINGS
) -> tuple[ca.Function, ...]:
    """Return the functions of ``ImpactProgram``.

    A derivative goes backwards through the impact, from the last force that counts to first touch,
    to what the posture gives (masses, Jacobian, springs), and from there forwards to posture and
    hardware. It costs as much as the forces where these peak early, three times as much at most,
    whatever the number of joints.
    """
    n = model.robot.n
    x, p = ca.MX.sym("x", n + sum(part_sizes(parts, n))), ca.MX.sym("p", NUMBERS)
    boundary, weights = ca.MX.sym("boundary"), ca.MX.sym("weights", nodes)
    posture = _posture(model, point, parts)
    slope = _with_slope(posture)
    given = ca.MX.sym("given", posture.numel_out(0))
    forces = _forces(model, given, p, nodes, substeps, parts)
    forwards = ca.Function("forwards", [given, p], [forces], FEW_DIRECTIONS)
    pull = _pull(model, given, nodes, substeps, parts)
    at, along = slope(x, p)
    peaks, by_forces = _peaks(nodes)(forwards(at, p), boundary)
    rows = [pull(at, p, by_forces[w, :].T) for w in range(WINDOWS)]
    pressed = forwards(posture(x, p), p)
    return (
        ca.Function("forces", [x, p], [pressed]),
        ca.Function("peaks", [x, p, boundary], [peaks_in_windows(pressed, boundary)]),
        ca.Function("slopes", [x, p, boundary], [peaks, ca.mtimes(ca.vertcat(*rows), along)]),
        ca.Function("slope", [x, p, weights], [ca.mtimes(pull(at, p, weights), along)]),
    )


def _peaks(nodes: int) -> ca.Function:
    """Return (forces, boundary) -> the peak in each window and its derivative by the forces."""
    forces, boundary = ca.MX.sym("forces", nodes), ca.MX.sym("boundary")
    peaks = peaks_in_windows(forces, boundary)
    unit = ca.DM.eye(WINDOWS)
    rows = [ca.jtimes(peaks, forces, unit[:, w], True).T for w in range(WINDOWS)]
    return ca.Function("windows", [forces, boundary], [peaks, ca.vertcat(*rows)])


def _pull(
    model: ImpactModel, given: Matrix, nodes: int, substeps: int, parts: Parts
) -> ca.Function:
    """Return (given, p, weights) -> derivative by given of a weighted sum of the forces.

    Nothing is computed behind the last force whose weight is not zero, in eighths of the time.
    """
    p, weights = ca.MX.sym("p", NUMBERS), ca.MX.sym("weights", nodes)
    ends = [-(-nodes * k // PIECES) for k in range(PIECES + 1)]
    cases = []
    for end in ends:
        row = ca.MX(1, given.numel())
        if end:
            some = _forces(model, given, p, end, substeps, parts)
            row = ca.jtimes(some, given, weights[:end], True).T
        cases.append(
            ca.Function(f"to_{end}", [given, p, weights], [ca.densify(row)], FEW_DIRECTIONS)
        )
    chosen = ca.Function.conditional("pull_some", cases[:-1], cases[-1])
    last = ca.mmax((weights != 0) * ca.DM(range(1, nodes + 1)))
    case = sum(last > end for end in ends[:-1])
    return ca.Function("pull", [given, p, weights], [chosen(case, given, p, weights)])


def hardware_of(model: ImpactModel, parts: Parts, logarithms: Sequence[Matrix]) -> Hardware:
    """Return the hardware whose parts have these logarithms; speed is none of it."""
    own = Hardware.of(model)
    values = {p: 10**log for p, log in zip(parts, logarithms, strict=True) if p != "speed"}
    return replace(own, **values)


def _posture(model: ImpactModel, point: str, parts: Parts) -> ca.Function:
    """Return (x, p) -> what an impact needs of a posture, in one column."""
    n = model.robot.n
    sizes = part_sizes(parts, n)
    x, p = ca.SX.sym("x", n + sum(sizes)), ca.SX.sym("p", NUMBERS)
    q, *logarithms = ca.vertsplit(x, np.cumsum([0, n, *sizes]).tolist())
    numbers = _split(p)
    machine = Machine.of(model, hardware_of(model, parts, logarithms))
    end = machine.jacobian(q)
    loaded = machine.mass_matrix(q) + numbers["payload"] * ca.mtimes(end.T, end)
    J = contact_point_jacobian(model.robot, point, q)
    speed = numbers["speed"]
    if "speed" in parts:
        speed = speed * 10 ** logarithms[parts.index("speed")]
    given = [
        ca.vec(Factorisation(loaded).solve(ca.SX.eye(n))),
        direction_jacobian(model.robot, point, q, numbers["direction"]).T,
        least_velocity(J, numbers["direction"]) * speed,
        machine.hardware.springs,
        ca.vec(ca.densify(ca.SX(machine.model.position_gains(q)))),
    ]
    if "rotors" in parts:
        given.append(machine.hardware.rotors)
    if "cover" in parts:
        given.append(machine.hardware.cover)
    return ca.Function("posture", [x, p], ca.cse([ca.vertcat(*given)]))


def _with_slope(posture: ca.Function) -> ca.Function:
    """Return the same with its derivative by x."""
    x, p = posture.sx_in()
    column = posture(x, p)
    slope = ca.densify(ca.jacobian(column, x))
    return ca.Function("posture_slope", [x, p], ca.cse([column, slope]))


def _split(p: Matrix) -> dict[str, Matrix]:
    offsets = np.cumsum([0, *SIZES.values()]).tolist()
    return dict(zip(SIZES, ca.vertsplit(p, offsets), strict=True))


def _forces(
    model: ImpactModel, given: Matrix, p: Matrix, nodes: int, substeps: int, parts: Parts
) -> Matrix:
    n = model.robot.n
    sizes = [n * n, n, n, n, n * n, n * ("rotors" in parts), int("cover" in parts)]
    offsets = np.cumsum([0, *sizes]).tolist()
    mobility, jacobian, velocity, springs, gains, rotors, cover = ca.vertsplit(given, offsets)
    pattern = ca.DM(model.position_gains(ca.SX.sym("q", n)).sparsity(), 1)
    damping = model.drives.damping_gains
    dynamics = ImpactDynamics(
        mobility=ca.reshape(mobility, n, n),
        jacobian=jacobian.T,
        springs=springs,
        rotors=rotors if "rotors" in parts else known_rotors(model),
        gains=ca.project(ca.reshape(gains, n, n), pattern.sparsity()),
        damping=ca.DM.zeros(n) if damping is None else damping,
        velocity=velocity,
    )
    numbers = _split(p)
    contact = ContactParameters(*ca.vertsplit(numbers["contact"]))
    if "cover" in parts:
        contact = contact._replace(hertz_stiffness=hertz_in_series(contact.hertz_stiffness, cover))
    laws = MotorLaws(*ca.vertsplit(numbers["motors"]))
    return contact_forces(dynamics, contact, laws, numbers["step"], nodes, substeps)


def hertz_in_series(first: Matrix, second: Matrix) -> Matrix:
    """Return the stiffness of two Hertz laws in series: k^(-2/3) adds up."""
    return (first ** (-2 / 3) + second ** (-2 / 3)) ** (-1.5)


def known_rotors(model: ImpactModel) -> ca.DM:
    """Return the rotor inertias; 1 kg m² where none is known, which driven motors do not feel."""
    rotors = np.array(model.drives.rotors, dtype=float)
    return ca.DM(np.where(rotors > 0, rotors, 1.0))
