# SPDX-License-Identifier: BSD-3-Clause
"""Portable C99 packages of a robot's impact model."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence
from pathlib import Path

import numpy as np

import softimpact
from softimpact.symbolic import STANDARD_GRAVITY, Contact, Drives, InvalidValue, Robot
from softimpact.symbolic.former_names import renamed
from softimpact.symbolic.impact.impact_model import WEIGHTLESS

from ..functions import coordinates_of, functions_of, symbols_of
from ..functions.description import CFunction
from ..inputs.defaults import Payload, defaults_of, frozen_parameters
from ..inputs.parameters import parameters_of
from ..inputs.poses import checked_poses
from ..inputs.regions import built_in
from ..inputs.samples import Sample, as_columns, draw_samples
from ..record.costs import Costs
from ..record.manifest import MANIFEST, FunctionRecord, Manifest, Real
from ..sources.configuration import configuration_source
from ..sources.function import CSource
from ..sources.impact import GOLDEN_IMPACTS, NOT_MEASURED, impact_source
from ..verification.accuracy import Inputs, accuracy, golden_results, is_regular
from ..verification.configuration import Configuration, has_configuration
from ..verification.replay import replay
from .files import replace_package, require_place, sha256
from .names import c_name
from .render import MEASURED_SAMPLES, Package, render
from .shared import with_stages

LONGEST_CHAIN = 8
"""Most masses of a generated chain; longer ones lose their last masses to rounding."""

OnStep = Callable[[str, int, int], None]
"""Called with what comes next, the number of steps done, and that of all."""

TIP = "tip"
"""Name of the package's own contact point among those of ``speed_factor``."""

GOLDEN_CASES = 12
"""Inputs in a package's own test."""

CHAIN_ORDER = 3
"""Masses of the chain unless another number is asked for, or the robot has fewer coordinates."""


def unseen(what: str, done: int, of: int) -> None:
    """Let steps pass without a word."""


@renamed(drives_="drives")
def generate_package(
    robot: Robot,
    out: str | Path,
    *,
    tip: str | None = None,
    real: Real = "double",
    name: str | None = None,
    drives: Drives | None = None,
    gravity: tuple[float, float, float] | None = None,
    chain_order: int | None = None,
    payload: Payload | None = None,
    freeze: Collection[str] = (),
    floating: bool = False,
    poses: Mapping[str, Sequence[float]] | None = None,
    points: Mapping[str, str] | None = None,
    contacts: Mapping[str, Contact] | None = None,
    compiler: Sequence[str] | None = None,
    on_step: OnStep = unseen,
) -> Manifest:
    """Write a C99 package that computes a robot's impact model.

    Args:
        robot: any robot, see ``load_robot``.
        out: folder of the package; replaced as a whole if it holds an older package.
        tip: frame whose origin is the contact point; default the robot's own.
        real: number type that the package uses unless its build says otherwise.
        name: prefix of all C names; default the robot's name.
        drives: numbers for the default parameters; without them the rotor inertias are the
            file's armatures, gains are 0, and joint stiffnesses are left for the caller to set.
        gravity: whose curvature enters K0 [m/s²]; zero leaves it out. Default none, but of closed
            chains, whose passive joints rest where springs and gravity balance, the standard one.
        chain_order: number of masses of the chain; None takes ``CHAIN_ORDER``, or as many as there
            are coordinates.
        payload: adds the parameters of a point mass that the robot carries; its numbers are their
            defaults. Not for closed chains.
        freeze: names of parameters whose defaults are built in instead of read at run time, or
            ``{"all"}``.
        floating: adds the impact mitigation of the robot with its base set free.
        poses: joint coordinates by name that ``select_configuration`` can choose from; default
            none. They must lie within the joints' limits. Not for robots without impacts.
        points: further contact points that ``speed_factor`` watches beside the tip: frames, or
            ``FRAME@x,y,z``, by a name that C can have.
        contacts: bodies and covers that are built in beside the standard's regions, by a name that
            C can have. Not for robots without impacts.
        compiler: words of a C compiler's command line, with which the package's own test is run
            before anything is written; None leaves it out.
        on_step: is told what comes next, and how many steps of how many are done.

    Returns:
        What was generated, as in the package's ``manifest.json``.

    Raises:
        FrameNotFound: the robot has no such tip.
        MasslessBase: the base that is to be set free has no mass.
        InvalidValue: an argument outside its meaning, a tip that cannot move, or a parameter to
            be frozen whose numbers are not known.
        UnknownName: a parameter to be frozen that the package does not have.
        NoEquilibrium: a closed chain that rests nowhere near home.
        ForeignFolder: it holds files that the generator did not write.
        FolderNotWritable: the operating system refuses.
        FailedOwnTest: the package misses its own golden results.
    """
    folder = Path(out)
    require_place(folder)
    package = package_of(
        robot,
        tip=tip,
        real=real,
        name=name,
        drives=drives,
        gravity=gravity,
        chain_order=chain_order,
        payload=payload,
        freeze=freeze,
        floating=floating,
        poses=poses,
        points=points,
        contacts=contacts,
        on_step=on_step,
    )
    files, costs = render(package)
    if compiler is not None:
        on_step("own test", len(package.functions), len(package.functions) + 1)
        replay(files, compiler)
    manifest = _manifest(package, costs, {path: sha256(text) for path, text in files.items()})
    replace_package(folder, {**files, MANIFEST: manifest.to_json()})
    return manifest


def longest_chain(robot: Robot) -> int:
    """Return the most masses that a generated chain of a robot may have."""
    return min(LONGEST_CHAIN, coordinates_of(robot))


def package_of(
    robot: Robot,
    *,
    tip: str | None = None,
    real: Real = "double",
    name: str | None = None,
    drives: Drives | None = None,
    gravity: tuple[float, float, float] | None = None,
    chain_order: int | None = None,
    payload: Payload | None = None,
    freeze: Collection[str] = (),
    floating: bool = False,
    poses: Mapping[str, Sequence[float]] | None = None,
    points: Mapping[str, str] | None = None,
    contacts: Mapping[str, Contact] | None = None,
    verified: bool = True,
    on_step: OnStep = unseen,
) -> Package:
    """Return all that a package's files show, as ``generate_package`` takes it.

    ``verified`` packages have golden results and measured errors, which takes most of the time;
    the C is the same without.
    """
    frame = robot.frame(tip or robot.tip or "").name
    if gravity is None:
        gravity = STANDARD_GRAVITY if robot.loops else WEIGHTLESS
    _check(robot, real, gravity, chain_order, floating)
    chain_order = chain_order or min(CHAIN_ORDER, longest_chain(robot))
    checked = checked_poses(robot, poses or {})
    bodies = built_in(contacts or {})
    watched = {TIP: frame, **checked_points(robot, points or {})}
    prefix = c_name(name or robot.name)
    parameters = parameters_of(robot, payload=payload is not None)
    defaults = defaults_of(robot, parameters, drives, payload)
    parameters = frozen_parameters(defaults, freeze)
    golden = draw_samples(robot, parameters, 4 * GOLDEN_CASES, seed=1)
    measured = draw_samples(
        robot, parameters, MEASURED_SAMPLES if verified else GOLDEN_CASES, seed=2
    )
    on_step("derivation", 0, 1)
    symbols = symbols_of(robot, frame, gravity, parameters)
    functions = functions_of(symbols, chain_order, floating=floating)
    golden = _regular(functions, golden, frame) if verified else golden
    sources = []
    inputs = as_columns(measured)
    for done, function in enumerate(functions):
        on_step(function.name, done, len(functions) + 1)
        name = f"{prefix}_{function.name}"
        record = _record(name, function, inputs) if verified else NOT_MEASURED
        sources.append(CSource(prefix, robot.n, parameters, function, record))
    configuration = None
    if has_configuration(robot):
        found = Configuration(robot, gravity)
        configuration = configuration_source(prefix, found, golden, measured)
    package = Package(
        prefix=prefix,
        robot=robot,
        tip=frame,
        real=real,
        gravity=gravity,
        chain_order=chain_order,
        parameters=parameters,
        defaults=tuple(d for d in defaults if d.parameter in parameters),
        functions=tuple(sources),
        samples=tuple(golden),
        tables={f.name: golden_results(f, golden) if verified else () for f in functions},
        configuration=configuration,
        floating=floating,
        impact=impact_source(
            prefix,
            symbols,
            watched,
            golden=GOLDEN_IMPACTS if verified else 0,
            contacts=bodies,
        ),
        poses=checked,
        contacts=bodies,
    )
    asked = {"poses": poses, "contacts": contacts, "points": points}
    for field, given in asked.items():
        if given and not package.impact:
            raise InvalidValue(field, f"robot '{robot.name}' has no impacts to use them in")
    return with_stages(package, symbols)


def checked_points(robot: Robot, points: Mapping[str, str]) -> dict[str, str]:
    """Return contact points by name; raises InvalidValue, FrameNotFound."""
    seen = {TIP}
    for name, frame in points.items():
        if not name.isidentifier() or not name.isascii():
            raise InvalidValue("points", f"'{name}' is no name of a contact point in C")
        if name.lower() in seen:
            raise InvalidValue("points", f"'{name}' is the name of two contact points in C")
        seen.add(name.lower())
        if robot.frame(frame).joint < 0:
            raise InvalidValue("points", f"frame '{frame}' is fixed to the base and never moves")
    return dict(points)


def _check(
    robot: Robot,
    real: str,
    gravity: Sequence[float],
    chain_order: int | None,
    floating: bool,
) -> None:
    if real not in ("double", "float"):
        raise InvalidValue("real", f"must be 'double' or 'float', not '{real}'")
    if len(gravity) != 3 or not np.isfinite(gravity).all():
        raise InvalidValue("gravity", "needs three finite numbers [x, y, z]")
    if floating and robot.loops:
        raise InvalidValue("floating", "closed chains have no such function; leave it out")
    longest = longest_chain(robot)
    if chain_order is not None and not 1 <= chain_order <= longest:
        raise InvalidValue("chain_order", f"must be from 1 to {longest}, not {chain_order}")


def _regular(functions: Sequence[CFunction], samples: Sequence[Sample], tip: str) -> list[Sample]:
    """Return golden inputs to which all functions have an answer."""
    inputs = as_columns(samples)
    regular = np.all([is_regular(function, inputs) for function in functions], axis=0)
    if not regular.any():
        raise InvalidValue("tip", f"frame '{tip}' cannot move at any of the sampled configurations")
    return [samples[i] for i in np.flatnonzero(regular)[:GOLDEN_CASES]]


def _record(name: str, function: CFunction, inputs: Inputs) -> FunctionRecord:
    found = accuracy(function, inputs)
    return FunctionRecord(
        name=name,
        flops=function.flops,
        sines_and_cosines=function.sines_and_cosines,
        double_error=found.double,
        float_error=found.single,
        float_error_worst=found.single_worst,
    )


def _manifest(package: Package, costs: Costs | None, hashes: dict[str, str]) -> Manifest:
    records = [source.record for source in package.functions]
    if package.configuration:
        records.insert(0, package.configuration.record)
    return Manifest(
        name=package.prefix,
        version=softimpact.__version__,
        model=package.robot.name,
        tip=package.tip,
        digest=package.robot.digest(floating=package.floating),
        real=package.real,
        joints=package.robot.joint_names,
        coordinates=package.coordinates,
        gravity=package.gravity,
        chain_order=package.chain_order,
        parameters=tuple(p.name for p in package.fields),
        frozen={p.name: p.frozen for p in package.parameters if p.frozen is not None},
        floating=package.floating,
        functions=tuple(records),
        poses=tuple(package.poses),
        impact=package.impact.record if package.impact else None,
        costs=costs,
        files=hashes,
    )
