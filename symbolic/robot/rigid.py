# SPDX-License-Identifier: BSD-3-Clause
"""Numeric rigid-body data: placements of frames and inertias of bodies."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from ..content import ByContent
from ..errors import InvalidValue

Array = NDArray[np.float64]

Indices = NDArray[np.int64]
"""Which of many things, by their numbers."""

ROTATION_NOISE = 1e-12
"""Entries of a rotation this near to -1, 0 or 1 are that number: what quaternions and roll, pitch
and yaw leave behind must not enter the expression graph."""


def three_numbers(field: str, values: ArrayLike) -> Array:
    """Return a vector of three finite numbers; raises InvalidValue."""
    vector = np.asarray(values, dtype=float)
    if vector.shape != (3,) or not np.isfinite(vector).all():
        raise InvalidValue(field, "needs three finite numbers [x, y, z]")
    return vector


def _frozen(value: ArrayLike, shape: tuple[int, ...]) -> Array:
    array = np.array(value, dtype=float).reshape(shape)
    array.setflags(write=False)
    return array


def product(first: ArrayLike, second: ArrayLike) -> Array:
    """Matrix product, rounded alike on every machine.

    NumPy hands its own to a library that picks fused instructions by the processor; the last bits
    of model constants, and with them generated code, would follow.
    """
    a, b = np.asarray(first, dtype=float), np.asarray(second, dtype=float)
    columns = b.T.tolist() if b.ndim == 2 else [b.tolist()]
    rows = a.tolist() if a.ndim == 2 else [a.tolist()]
    entries = [
        [sum(x * y for x, y in zip(row, column, strict=True)) for column in columns] for row in rows
    ]
    return np.array(entries).reshape(a.shape[:-1] + b.shape[1:])


@dataclass(frozen=True, eq=False)
class Placement(ByContent):
    """Pose of a frame in its parent: x_parent = rotation x + translation [m]."""

    rotation: Array
    translation: Array

    def __post_init__(self) -> None:
        rotation = np.array(self.rotation, dtype=float)
        snapped = np.where(
            abs(rotation - rotation.round()) < ROTATION_NOISE, rotation.round(), rotation
        )
        object.__setattr__(self, "rotation", _frozen(snapped + 0.0, (3, 3)))
        object.__setattr__(self, "translation", _frozen(self.translation, (3,)))

    @staticmethod
    def identity() -> Placement:
        """Return the placement of a frame that coincides with its parent."""
        return Placement(np.eye(3), np.zeros(3))

    def __matmul__(self, other: Placement) -> Placement:
        return Placement(
            product(self.rotation, other.rotation),
            product(self.rotation, other.translation) + self.translation,
        )

    def inverse(self) -> Placement:
        """Return the parent's pose in this frame."""
        return Placement(self.rotation.T, -product(self.rotation.T, self.translation))


def rotation_about_z(angle: float) -> Array:
    """Rotation matrix about z by an angle [rad]."""
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def rotation_from_axis(axis: Array, angle: float) -> Array:
    """Rotation matrix about a unit axis by an angle [rad] (Rodrigues)."""
    x, y, z = axis
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.asarray(
        np.eye(3) + np.sin(angle) * cross + (1 - np.cos(angle)) * product(cross, cross)
    )


def frame_along(axis: Array, position: Array) -> Placement:
    """Frame at ``position`` whose z axis is ``axis``, turned the shortest way."""
    axis = np.asarray(axis, dtype=float) / np.linalg.norm(axis)
    swing = np.cross([0.0, 0.0, 1.0], axis)
    sine = float(np.linalg.norm(swing))
    if sine < np.finfo(float).eps:
        return Placement(np.diag([1.0, np.sign(axis[2]), np.sign(axis[2])]), position)
    return Placement(rotation_from_axis(swing / sine, math.atan2(sine, axis[2])), position)


@dataclass(frozen=True, eq=False)
class Inertia(ByContent):
    """Mass [kg], first moment m·c [kg m] and inertia about the frame's origin [kg m²].

    These ten numbers are linear in the mass distribution, so inertias of one frame simply add.
    ``missing`` says, a line each, which parts are not known and therefore not in the numbers.
    """

    mass: float
    first_moment: Array
    about_origin: Array
    missing: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "first_moment", _frozen(self.first_moment, (3,)))
        object.__setattr__(self, "about_origin", _frozen(self.about_origin, (3, 3)))

    @staticmethod
    def zero() -> Inertia:
        """Return the inertia of nothing."""
        return Inertia(0.0, np.zeros(3), np.zeros((3, 3)))

    @staticmethod
    def from_center_of_mass(mass: float, com: ArrayLike, about_com: ArrayLike) -> Inertia:
        """Inertia from the mass, the centre of mass [m] and the tensor about it [kg m²]."""
        c = np.array(com, dtype=float)
        steiner = mass * (product(c, c) * np.eye(3) - np.outer(c, c))
        return Inertia(mass, mass * c, np.array(about_com, dtype=float) + steiner)

    def __add__(self, other: Inertia) -> Inertia:
        return Inertia(
            self.mass + other.mass,
            self.first_moment + other.first_moment,
            self.about_origin + other.about_origin,
            self.missing + other.missing,
        )

    def __sub__(self, other: Inertia) -> Inertia:
        return Inertia(
            self.mass - other.mass,
            self.first_moment - other.first_moment,
            self.about_origin - other.about_origin,
            self.missing,
        )

    def seen_from(self, placement: Placement) -> Inertia:
        """Return the same mass distribution in the parent frame of ``placement``."""
        R, p = placement.rotation, placement.translation
        h = product(R, self.first_moment)
        shift = (2 * product(p, h) + self.mass * product(p, p)) * np.eye(3)
        turned = product(product(R, self.about_origin), R.T)
        shift -= np.outer(p, h) + np.outer(h, p) + self.mass * np.outer(p, p)
        return Inertia(self.mass, h + self.mass * p, turned + shift, self.missing)
