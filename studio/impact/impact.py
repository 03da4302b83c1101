# SPDX-License-Identifier: BSD-3-Clause
"""One impact, simulated from what a user typed and held against every limit of the body."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass

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
from softimpact.simulate.controller import ControllerReference
from softimpact.simulate.tolerances import Tolerances
from softimpact.symbolic import Contact, InvalidValue, body_region
from softimpact.symbolic.body.body_file import load_body, load_cover
from softimpact.symbolic.body.shapes import shape_from
from softimpact.symbolic.robot.rigid import Array

from ..typed import values
from ..typed.motors import motors_meant
from ..typed.situation import Situation, Typed, situation


@dataclass(frozen=True)
class TypedBody:
    """The options that say what is hit, as typed."""

    region: str | None
    file: str | None = None
    cover: str | None = None
    clamped: bool = True
    shape: str | None = None


@dataclass(frozen=True)
class TypedImpact:
    """The options that make up an impact, as typed; see ``simulate_command``."""

    body: TypedBody
    speed: float | None
    fidelity: str = "linearised"
    joint_velocity: str | None = None
    peak: str = "peak"
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


@dataclass(frozen=True, eq=False)
class Answer:
    """What became of an impact, and of what it was asked.

    Attributes:
        scene: the arm, how it stands and where it is hit.
        contact: what it hits.
        how: the options.
        speed: of the contact point [m/s].
        horizon: up to which forces count [s].
        definition: of the peak that was asked for.
        found: the assessment.
    """

    scene: Situation
    contact: Contact
    how: TypedImpact
    speed: float
    horizon: float
    definition: PeakDefinition
    found: Assessment


def impact(where: Typed, how: TypedImpact) -> Answer:
    """Simulate an impact and assess it.

    Raises:
        SoftImpactError: an option is wrong or the simulation failed.
    """
    fidelity: Fidelity = values.one_of("impact model", how.fidelity, Fidelity)
    definition: PeakDefinition = values.one_of("peak definition", how.peak, PeakDefinition)
    contact = contact_of(how.body)
    motors, reaction = motors_meant(where.drives)
    if how.pid is not None and where.drives.tell_motors:
        raise InvalidValue("pid", "excludes --motors and its reaction")
    scene = situation(where)
    typed, velocity = _speed(scene, how)
    horizon = HORIZON if how.horizon is None else how.horizon
    shape = None if how.body.shape is None else shape_from(how.body.shape)

    def assessed(speed: float) -> Assessment:
        return assess_impact(
            scene.model,
            Approach(scene.q, scene.direction, speed, velocity),
            contact,
            fidelity,
            motors=controller_of(how) or motors,
            reaction=reaction,
            horizon=horizon,
            shape=shape,
            payload=scene.payload,
            order=how.order,
            safe_speed=how.safe_speed,
            tolerances=Tolerances() if how.band else None,
        )

    with _naming_options():
        speed = typed
        if speed is None:
            speed = assessed(ANY_SPEED).safe_speed
            if not speed:
                raise InvalidValue("speed", "is missing, and none is safe; give --speed")
        found = assessed(speed)
    return Answer(scene, contact, how, speed, horizon, definition, found)


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


def controller_of(how: TypedImpact) -> Controller | None:
    """Return the papers' controller, if it was asked for; raises InvalidValue."""
    if how.pid is None:
        if how.reference is not None:
            raise InvalidValue("reference", "is of the controller that --pid gives; give that too")
        return None
    reference: ControllerReference = values.one_of(
        "reference of the motors", how.reference or "moving", ControllerReference
    )
    proportional, derivative, integral = values.vector("pid", how.pid, 3)
    return Controller(proportional, derivative, integral, reference)


ANY_SPEED = 0.25
"""Speed at which an impact is simulated of which only the safe speed matters [m/s]."""


def _speed(scene: Situation, how: TypedImpact) -> tuple[float | None, Array | None]:
    """Return the speed of the contact point, and the joint velocities for 1 m/s of it.

    No speed, if it is the safe one.
    """
    if how.joint_velocity is None:
        if how.speed is None and not how.safe_speed:
            raise InvalidValue(
                "speed", "is missing; give --speed, --joint-velocity or --safe-speed"
            )
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
