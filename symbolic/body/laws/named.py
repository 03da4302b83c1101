# SPDX-License-Identifier: BSD-3-Clause
"""Laws as they stand in a file: ``kind`` and the fields of its class."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import MISSING, fields
from importlib import import_module
from pkgutil import iter_modules
from typing import Any

from ...errors import InvalidValue
from .law import Law


def kinds() -> dict[str, type[Law]]:
    """Return every law that has a ``kind``: those of this folder, and of who imported it."""
    folder = __package__ or ""
    for module in iter_modules(import_module(folder).__path__):
        import_module(f"{folder}.{module.name}")
    return {law.kind: law for law in Law.__subclasses__() if law.kind}


def law_from(entries: Mapping[str, Any]) -> Law:
    """Return a law from its entries in a file.

    Raises:
        InvalidValue: names the field that is missing, unknown or impossible.
    """
    known, given = kinds(), dict(entries)
    kind = given.pop("kind", None)
    if kind not in known:
        raise InvalidValue("kind", f"must be one of {', '.join(sorted(known))}, not {kind!r}")
    expected = {f.name: f for f in fields(known[kind])}  # type: ignore[arg-type]
    for name, value in given.items():
        if name not in expected:
            raise InvalidValue(name, f"unknown; '{kind}' has {', '.join(expected)}")
        _check_numbers(name, value)
    for name, field in expected.items():
        if name not in given and field.default is MISSING:
            raise InvalidValue(name, f"missing; '{kind}' needs it")
    try:
        law = known[kind](**given)
        law.check()
    except TypeError:
        raise InvalidValue(kind, "one of its fields is no number, or no list") from None
    return law


def _check_numbers(name: str, value: object) -> None:
    for entry in value if isinstance(value, list) else [value]:
        if isinstance(entry, bool) or not isinstance(entry, int | float):
            raise InvalidValue(name, f"must hold numbers, not {entry!r}")
