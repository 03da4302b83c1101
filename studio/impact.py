# SPDX-License-Identifier: BSD-3-Clause
"""One impact, simulated from what a user typed and held against the region's force limit."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import Any

import numpy as np

from softimpact.simulate import (
    Approach,
    Controller,
    Fidelity,
    PeakDefinition,
    largest_safe_speed,
    simulate_impact,
)
from softimpact.simulate.controller import Reference
from softimpact.symbolic import Contact, InvalidValue, body_region
from softimpact.symbolic.robot.rigid import Array

from . import values
from .output import print_table
from .situation import Situation, Typed, situation


@dataclass(frozen=True)
class TypedImpact:
    """The options that make up an impact, as typed; see ``simulate_command``."""

    region: str
    speed: float
    fidelity: str = "linearised"
    clamped: bool = True
    joint_velocity: str | None = None
    peak: str = "peak"
    safe_speed: bool = False
    order: int = 3
    pid: str | None = None
    reference: str = "moving"


def impact(where: Typed, how: TypedImpact) -> dict[str, Any]:
    """Simulate an impact; return its inputs, force over time, peaks and verdict.

    Raises:
        SoftImpactError: an option is wrong or the simulation failed.
    """
    fidelity: Fidelity = values.one_of("impact model", how.fidelity, Fidelity)
    definition: PeakDefinition = values.one_of("peak definition", how.peak, PeakDefinition)
    contact = Contact(body_region(how.region), how.clamped)
    scene = situation(where)
    velocity = None if how.joint_velocity is None else _per_speed(scene, how.joint_velocity)
    approach = Approach(scene.q, scene.direction, how.speed, velocity)
    limit, safe_speed = contact.region.force_limit, None
    with _naming_options():
        controller = _controller(how)
        history = simulate_impact(
            scene.model, approach, contact, fidelity, order=how.order, motors=controller
        )
        if how.safe_speed:
            safe_speed = largest_safe_speed(
                scene.model,
                approach,
                contact,
                limit,
                fidelity,
                definition,
                order=how.order,
                motors=controller,
            )
    peak = history.force_of(definition)
    return {
        "robot": scene.model.robot.name,
        "tip": scene.model.tip,
        "q": scene.q,
        "direction": scene.direction,
        "model": fidelity,
        "controller": controller,
        "region": how.region,
        "clamped": how.clamped,
        "speed": how.speed,
        "peak_force": peak,
        "peak_definition": definition,
        "first_contact": history.first_contact,
        "time_of_first_contact_peak": history.time_of_first_contact_peak,
        "first_peak": history.first_peak,
        "time_of_first_peak": history.time_of_first_peak,
        "separation": history.separation,
        "limit": limit,
        "within_limit": peak <= limit,
        "safe_speed": safe_speed,
        "time": history.time,
        "force": history.force,
    }


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
    reference: Reference = values.one_of("reference of the motors", how.reference, Reference)
    if how.pid is None:
        return None
    proportional, derivative, integral = values.vector("pid", how.pid, 3)
    return Controller(proportional, derivative, integral, reference)


def print_impact(result: Mapping[str, Any]) -> None:
    """Print what ``impact`` returned as a table."""
    separation = result["separation"]
    held = "held" if result["clamped"] else "free to give way"
    verdict = "kept" if result["within_limit"] else "exceeded"
    print_table(
        f"{result['robot']} on {result['region']} ({held}) at {result['speed']:g} m/s, "
        f"model {result['model']}",
        ("quantity", "value", "unit"),
        [
            (f"peak force, {result['peak_definition']}", result["peak_force"], "N"),
            ("largest force until separation", result["first_contact"], "N"),
            ("  after", 1e3 * result["time_of_first_contact_peak"], "ms"),
            ("first local maximum", result["first_peak"], "N"),
            ("  after", 1e3 * result["time_of_first_peak"], "ms"),
            ("separation after", None if separation is None else 1e3 * separation, "ms"),
            (f"limit of the region, {verdict}", result["limit"], "N"),
            ("largest safe speed (--safe-speed)", result["safe_speed"], "m/s"),
        ],
    )


def _per_speed(scene: Situation, text: str) -> Array:
    """Return typed joint velocities scaled to move the contact point by 1 m/s along n."""
    velocity = scene.model.vector("joint_velocity", values.vector("joint_velocity", text))
    along = float(scene.direction @ np.array(scene.model.jacobian(scene.q)) @ velocity)
    if not along > 0:
        raise InvalidValue(
            "joint_velocity",
            f"must move the contact point along the direction, but moves it by {along:.3g} m/s",
        )
    return np.asarray(velocity / along)
