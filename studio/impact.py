# SPDX-License-Identifier: BSD-3-Clause
"""One impact, simulated from what a user typed and held against every limit of the body."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np

from softimpact.simulate import (
    HORIZON,
    Approach,
    Assessment,
    Controller,
    Fidelity,
    PeakDefinition,
    assess_impact,
)
from softimpact.simulate.controller import Reference
from softimpact.simulate.tolerances import Tolerances
from softimpact.symbolic import Contact, InvalidValue, body_region
from softimpact.symbolic.body.body_file import load_body, load_cover
from softimpact.symbolic.robot.rigid import Array

from . import values
from .output import print_table
from .situation import Situation, Typed, situation
from .typed_motors import NOTHING_SAID, TypedMotors, motors_of


@dataclass(frozen=True)
class TypedBody:
    """The options that say what is hit, as typed."""

    region: str | None
    file: str | None = None
    cover: str | None = None
    clamped: bool = True


@dataclass(frozen=True)
class TypedImpact:
    """The options that make up an impact, as typed; see ``simulate_command``."""

    body: TypedBody
    speed: float | None
    fidelity: str = "linearised"
    joint_velocity: str | None = None
    peak: str = "peak"
    motors: TypedMotors = NOTHING_SAID
    horizon: float | None = None
    safe_speed: bool = False
    band: bool = False
    order: int = 3
    pid: str | None = None
    reference: str | None = None


def contact_of(typed: TypedBody) -> Contact:
    """Return what is hit; raises SoftImpactError."""
    if (typed.region is None) == (typed.file is None):
        raise InvalidValue("region", "give either --region or --body")
    region = body_region(typed.region) if typed.region else load_body(typed.file or "")
    cover = None if typed.cover is None else load_cover(typed.cover)
    return Contact(region, typed.clamped, cover=cover)


def impact(where: Typed, how: TypedImpact) -> dict[str, Any]:
    """Simulate an impact; return its inputs, force over time, peaks and verdict.

    Raises:
        SoftImpactError: an option is wrong or the simulation failed.
    """
    fidelity: Fidelity = values.one_of("impact model", how.fidelity, Fidelity)
    definition: PeakDefinition = values.one_of("peak definition", how.peak, PeakDefinition)
    contact = contact_of(how.body)
    motors, reaction = motors_of(how.motors, where.drives)
    scene = situation(where)
    speed, velocity = _speed(scene, how)
    approach = Approach(scene.q, scene.direction, speed, velocity)
    horizon = HORIZON if how.horizon is None else how.horizon
    with _naming_options():
        found = assess_impact(
            scene.model,
            approach,
            contact,
            fidelity,
            motors=_controller(how) or motors,
            reaction=reaction,
            horizon=horizon,
            payload=scene.payload,
            order=how.order,
            safe_speed=how.safe_speed,
            tolerances=Tolerances() if how.band else None,
        )
    return _record(scene, contact, how, speed, horizon, found, definition)


def _record(
    scene: Situation,
    contact: Contact,
    how: TypedImpact,
    speed: float,
    horizon: float,
    found: Assessment,
    definition: PeakDefinition,
) -> dict[str, Any]:
    """Return everything that an answer depends on, and the answer."""
    history, limits, model = found.history, found.limits, scene.model
    peaks = {kind: end.peak for kind, end in found.ends.items()}
    known = [*found.ends] in (["free"], ["servo"], ["held"], ["controller"])
    pressing = limits.quasi_static
    return {
        "robot": model.robot.name,
        "joints": model.robot.joint_names,
        "tip": model.tip,
        "q": scene.q,
        "direction": scene.direction,
        "model": how.fidelity,
        "joint_stiffness": _springs(model.drives.springs, model.drives.elastic),
        "rotor_inertia": model.drives.rotors,
        "position_gain": model.drives.gains,
        "computed_torque_gain": model.drives.computed_torque_gain,
        "damping_gain": model.drives.damping_gains,
        "torque_limit": model.drives.torque_limits,
        "gravity": model.gravity,
        "payload": scene.payload,
        "motors": found.worst,
        "reaction": history.motors,
        "controller": _controller(how),
        "horizon": horizon,
        "region": contact.region.name,
        "body": contact.region,
        "cover": contact.cover,
        "clamped": contact.clamped,
        "speed": speed,
        "joint_velocity": found.joint_velocity,
        "bracket": None if known else {k: peaks.get(k) for k in ("free", "driven")},
        "peak": history.peak,
        "time_of_peak": history.time_of_peak,
        "peak_force": history.force_of(definition),
        "peak_definition": definition,
        "first_contact": history.first_contact,
        "time_of_first_contact_peak": history.time_of_first_contact_peak,
        "first_peak": history.first_peak,
        "time_of_first_peak": history.time_of_first_peak,
        "separation": history.separation,
        "pressing": history.pressing,
        "energy": found.energy,
        "limits": {
            "transient": contact.region.force_limit,
            "quasi_static": contact.region.quasi_static_limit if contact.clamped else None,
            "energy": contact.region.energy_limit,
            "permitted": limits.permitted,
            "least_transient_force": limits.transient.force,
            "least_quasi_static_force": None if pressing is None else pressing.force,
        },
        "limit": contact.region.force_limit,
        "within_limit": found.verdict.ruling == "kept",
        "verdict": found.verdict.ruling,
        "binding": found.verdict.binding,
        "share_of_limit": found.verdict.share,
        "iso": found.two_body,
        "joint_speed_limit_exceeded": found.joint_speed_limit_exceeded,
        "torque_limit_exceeded": found.torque_limit_exceeded,
        "band": None if found.band is None else found.band.peak,
        "bands": found.band,
        "tolerances": Tolerances() if found.band else None,
        "safe_speed": found.safe_speed,
        "safe_speeds": found.safe_speeds,
        "warnings": [*scene.warnings, *found.warnings, *_cautions(found)],
        "time": history.time,
        "force": history.force,
    }


def _springs(springs: Any, elastic: tuple[bool, ...]) -> list[float | None]:
    """Stiffness of each joint; None where it is rigid."""
    numbers = np.array(springs, dtype=float).ravel()
    return [float(k) if gives else None for k, gives in zip(numbers, elastic, strict=True)]


def _cautions(found: Assessment) -> Iterator[str]:
    """Yield what a reader must know before using the numbers."""
    if found.verdict.ruling == "not permitted":
        yield "contact with this region is not to be designed for; its limits are for reference"
    for names, words in (
        (found.joint_speed_limit_exceeded, "faster than their speed limits"),
        (found.torque_limit_exceeded, "asked for more torque than they have (the model gives it)"),
    ):
        if names:
            yield f"joints {', '.join(names)} are {words}"


OPTIONS = {
    "fidelity": "--model",
    "controller": "--pid",
    "controller.proportional": "--pid, k_p",
    "controller.derivative": "--pid, k_d",
    "controller.integral": "--pid, k_i",
}
"""What the command line calls the fields of an impact."""


@contextmanager
def _naming_options() -> Iterator[None]:
    """Let errors name fields as they were typed."""
    try:
        yield
    except InvalidValue as error:
        raise InvalidValue(OPTIONS.get(error.field, error.field), error.reason) from None


def _controller(how: TypedImpact) -> Controller | None:
    if how.pid is None:
        if how.reference is not None:
            raise InvalidValue("reference", "is of the controller that --pid gives; give that too")
        return None
    if how.motors != NOTHING_SAID:
        raise InvalidValue("pid", "excludes --motors and its reaction")
    reference: Reference = values.one_of(
        "reference of the motors", how.reference or "moving", Reference
    )
    proportional, derivative, integral = values.vector("pid", how.pid, 3)
    return Controller(proportional, derivative, integral, reference)


def _speed(scene: Situation, how: TypedImpact) -> tuple[float, Array | None]:
    """Return the speed of the contact point, and the joint velocities for 1 m/s of it."""
    if how.joint_velocity is None:
        if how.speed is None:
            raise InvalidValue("speed", "is missing; give --speed, or --joint-velocity")
        return how.speed, None
    velocity = scene.model.vector(
        "joint_velocity", values.vector("joint_velocity", how.joint_velocity)
    )
    along = float(scene.direction @ np.array(scene.model.jacobian(scene.q)) @ velocity)
    if not along > 0:
        raise InvalidValue(
            "joint_velocity",
            f"must move the contact point along the direction, but moves it by {along:.3g} m/s",
        )
    return along if how.speed is None else how.speed, np.asarray(velocity / along)


def print_impact(result: Mapping[str, Any]) -> None:
    """Print what ``impact`` returned as a table."""
    separation, bracket = result["separation"], result["bracket"]
    held = "held" if result["clamped"] else "free to give way"
    first, limits = result["time_of_first_peak"], result["limits"]
    rows: list[tuple[str, float | str | None, str]] = [
        ("largest force", result["peak"], "N"),
        ("  after", 1e3 * result["time_of_peak"], "ms"),
        ("  if motors are free from first touch on", (bracket or {}).get("free"), "N"),
        ("  if they keep their speed until the reaction", (bracket or {}).get("driven"), "N"),
        ("largest force until separation", result["first_contact"], "N"),
        ("first local maximum", result["first_peak"], "N"),
        ("  after", None if first is None else 1e3 * first, "ms"),
        ("separation after", None if separation is None else 1e3 * separation, "ms"),
        ("pressing after 0.5 s", result["pressing"], "N"),
        ("energy in the body's spring", result["energy"], "J"),
        ("limit, transient force", limits["transient"], "N"),
        ("limit, quasi-static force", limits["quasi_static"], "N"),
        (f"verdict, by {result['binding']}", result["verdict"], ""),
        ("two-body formula of the standard", result["iso"]["force"], "N"),
        ("  its speed for the transient limit", result["iso"]["safe_speed"], "m/s"),
        ("largest safe speed (--safe-speed)", result["safe_speed"], "m/s"),
    ]
    if result["band"] is not None:
        low, high = (f"{getattr(result['band'], end):.4g}" for end in ("low", "high"))
        rows.insert(2, ("  95 of 100 cases lie within", f"{low} to {high}", "N"))
    if bracket is None:
        rows = [row for row in rows if "if " not in row[0][:5]]
    print_table(
        f"{result['robot']} on {result['region']} ({held}) at {result['speed']:g} m/s, "
        f"model {result['model']}, motors {result['motors']}",
        ("quantity", "value", "unit"),
        rows,
    )
