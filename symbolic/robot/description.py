# SPDX-License-Identifier: BSD-3-Clause
"""What a robot file describes: bodies on bodies, before anyone asks which of them is the arm.

Readers of file formats make descriptions, ``assembly`` makes robots of them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field

import numpy as np

from ..errors import ModelFileError
from .constraints import Constraint, Tendon
from .rigid import Array, Inertia, Placement
from .robot import Frame, Joint

WORLD = 0
"""Index of the body that all others stand on."""

LARGEST = 1e15
"""Number beyond which a length [m], mass [kg] or inertia [kg m²] is no robot's."""


@dataclass(frozen=True, eq=False)
class RigidBody:
    """A body and the joints between it and the body that carries it.

    Attributes:
        name: empty where the file gives none.
        carrier: index of the body that carries it, -1 for the world.
        placement: its frame in its carrier's, with all joints at their references.
        inertia: in its frame.
        joints: from the carrier on; the placement of each is its axis in this body's frame, and
            its parent is not read.
        free_joint: name of a joint that leaves the body all six degrees of freedom.
        target: whether it is moved by whoever runs a simulation (MJCF ``mocap``).
    """

    name: str
    carrier: int
    placement: Placement
    inertia: Inertia
    joints: tuple[Joint, ...] = ()
    free_joint: str | None = None
    target: bool = False


@dataclass(frozen=True, eq=False)
class Description:
    """A robot file's content in one form for all formats.

    Attributes:
        source: the file, for messages.
        name: of the model; empty where the file gives none.
        bodies: carriers before what they carry, the world first.
        sites: named frames; their ``joint`` is the index of the *body* that carries them.
        constraints: loops, couplings and welds between named frames and joints.
        tendons: with inertia or springs of their own.
        tip: frame that the file names as contact point.
        rotor_inertia_sets: reflected rotor inertias by source, one entry a joint.
        home: coordinate of each joint, by name, at which the loops are closed or nearly so.
        independent: joints that describe a closed chain.
        rotors_stated: whether the file says all there is of rotors.
        warnings: what was ignored or approximated, a line each.
    """

    source: str
    name: str
    bodies: tuple[RigidBody, ...]
    sites: tuple[Frame, ...] = ()
    constraints: tuple[Constraint, ...] = ()
    tendons: tuple[Tendon, ...] = ()
    tip: str | None = None
    rotor_inertia_sets: Mapping[str, tuple[float, ...]] = field(default_factory=dict)
    home: Mapping[str, float] | None = None
    independent: tuple[str, ...] = ()
    rotors_stated: bool = False
    warnings: tuple[str, ...] = ()


def require_finite(description: Description) -> None:
    """Raise ModelFileError if a length, mass or inertia is not finite or beyond all reason."""
    for name, numbers in _numbers(description):
        if np.isnan(numbers).any():
            raise ModelFileError(description.source, f"a number is NaN ({name})")
        if not (abs(numbers) < LARGEST).all():
            raise ModelFileError(description.source, f"a number is infinite or too large ({name})")


def _numbers(description: Description) -> Iterator[tuple[str, Array]]:
    for body in description.bodies:
        yield f"place of body '{body.name}'", _of_placement(body.placement)
        inertia = body.inertia
        yield (
            f"inertia of body '{body.name}'",
            np.array([inertia.mass, *inertia.first_moment, *inertia.about_origin.flat]),
        )
        for joint in body.joints:
            own = [joint.offset, joint.armature, joint.stiffness, joint.spring_reference]
            own += [joint.damping, joint.friction, *_of_placement(joint.placement)]
            yield f"joint '{joint.name}'", np.array(own)
    for site in description.sites:
        yield f"place of site '{site.name}'", _of_placement(site.placement)


def _of_placement(placement: Placement) -> Array:
    return np.concatenate([placement.rotation.ravel(), placement.translation])
