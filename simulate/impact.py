# SPDX-License-Identifier: BSD-3-Clause
"""Simulate an impact at the wanted fidelity."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import get_args

from softimpact.symbolic import Contact, ImpactModel, InvalidValue, UnknownName
from softimpact.symbolic.impact.chain import ChainEnd

from .approach import Approach, Arrival, arrival_of
from .controlled import controlled, controlled_scene
from .controller import Controller, check_controller
from .events import first_contact
from .full import full_scene
from .history import Fidelity, ImpactHistory
from .linear import (
    LinearSystem,
    chain_of_masses,
    linearised,
    modal_scene,
    one_mass,
    two_mass,
)


def simulate_impact(
    model: ImpactModel,
    approach: Approach,
    contact: Contact,
    fidelity: Fidelity = "linearised",
    *,
    order: int = 3,
    end: ChainEnd | None = None,
    controller: Controller | None = None,
    duration: float | None = None,
    tolerance: float = 1e-10,
) -> ImpactHistory:
    """Simulate a robot's impact on a body region with SUNDIALS.

    Args:
        model: the robot and its contact point.
        approach: how it arrives.
        contact: what it hits.
        fidelity: ``one_mass`` (m_c), ``two_mass`` (m_c, k_r, m_a), ``chain``, ``linearised``
            (MSM Eq. 5) or ``full`` (nonlinear).
        order: number of the chain's masses.
        end: of the chain; None keeps its spring to ground where a controller holds the motors. A
            chain much shorter than the robot is then nearer with a free end.
        controller: of the motors in place of the model's K_p (full, linearised and grounded
            chain); None holds them by K_p, without a reaction.
        duration: how long to simulate from first touch [s]; None: until shortly after separation.
        tolerance: of the integrator, relative and absolute for an approach of 1 m/s.

    Raises:
        InvalidValue: a number outside what it means; WrongLength for vectors.
        UnknownName: no such fidelity.
        SingularDirection: the contact point cannot move along the direction.
        SimulationFailed: the integrator gave up.
    """
    if fidelity not in get_args(Fidelity):
        raise UnknownName("fidelity", fidelity, get_args(Fidelity))
    if not 1e-14 <= tolerance <= 1e-2:
        raise InvalidValue("tolerance", f"must be from 1e-14 to 1e-2, not {tolerance:g}")
    contact.check()
    if controller is not None:
        check_controller(controller)
        if fidelity in ("one_mass", "two_mass") or end == "free":
            reason = "needs motors: a chain with its ground spring, or the linearised or full model"
            raise InvalidValue("controller", reason)
    arrival = arrival_of(model, approach)
    if fidelity == "full":
        scene = full_scene(model, arrival, contact, tolerance, controller)
    elif controller is not None:
        masses = order if fidelity == "chain" else None
        system = controlled(model, arrival, controller, masses)
        scene = controlled_scene(system, arrival, controller, contact, tolerance)
    else:
        linear = _linear_system(model, arrival, fidelity, order, end)
        scene = modal_scene(linear, arrival.speed, contact, tolerance)
    found = first_contact(scene, duration)
    return ImpactHistory(
        fidelity=fidelity,
        time=found.run.time,
        force=found.run.force,
        first_contact=found.highest.force,
        first_peak=found.first_peak.force,
        time_of_first_contact_peak=found.highest.time,
        time_of_first_peak=found.first_peak.time,
        separation=found.separation,
    )


def _linear_system(
    model: ImpactModel, arrival: Arrival, fidelity: Fidelity, order: int, end: ChainEnd | None
) -> LinearSystem:
    at = (model, arrival.q, arrival.direction)
    velocity = arrival.link_velocity
    build: dict[str, Callable[[], LinearSystem]] = {
        "one_mass": partial(one_mass, *at),
        "two_mass": partial(two_mass, *at),
        "chain": partial(chain_of_masses, *at, velocity, order, end),
        "linearised": partial(linearised, *at, velocity),
    }
    return build[fidelity]()
