# SPDX-License-Identifier: BSD-3-Clause
"""What a page knows beside its C: the robot's looks, body regions, and where it begins."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

import softimpact
from softimpact.codegen import region_parameters
from softimpact.simulate.bracket import unknown_rotors
from softimpact.simulate.tolerances import Tolerances, error_factors
from softimpact.simulate.trajectory import passes
from softimpact.symbolic import (
    REGIONS,
    Contact,
    Drives,
    ImpactModel,
    InvalidValue,
    JointKind,
    Robot,
    limits_of,
)
from softimpact.symbolic.impact.two_body import moving_mass
from softimpact.symbolic.robot.robot import BASE

from .opened import Opened
from .package import ancestors

THINNEST = 1e-3
"""Length [m] below which a part of the arm is not drawn."""

VARIED = 160
"""Impacts from which the page's band is taken."""

MOST_MOMENTS = 2000
"""Samples of a program that a page holds; of longer ones every so many."""


def content_of(opened: Opened) -> dict[str, Any]:
    """Return all of it as JSON holds it."""
    robot, drives = opened.robot, opened.drives
    model = ImpactModel(robot, str(robot.tip), drives)
    unknown = _unknown(model)
    return {
        "title": opened.title,
        "robot": robot.name,
        "version": softimpact.__version__,
        "digest": robot.digest(),
        "joints": [
            {
                "name": joint.name,
                "turns": joint.kind is JointKind.HINGE,
                "lower": float(max(joint.lower, -np.pi)),
                "upper": float(min(joint.upper, np.pi)),
                "speed": None if np.isinf(joint.speed_limit) else float(joint.speed_limit),
            }
            for joint in robot.joints
        ],
        "bodies": [
            {"moved_by": moved_by, "parts": [*_parts(robot, i)]}
            for i, moved_by in enumerate(ancestors(robot))
        ],
        "base": [*_parts(robot, BASE)],
        "points": [*_points(robot)],
        "regions": [*map(_region, _bodies(opened))],
        "moving_mass": float(moving_mass(robot)),
        "elastic": all(drives.elastic),
        "unknown_rotors": unknown,
        "warnings": opened.warnings,
        "assumed": opened.assumed,
        "start": _start(opened),
        "postures": [{"name": k, "q": _list(q)} for k, q in opened.postures.items()],
        "designs": [vars(design) for design in opened.designs],
        "designs_limit": opened.limit,
        "motion": None if opened.motion is None else _motion(opened),
        "map": None if opened.map is None else vars(opened.map),
        "varied": _varied(robot.n),
    }


def _unknown(model: ImpactModel) -> list[str]:
    """Return the joints whose rotors nobody stated, or stated to be nothing behind a spring."""
    robot, rotors = model.robot, np.array(model.drives.rotors, dtype=float).ravel()
    nothing = np.array(model.drives.elastic) & np.array(robot.actuated) & (rotors == 0)
    names = {robot.joint_names[i] for i in np.flatnonzero(nothing)} | {*unknown_rotors(model)}
    return [name for name in robot.joint_names if name in names]


def _parts(robot: Robot, body: int) -> Iterator[list[list[float]]]:
    """Yield straight parts of a body in its joint's frame, from the joint to what it carries."""
    ends = [joint.placement.translation for joint in robot.joints if joint.parent == body]
    tip = robot.frame(str(robot.tip))
    if tip.joint == body:
        ends.append(tip.placement.translation)
    for end in ends:
        if np.linalg.norm(end) > THINNEST:
            yield [[0.0, 0.0, 0.0], _list(end)]


def _points(robot: Robot) -> Iterator[dict[str, Any]]:
    """Yield the frames that an impact may be at, the end of the arm first."""
    tip = str(robot.tip)
    for name, frame in sorted(robot.frames.items(), key=lambda item: item[0] != tip):
        if frame.joint != BASE:
            yield {"name": name, "body": frame.joint, "place": _list(frame.placement.translation)}
    if tip not in robot.frames:
        frame = robot.frame(tip)
        yield {"name": tip, "body": frame.joint, "place": _list(frame.placement.translation)}


def _bodies(opened: Opened) -> list[Contact]:
    """Return the regions of the body, and what is opened where that is another one or is padded."""
    name = opened.body.region.name
    own = {name: opened.body}
    plain = {region.name: Contact(region) for region in REGIONS.values()}
    return [*({**plain, **own}).values()]


def _region(body: Contact) -> dict[str, Any]:
    region, known = body.region, region_parameters(replace(body, clamped=True))
    limits = limits_of(region, clamped=True)
    assert limits.quasi_static is not None
    if limits.transient.force == np.inf:
        raise InvalidValue("region", f"'{region.name}' has no limits to be kept")
    law = known["law"]
    return {
        "name": region.name,
        "title": region.title,
        "permitted": region.permitted,
        "stiffness": region.stiffness,
        "damping": region.damping,
        "effective_mass": region.effective_mass,
        "hertz_stiffness": known["hertz_stiffness"],
        "law": None if law is None else law.tolist(),
        "transient": limits.transient.force,
        "quantity": limits.transient.quantity,
        "quasi_static": limits.quasi_static.force,
    }


def _start(opened: Opened) -> dict[str, Any]:
    robot, drives = opened.robot, opened.drives
    tip = robot.frame(str(robot.tip))
    return {
        "q": _list(opened.q),
        "n": _list(opened.direction),
        "body": tip.joint,
        "place": _list(tip.placement.translation),
        "speed": opened.speed,
        "region": opened.body.region.name,
        "clamped": opened.body.clamped,
        "motors": opened.kind or "bracket",
        "reaction_time": None if np.isinf(opened.reaction_time) else opened.reaction_time,
        "horizon": opened.horizon,
        "springs": _list(drives.springs),
        "rotors": _list(drives.rotors),
        **_gains(robot, drives),
        "payload": 0.0,
    }


def _gains(robot: Robot, drives: Drives) -> dict[str, list[float]]:
    """Return the gains of a servo: those given, or else the file's."""
    if drives.has_gains:
        own = np.zeros(robot.n) if drives.damping_gains is None else drives.damping_gains
        return {"position_gain": _list(drives.gains), "damping_gain": _list(own)}
    position, damping = robot.position_gains, robot.velocity_gains
    return {"position_gain": _list(position), "damping_gain": _list(damping)}


def _motion(opened: Opened) -> dict[str, Any]:
    assert opened.motion is not None
    passed = passes(opened.motion)
    every = slice(None, None, -(-len(passed.sample) // MOST_MOMENTS))
    at = passed.sample[every]
    return {
        "t": _list(opened.motion.time[at]),
        "q": [_list(q) for q in opened.motion.q[at]],
        "dq": [_list(dq) for dq in passed.velocity[every]],
    }


def _varied(n: int) -> dict[str, list[Any]]:
    """Return factors by which numbers may err, a row an impact; links do not vary in the page."""
    found = error_factors(replace(Tolerances(), links=0.0), n, VARIED)
    named = (
        *("rotors", "springs", "position_gains", "damping_gains"),
        *("reaction_time", "body", "law", "damping"),
    )
    return {name: np.round(getattr(found, name), 4).tolist() for name in named}


def _list(values: Sequence[float] | Any) -> list[float]:
    return [float(x) + 0.0 for x in np.array(values, dtype=float).ravel()]
