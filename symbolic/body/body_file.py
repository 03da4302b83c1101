# SPDX-License-Identifier: BSD-3-Clause
"""Bodies and covers that users describe in TOML files, checked field by field."""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import Any, TypeVar

from pydantic import ValidationError

from ..errors import InvalidValue, UnknownName, did_you_mean
from ..file_section import FileSection, NotNegative, Positive, why_unreadable
from .bodies import BODIES, body_region
from .contact import naming
from .laws import Law, in_series
from .laws.named import law_from
from .pads import PADS
from .regions import NEWTON_PER_CM2, TISSUE_DAMPING, BodyRegion

_AnySection = TypeVar("_AnySection", bound=FileSection)


class LimitsSection(FileSection):
    """What the body may bear; what is left out is its region's."""

    permitted: bool | None = None
    force_quasi_static: Positive | None = None
    force_transient: Positive | None = None
    pressure_quasi_static: Positive | None = None
    pressure_transient: Positive | None = None
    energy: Positive | None = None


class BodyFile(FileSection):
    """A body, as written: SI units, but pressures in N/cm² as the standard has them."""

    name: str
    title: str = ""
    region: str | None = None
    stiffness: Positive | None = None
    damping: NotNegative | None = None
    effective_mass: Positive | None = None
    plate_mass: NotNegative | None = None
    pad: str | None = None
    skin: Any = None
    limits: LimitsSection = LimitsSection()


class CoverFile(FileSection):
    """A cover, as written: one law, or several one behind the other."""

    name: str = ""
    law: Any


def load_body(path: str | Path) -> BodyRegion:
    """Return the body that a file describes.

    A ``region`` (or area, or device) gives whatever the file leaves out. Without one, stiffness and
    effective mass are needed, and limits that are left out do not exist.

    Raises:
        InvalidValue: names file and field.
    """
    file = _read(Path(path), BodyFile)
    with _in_file(path):
        if file.pad is not None and file.skin is not None:
            raise InvalidValue("skin", "excludes 'pad'")
        base = _base(file) if file.region is None else _region(file.region)
        given: dict[str, Any] = {
            "stiffness": file.stiffness,
            "damping": file.damping,
            "effective_mass": file.effective_mass,
            "plate_mass": file.plate_mass,
            "skin": _skin(file),
        }
        changed = {field: value for field, value in given.items() if value is not None}
        body = replace(base, name=file.name, title=file.title or file.name, **changed)
        if file.limits.permitted and not base.permitted:
            raise InvalidValue("limits.permitted", f"contact with '{base.name}' is never permitted")
        return replace(body, **_limits(file.limits))


def load_cover(source: str | Path) -> Law:
    """Return the law of a cover: a pad by name, or what a file describes.

    Raises:
        InvalidValue: names file and field.
    """
    if str(source) in PADS:
        return PADS[str(source)].law
    file = _read(Path(source), CoverFile)
    with _in_file(source):
        return _law("law", file.law)


def _base(file: BodyFile) -> BodyRegion:
    for field in ("stiffness", "effective_mass"):
        if getattr(file, field) is None:
            raise InvalidValue(field, "missing: give it, or a 'region' to take it from")
    assert file.stiffness is not None
    assert file.effective_mass is not None
    return BodyRegion(
        file.name, "", file.stiffness, file.effective_mass, math.inf, None, TISSUE_DAMPING
    )


def _skin(file: BodyFile) -> Law | None:
    if file.pad is not None:
        if file.pad not in PADS:
            raise InvalidValue("pad", str(UnknownName("pad", file.pad, PADS)))
        return PADS[file.pad].law
    return None if file.skin is None else _law("skin", file.skin)


def _limits(given: LimitsSection) -> dict[str, Any]:
    def pascal(pressure: float | None) -> float | None:
        return None if pressure is None else pressure * NEWTON_PER_CM2

    named = {
        "permitted": given.permitted,
        "quasi_static_limit": given.force_quasi_static,
        "transient_limit": given.force_transient,
        "quasi_static_pressure": pascal(given.pressure_quasi_static),
        "transient_pressure": pascal(given.pressure_transient),
        "energy_limit": given.energy,
    }
    return {field: value for field, value in named.items() if value is not None}


def _law(field: str, entries: object) -> Law:
    parts = entries if isinstance(entries, list) else [entries]
    if not parts or not all(isinstance(part, dict) for part in parts):
        raise InvalidValue(field, f"must be a table, [{field}], or several, [[{field}]]")
    laws = []
    for i, part in enumerate(parts):
        with naming(f"{field}[{i}]" if isinstance(entries, list) else field):
            laws.append(law_from(part))
    return in_series(*laws)


def _region(name: str) -> BodyRegion:
    try:
        return body_region(name)
    except UnknownName as error:
        raise InvalidValue("region", str(error)) from None


@contextmanager
def _in_file(path: str | Path) -> Iterator[None]:
    """Let errors name the file."""
    try:
        yield
    except InvalidValue as error:
        raise InvalidValue(f"{path}: {error.field}", error.reason) from None


def _missing(name: str, section: type[FileSection]) -> str:
    """Return what to do about a file that is not there."""
    if section is CoverFile:
        return f"no such file, nor a pad ({', '.join(PADS)}){did_you_mean(name, PADS)}"
    if name in BODIES:
        return "no such file, but a region, area or device: it goes by --region"
    return "no such file; a body is described in TOML"


def _read(path: Path, section: type[_AnySection]) -> _AnySection:
    try:
        return section.model_validate(tomllib.loads(path.read_text(encoding="utf-8-sig")))
    except FileNotFoundError:
        raise InvalidValue(str(path), _missing(str(path), section)) from None
    except ValidationError as error:
        field, _, reason = why_unreadable(error).partition(": ")
        raise InvalidValue(f"{path}: {field}", reason) from None
    except (OSError, ValueError) as error:
        raise InvalidValue(str(path), why_unreadable(error)) from None
