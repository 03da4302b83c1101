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
)
from softimpact.symbolic.matrices import Factorisation, MatrixExpression
from softimpact.symbolic.robot.rigid import Array
from softimpact.toolchain import c_compiler, cache_folder

from ..machine.coordinates import at_coordinates, is_plain, least_motion, rigid
from ..machine.hardware import Hardware
from ..machine.machine import Machine
from ..machine.springs import of_springs, sprung, without_beside, without_sought
from .compiled import compiled_functions
from .impact_forces import FEW_DIRECTIONS, ContactParameters, ImpactDynamics, contact_forces
from .motor_laws import MotorLaws
from .peaks import WINDOWS, peaks_in_windows

SIZES = {"direction": 3, "speed": 1, "contact": 4, "motors": 5, "payload": 1, "step": 1}
"""Numbers of an impact, in order."""

NUMBERS = sum(SIZES.values())

PARTS = ("springs", "rotors", "masses", "cover", "beside", "speed")
"""What of the hardware an impact feels, and a factor on its speed, in the order of x."""

Parts = tuple[str, ...]
"""Those of ``PARTS`` that are sought; springs always are."""

SPRINGS: Parts = ("springs",)

PIECES = 8
"""Lengths of time among which a derivative has the shortest that will do."""


def part_sizes(parts: Parts, model: ImpactModel) -> list[int]:
    """Return how many numbers each part has."""
    sizes = {"springs": len(sprung(model)), "cover": 1, "speed": 1}
    return [sizes.get(part, model.robot.n) for part in parts]


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
    to what the posture gives (masses, Jacobian, springs), and from there on to posture and
    hardware. It costs as much as the forces where these peak early, three times as much at most,
    whatever the number of joints.
    """
    n = model.robot.n
    x, p = ca.MX.sym("x", n + sum(part_sizes(parts, model))), ca.MX.sym("p", NUMBERS)
    boundary, weights = ca.MX.sym("boundary"), ca.MX.sym("weights", nodes)
    posture = _posture(model, point, parts)
    pull_back = _pulled_back(posture)
    given = ca.MX.sym("given", posture.numel_out(0))
    forces = _forces(model, given, p, nodes, substeps, parts)
    forwards = ca.Function("forwards", [given, p], [forces], FEW_DIRECTIONS)
    pull = _pull(model, given, nodes, substeps, parts)
    at = posture(x, p)
    peaks, by_forces = _peaks(nodes)(forwards(at, p), boundary)
    rows = [pull_back(x, p, pull(at, p, by_forces[w, :].T)) for w in range(WINDOWS)]
    pressed = forwards(at, p)
    return (
        ca.Function("forces", [x, p], [pressed]),
        ca.Function("peaks", [x, p, boundary], [peaks_in_windows(pressed, boundary)]),
        ca.Function("slopes", [x, p, boundary], [peaks, ca.vertcat(*rows)]),
        ca.Function("slope", [x, p, weights], [pull_back(x, p, pull(at, p, weights))]),
    )


def _peaks(nodes: int) -> ca.Function:
    """Return (forces, boundary) -> the peak in each window and its derivative by the forces."""
    forces, boundary = ca.MX.sym("forces", nodes), ca.MX.sym("boundary")
    peaks = peaks_in_windows(forces, boundary)
    unit = ca.DM.eye(WINDOWS)
    rows = [ca.jtimes(peaks, forces, unit[:, w], True).T for w in range(WINDOWS)]
    return ca.Function("windows", [forces, boundary], [peaks, ca.vertcat(*rows)])


def _pull(
    model: ImpactModel, given: MatrixExpression, nodes: int, substeps: int, parts: Parts
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


@lru_cache(maxsize=8)
def _posture(model: ImpactModel, point: str, parts: Parts) -> ca.Function:
    """Return (x, p) -> what an impact needs of a posture, in one column."""
    n = model.robot.n
    sizes = part_sizes(parts, model)
    x, p = ca.SX.sym("x", n + sum(sizes)), ca.SX.sym("p", NUMBERS)
    q, *logarithms = ca.vertsplit(x, np.cumsum([0, n, *sizes]).tolist())
    numbers = _split(p)
    machine = Machine.of(model, hardware_of(model, parts, logarithms))
    end, at = machine.jacobian(q), replace(model, tip=point)
    loaded = machine.mass_matrix(q) + numbers["payload"] * ca.mtimes(end.T, end)
    damping = model.congruent(q, ca.sparsify(ca.diag(ca.DM(model.robot.damping))))
    loaded = loaded + numbers["step"] / 2 * damping
    turning = _turning_with_links(machine, q)
    if turning is not None:
        loaded = loaded + turning
    mobility = Factorisation(loaded).solve(ca.SX.eye(len(model.independent)))
    R = list(rigid(model))
    speed = numbers["speed"]
    if "speed" in parts:
        speed = speed * 10 ** logarithms[parts.index("speed")]
    given = [
        ca.vec(mobility),
        at.direction_row(q, numbers["direction"]).T,
        least_motion(model, at.jacobian(q), numbers["direction"]) * speed,
        ca.mtimes(of_springs(model), machine.hardware.springs),
        ca.vec(ca.densify(ca.SX(machine.model.position_gains(q)))),
    ]
    if R:
        inverse = Factorisation(mobility[R, R]).solve(ca.SX.eye(len(R)))
        given.append(ca.vec(ca.mtimes(mobility[:, R], inverse)))
    if "rotors" in parts:
        given.append(machine.hardware.rotors)
    if "cover" in parts:
        given.append(machine.hardware.cover)
    if model.robot.damping.any():
        given.append(ca.vec(ca.densify(ca.SX(damping))))
    if _has_potential(model, parts):
        given.append(ca.vec(_potential(machine, q, parts)))
    return ca.Function("posture", [x, p], ca.cse([ca.vertcat(*given)]))


def _pulled_back(posture: ca.Function) -> ca.Function:
    """Return (x, p, row) -> row times the posture's derivative by x.

    The whole derivative takes four times as many operations with seven joints, eight times with
    fourteen, and minutes to compile.
    """
    x, p = posture.sx_in()
    row = ca.SX.sym("row", 1, posture.numel_out(0))
    found = ca.jtimes(posture(x, p), x, row.T, True).T
    return ca.Function("pull_back", [x, p, row], ca.cse([ca.densify(found)]))


def _turning_with_links(machine: Machine, q: Matrix) -> Matrix | None:
    """Return what rotors add to the links: those without a spring, or of joints that follow."""
    model = machine.model
    if is_plain(model):
        return None
    behind = [float(e) for e in model.drives.elastic]
    return model.congruent(q, ca.diag(machine.hardware.reflected_rotors * (1 - ca.DM(behind))))


def _split(p: Matrix) -> dict[str, Matrix]:
    offsets = np.cumsum([0, *SIZES.values()]).tolist()
    return dict(zip(SIZES, ca.vertsplit(p, offsets), strict=True))


def _forces(
    model: ImpactModel, given: Matrix, p: Matrix, nodes: int, substeps: int, parts: Parts
) -> MatrixExpression:
    n, R, N = len(model.independent), rigid(model), model.robot.n
    d, v = n * bool(model.robot.damping.any()), n * _has_potential(model, parts)
    sizes = [n * n, n, n, n, n * n, n * len(R), N * ("rotors" in parts), int("cover" in parts)]
    offsets = np.cumsum([0, *sizes, d * d, v * v]).tolist()
    pieces: list[Matrix] = ca.vertsplit(given, offsets)
    mobility, jacobian, velocity, springs, gains, carried, rotors, cover, drag, potential = pieces
    pattern = ca.DM(model.position_gains(ca.SX.sym("q", N)).sparsity(), 1)
    damping = model.drives.damping_gains
    if "rotors" not in parts:
        rotors = known_rotors(model)
    behind = ca.DM([float(model.drives.elastic[i]) for i in model.independent])
    dynamics = ImpactDynamics(
        mobility=ca.reshape(mobility, n, n),
        jacobian=jacobian.T,
        springs=springs,
        rotor_mobility=behind / at_coordinates(model, rotors),
        gains=ca.project(ca.reshape(gains, n, n), pattern.sparsity()),
        damping=ca.DM.zeros(n) if damping is None else at_coordinates(model, damping),
        velocity=velocity,
        rigid=R,
        carried=ca.reshape(carried, n if R else 0, len(R)),
        joint_damping=_joint_damping(model, drag) if d else None,
        potential=ca.reshape(potential, v, v) if v else None,
    )
    numbers = _split(p)
    contact = ContactParameters(*ca.vertsplit(numbers["contact"]))
    if "cover" in parts:
        contact = contact._replace(hertz_stiffness=hertz_in_series(contact.hertz_stiffness, cover))
    laws = MotorLaws(*ca.vertsplit(numbers["motors"]))
    return contact_forces(dynamics, contact, laws, numbers["step"], nodes, substeps)


def _joint_damping(model: ImpactModel, entries: Matrix) -> Matrix:
    """Return the joints' damping over the coordinates, diagonal without loops."""
    n = len(model.independent)
    drag = ca.reshape(entries, n, n)
    return drag if model.robot.loops else ca.project(drag, ca.Sparsity.diag(n))


def _has_potential(model: ImpactModel, parts: Parts) -> bool:
    """Whether the links' potential energy bends: by gravity, or springs not behind motors."""
    others = without_sought(model)
    return others.robot.has_springs or any(model.gravity) or "beside" in parts


def _potential(machine: Machine, q: Matrix, parts: Parts) -> Matrix:
    """Return by how much the links' potential energy bends."""
    others = without_sought(machine.model)
    if "beside" not in parts:
        return others.potential_stiffness(q)
    rest = ca.densify(ca.SX(without_beside(others).potential_stiffness(q)))
    return rest + machine.model.congruent(q, ca.diag(machine.beside))


def hertz_in_series(first: Matrix, second: Matrix) -> Matrix:
    """Return the stiffness of two Hertz laws in series: k^(-2/3) adds up."""
    return (first ** (-2 / 3) + second ** (-2 / 3)) ** (-1.5)


def known_rotors(model: ImpactModel) -> ca.DM:
    """Return the rotor inertias; 1 kg m² where none is known, which driven motors do not feel."""
    rotors = np.array(model.drives.rotors, dtype=float)
    return ca.DM(np.where(rotors > 0, rotors, 1.0))
