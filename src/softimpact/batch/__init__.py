# SPDX-License-Identifier: BSD-3-Clause
"""A robot's C package over arrays: thousands of poses, directions and parameters in one call.

    panda = compiled("panda", joint_stiffness=1e4)
    found = panda.safe_speed(q, n, region="chest")
    found["speed"], found["status"]

The package is generated once, each of its functions compiled when it is first called, and both are
kept in the user's cache. Calls run in several threads; closed forms compute many rows at once.
"""

from __future__ import annotations

import os
from collections.abc import Mapping, Sequence
from pathlib import Path

from softimpact.codegen.record.manifest import Real
from softimpact.symbolic import Drives, InvalidValue, Robot, chain_to, load_robot
from softimpact.symbolic.impact.drives import PerJoint
from softimpact.symbolic.impact.drives import drives as drives_with

from .build import CompilerFailed, NoCompiler, prepared
from .calls import Arrays, CompiledPackage

__all__ = ["Arrays", "CompiledPackage", "CompilerFailed", "NoCompiler", "compiled", "compiled_arm"]


def compiled(
    model: str | Path | Robot,
    *,
    tip: str | None = None,
    end: str | None = None,
    points: Mapping[str, str] | Sequence[str] | None = None,
    real: Real = "double",
    joint_stiffness: PerJoint | None = None,
    rotor_inertia: PerJoint | None = None,
    position_gain: PerJoint | None = None,
    threads: int | None = None,
) -> CompiledPackage:
    """Return a robot's C package as functions over arrays.

    Args:
        model: built-in robot, path of a file, or a robot that is there already.
        tip: contact frame; default the robot's own.
        end: end of the arm, whose joints all stay; default the contact frame.
        points: further contact points for ``speed_factor``, by name; frames alone are ``point_1``
            and so on.
        real: number type; ``float`` is faster and good for 2e-3 of forces, too.
        joint_stiffness: default of the parameter, and so the next two.
        rotor_inertia: the file's unless given.
        position_gain: of a servo.
        threads: default one a processor.

    Raises:
        NoCompiler: there is none.
        SoftImpactError: the robot cannot be read, or has no such frame.
    """
    robot = model if isinstance(model, Robot) else load_robot(str(model), tip)
    contact = robot.tip if tip is None else tip
    if contact is None and end is None:
        raise InvalidValue("tip", f"{model} names no contact frame; name one")
    arm = chain_to(robot, end or str(contact))
    given = (joint_stiffness, rotor_inertia, position_gain)
    known = None if all(x is None for x in given) else drives_with(arm, *given)
    return compiled_arm(arm, known, tip=contact or end, points=points, real=real, threads=threads)


def compiled_arm(
    arm: Robot,
    drives: Drives | None = None,
    *,
    tip: str | None = None,
    points: Mapping[str, str] | Sequence[str] | None = None,
    real: Real = "double",
    gravity: tuple[float, float, float] | None = None,
    threads: int | None = None,
) -> CompiledPackage:
    """Return the functions of an arm that is there already: loaded, with its tool and payload.

    Args:
        arm: all of its joints are moved.
        drives: defaults of the parameters; the file's unless given.
        tip: contact frame; default the arm's own.
        points: as ``compiled``, and what follows.
        real: number type.
        gravity: whose curvature counts [m/s²]; default as ``generate_package``.
        threads: default one a processor.

    Raises:
        NoCompiler: there is none.
        SoftImpactError: the arm has no such frame.
    """
    if isinstance(points, str):
        raise InvalidValue("points", "takes a list of frames, or frames by name")
    if points is not None and not isinstance(points, Mapping):
        points = {f"point_{i}": frame for i, frame in enumerate(points, 1)}
    sources = prepared(arm, str(tip or arm.tip), real, drives, dict(points or {}), gravity)
    return CompiledPackage(sources, threads or _processors())


def _processors() -> int:
    """Return how many processors this process may use, as far as the system tells it."""
    allowed = getattr(os, "sched_getaffinity", None)
    return len(allowed(0)) if allowed else os.cpu_count() or 1
