# SPDX-License-Identifier: BSD-3-Clause
"""Simulate an impact at the wanted fidelity."""

from __future__ import annotations

import logging
from typing import get_args

import numpy as np
from numpy.typing import ArrayLike

from softimpact.symbolic import Contact, ImpactModel, InvalidValue, Motors, UnknownName
from softimpact.symbolic.impact.chain import ChainEnd
from softimpact.symbolic.impact.motors import check_motors
from softimpact.symbolic.robot.rigid import Array

from .arrival import Approach, Arrival, arrival_of
from .controlled import controlled, controlled_scene
from .controller import Controller, check_controller
from .events import Course, course_of, peaks_of
from .full import full_scene
from .history import HORIZON, PRESSED_UNTIL, Fidelity, ImpactHistory, require_horizon, require_speed
from .linear_stages import linear_scene, masses_scene, one_mass_scene, two_mass_scene
from .scene import Scene

LOGGER = logging.getLogger(__name__)


def simulate_impact(
    model: ImpactModel,
    approach: Approach,
    contact: Contact,
    fidelity: Fidelity = "linearised",
    *,
    motors: Motors | Controller | None = None,
    horizon: float | None = HORIZON,
    pressing: bool = True,
    order: int = 3,
    end: ChainEnd | None = None,
    tolerance: float = 1e-10,
) -> ImpactHistory:
    """Simulate a robot's impact on a body region with SUNDIALS.

    Args:
        model: the robot and its contact point.
        approach: how it arrives.
        contact: what it hits.
        fidelity: ``one_mass`` (m_c), ``two_mass`` (m_c, k_r, m_a), ``chain``, ``linearised`` or
            ``full`` (nonlinear).
        motors: what they do; None is a servo where the model has gains, else free motors. The
            papers' ``Controller`` takes the place of the model's gains. The two simplest models
            have none.
        horizon: up to which the largest force counts [s]. None: until the first contact ends.
        pressing: whether to follow a clamped body to ``PRESSED_UNTIL``, for what presses on it.
        order: number of the chain's masses.
        end: of the chain; None keeps its last spring, to a ground that moves as the motors do,
            unless they are free. A chain much shorter than the robot may be nearer with a free
            end.
        tolerance: of the integrator, relative and absolute for an approach of 1 m/s.

    Raises:
        InvalidValue: a number outside what it means; WrongLength for vectors.
        UnknownName: no such fidelity, or no such motors.
        SingularDirection: the contact point cannot move along the direction.
        SimulationFailed: the integrator gave up.
    """
    if fidelity not in get_args(Fidelity):
        raise UnknownName("fidelity", fidelity, get_args(Fidelity))
    _check(contact, horizon, tolerance)
    arrival = arrival_of(model, approach)
    what = Motors("servo" if model.drives.has_gains else "free") if motors is None else motors
    kind = what.kind if isinstance(what, Motors) else "of the papers' controller"
    LOGGER.info("simulate at %g m/s, model %s, motors %s", arrival.speed, fidelity, kind)
    scene = _scene(model, arrival, contact, fidelity, what, order, end, tolerance)
    did = what if isinstance(what, Motors) and not _is_lumped(fidelity) else None
    return _history(scene, fidelity, did, horizon, pressing)


def simulate_masses(
    mass: ArrayLike,
    springs: ArrayLike,
    speed: float,
    contact: Contact,
    *,
    horizon: float | None = HORIZON,
    pressing: bool = True,
    tolerance: float = 1e-10,
) -> ImpactHistory:
    """Simulate masses in a row that hit a body region: any reduced model of a robot.

    Args:
        mass: of each [kg], length r; the first is hit, and all arrive together.
        springs: behind each [N/m], length r; the last one leads to a ground that moves on, as
            motors do that keep their speed. 0 is no spring.
        speed: of the approach [m/s].
        contact: what they hit.
        horizon: see ``simulate_impact``, as the next two.
        pressing: whether to follow a clamped body further.
        tolerance: of the integrator.

    Raises:
        InvalidValue: a number outside what it means, or lists of different lengths.
        SimulationFailed: the integrator gave up.
    """
    _check(contact, horizon, tolerance)
    require_speed(speed)
    m, k = (np.atleast_1d(np.asarray(values, dtype=float)) for values in (mass, springs))
    if m.ndim != 1 or not m.size or not (np.isfinite(m) & (m > 0)).all():
        raise InvalidValue("mass", "needs a list of finite masses greater than 0 kg")
    if k.shape != m.shape or not (np.isfinite(k) & (k >= 0)).all():
        raise InvalidValue("springs", f"needs {m.size} finite numbers ≥ 0, one behind each mass")
    scene = masses_scene(m, k, speed, contact, tolerance)
    return _history(scene, "chain", None, horizon, pressing)


def _check(contact: Contact, horizon: float | None, tolerance: float) -> None:
    if not 1e-14 <= tolerance <= 1e-2:
        raise InvalidValue("tolerance", f"must be from 1e-14 to 1e-2, not {tolerance:g}")
    if horizon is not None:
        require_horizon(horizon)
    contact.check()


def _history(
    scene: Scene, fidelity: Fidelity, did: Motors | None, horizon: float | None, pressing: bool
) -> ImpactHistory:
    """Return what happens in a scene; ``did`` is what the motors did."""
    contact = scene.contact
    follows = contact.clamped and horizon is not None and pressing
    course = course_of(scene, max(horizon, PRESSED_UNTIL) if follows and horizon else horizon)
    found, run = peaks_of(course, horizon), course.run
    return ImpactHistory(
        fidelity=fidelity,
        motors=did,
        time=run.time,
        force=run.force,
        reading=run.reading,
        peak=found.peak.force,
        time_of_peak=found.peak.time,
        first_contact=found.first_contact.force,
        first_peak=found.first_peak.force if found.first_peak else None,
        time_of_first_contact_peak=found.first_contact.time,
        time_of_first_peak=found.first_peak.time if found.first_peak else None,
        separation=found.separation,
        pressing=_pressing(course, contact, follows),
        largest_torque=largest_torque(course),
    )


def _is_lumped(fidelity: Fidelity) -> bool:
    return fidelity in ("one_mass", "two_mass")


def _scene(
    model: ImpactModel,
    arrival: Arrival,
    contact: Contact,
    fidelity: Fidelity,
    motors: Motors | Controller,
    order: int,
    end: ChainEnd | None,
    tolerance: float,
) -> Scene:
    if _is_lumped(fidelity):
        if motors != Motors("free") and not (isinstance(motors, Motors) and model.drives.has_gains):
            field = "controller" if isinstance(motors, Controller) else "motors"
            raise InvalidValue(field, "needs motors: a chain, or the linearised or full model")
        build = one_mass_scene if fidelity == "one_mass" else two_mass_scene
        return build(model, arrival, contact, tolerance)
    if isinstance(motors, Controller):
        check_controller(motors)
        if end == "free":
            raise InvalidValue("end", "a chain with a controller keeps its spring to ground")
        if fidelity != "full":
            masses = order if fidelity == "chain" else None
            system = controlled(model, arrival, motors, masses)
            return controlled_scene(system, arrival, motors, contact, tolerance)
    else:
        check_motors(motors)
    if fidelity == "full":
        return full_scene(model, arrival, contact, motors, tolerance)
    assert isinstance(motors, Motors)
    masses = order if fidelity == "chain" else None
    return linear_scene(model, arrival, contact, motors, tolerance, masses, end)


def _pressing(course: Course, contact: Contact, follows: bool) -> float | None:
    if not contact.clamped:
        return 0.0
    time, force = course.run.time, course.run.force
    late = time >= HORIZON
    if not follows or not late.any():
        return None
    return float(max(force[late].max(), np.interp(HORIZON, time, force)))


def largest_torque(course: Course) -> Array | None:
    """Return the largest torque that a servo added to each motor's [N·m]; None without one."""
    found = []
    for piece in course.pieces:
        if piece.leg.torque is not None:
            own = course.scene.own_motion(piece.leg, piece.run.state)
            torque = piece.leg.torque(own, piece.run.time - piece.begin)
            found.append(course.scene.speed * abs(torque).max(axis=1))
    return np.max(found, axis=0) if found else None
