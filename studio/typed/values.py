# SPDX-License-Identifier: BSD-3-Clause
"""Numbers, vectors and names as they are typed on the command line."""

from __future__ import annotations

import json
import math
import re
import tomllib
from pathlib import Path
from typing import Any, Literal, get_args, get_origin

from softimpact.symbolic import InvalidValue, Robot, UnknownName
from softimpact.symbolic.file_section import why_unreadable
from softimpact.symbolic.impact.drives import PerJoint

LARGEST = 1e30
"""Typed numbers beyond this are slips; their powers would overflow."""


def vector(field: str, text: str, length: int | None = None) -> list[float]:
    """Return finite numbers typed as a JSON list, brackets or not; raises InvalidValue.

    Args:
        field: name of the option, for messages.
        text: as typed.
        length: that it must have, if any.
    """
    values = _parsed(field, text)
    if isinstance(values, int | float) and not isinstance(values, bool):
        values = [values]  # of an arm with one joint
    if not isinstance(values, list):
        raise InvalidValue(field, f"needs a JSON list of numbers such as [0, 0.5], not '{text}'")
    numbers = [_number(field, value, f"entry {i + 1}") for i, value in enumerate(values)]
    for i, number in enumerate(numbers):
        if not math.isfinite(number):
            raise InvalidValue(field, f"entry {i + 1} must be finite, but is {number:g}")
    if length is not None and len(numbers) != length:
        raise InvalidValue(field, f"has {len(numbers)} values, but {length} are needed")
    return numbers


def per_joint(field: str, text: str) -> PerJoint:
    """Return one number for all joints or a list of them; ``inf`` counts as a number."""
    values = _parsed(field, text)
    if isinstance(values, list):
        return [_number(field, value, f"entry {i + 1}") for i, value in enumerate(values)]
    return _number(field, values, "the value")


def rotor_inertia(robot: Robot, text: str) -> PerJoint:
    """Return rotor inertias typed as a number, a list, or the name of one of the robot's sets."""
    if text.strip().replace("-", "_").isidentifier() and not _is_number(text):
        return robot.rotor_inertia_set(text.strip())
    return per_joint("rotor_inertia", text)


Load = tuple[float, list[float], list[float] | None]
"""Mass [kg], centre [m] and inertia xx, yy, zz, xy, xz, yz about it [kg m²] (None: a point)."""


def payload(text: str) -> Load:
    """Return a payload typed as ``MASS`` or ``MASS@x,y,z``; raises InvalidValue."""
    mass, at, place = text.partition("@")
    if not _is_number(mass):
        raise InvalidValue("payload", f"needs MASS or MASS@x,y,z (kg, m), not '{text}'")
    return (
        _number("payload", float(mass), "the mass"),
        vector("payload", place, 3) if at else [0.0, 0.0, 0.0],
        None,
    )


def tool(path: str) -> Load:
    """Return a tool from a TOML file: ``mass``, ``com``, ``inertia``; raises InvalidValue."""
    try:
        entries = tomllib.loads(Path(path).read_text("utf-8-sig"))
    except (OSError, ValueError) as error:
        raise InvalidValue(f"tool: {path}", why_unreadable(error)) from None
    unknown = sorted(set(entries) - {"mass", "com", "inertia"})
    if unknown:
        raise InvalidValue(f"tool: {path}: {unknown[0]}", "is unknown; mass, com, inertia are not")
    if "mass" not in entries:
        raise InvalidValue(f"tool: {path}", "has no mass; write mass = ... (kg)")
    mass = _number(f"tool: {path}: mass", entries["mass"], "the value")
    com = entries.get("com", [0.0, 0.0, 0.0])
    inertia = entries.get("inertia")
    for field, value, size in (("com", com, 3), ("inertia", inertia, 6)):
        if value is not None and (not isinstance(value, list) or len(value) != size):
            raise InvalidValue(f"tool: {path}: {field}", f"needs a list of {size} numbers")

    def numbers(field: str, value: list[object]) -> list[float]:
        return [_number(f"tool: {path}: {field}", x, f"entry {i + 1}") for i, x in enumerate(value)]

    return mass, numbers("com", com), None if inertia is None else numbers("inertia", inertia)


def named_numbers(field: str, text: str) -> dict[str, float]:
    """Return numbers typed as ``NAME=X,NAME=Y``; raises InvalidValue."""
    found: dict[str, float] = {}
    for part in text.split(","):
        name, is_given, number = part.strip().rpartition("=")
        if not is_given or not _is_number(number):
            raise InvalidValue(field, f"needs NAME=X,NAME=Y, not '{text}'")
        if name in found:
            raise InvalidValue(field, f"names '{name}' twice")
        found[name] = float(number)
    return found


def one_of(what: str, name: str, names: Any) -> Any:
    """Return a name that a ``Literal`` type allows; raises UnknownName, which lists those."""
    if get_origin(names) is not Literal:  # no checker sees what comes in and goes out here
        raise TypeError(f"{names} is no Literal")
    if name not in get_args(names):
        raise UnknownName(what, name, get_args(names))
    return name


def _parsed(field: str, text: str) -> object:
    if _is_number(text):
        return float(text)
    listed = f"[{text}]" if "," in text and "[" not in text else text  # as people type it, too
    try:
        return json.loads(re.sub(r"\binf\b", "Infinity", listed))  # which JSON lacks, Python's has
    except (ValueError, RecursionError):
        entries = listed.strip().removeprefix("[").removesuffix("]").split(",")
        if listed.strip().endswith("]") and all(map(_is_number, entries)):
            return [float(entry) for entry in entries]  # .5 and 1., which JSON lacks, too
        raise InvalidValue(
            field, f"needs a number or a JSON list such as [0, 0.5], not '{text}'"
        ) from None


def _is_number(text: str) -> bool:
    if "_" in text:  # Python's 1_0 is 10; people may mean 1.0
        return False
    try:
        float(text)
    except ValueError:
        return False
    return True


def _number(field: str, value: object, which: str) -> float:
    if isinstance(value, str) and value.strip().lower() in ("inf", "infinity"):
        return math.inf
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise InvalidValue(field, f"{which} is not a number: {json.dumps(value)}")
    if LARGEST < abs(value) < math.inf:
        raise InvalidValue(field, f"{which} is too large to compute with")
    return float(value)
