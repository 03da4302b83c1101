# SPDX-License-Identifier: BSD-3-Clause
"""Bounds, variables and objectives are found where they lie: a new one is a new file."""

from __future__ import annotations

from dataclasses import fields as dataclass_fields
from functools import lru_cache
from importlib import import_module
from pkgutil import iter_modules
from types import ModuleType
from typing import Any

from pydantic import TypeAdapter, ValidationError

from softimpact.symbolic import InvalidValue, UnknownName
from softimpact.symbolic.file_section import why_wrong


def kinds_in(package: ModuleType, base: type) -> dict[str, type]:
    """Return the classes with a ``kind`` of their own in a package's modules, by it."""
    found: dict[str, type] = {}
    for module in iter_modules(package.__path__):
        content = vars(import_module(f"{package.__name__}.{module.name}"))
        for value in content.values():
            kind = str(getattr(value, "kind", ""))
            if isinstance(value, type) and base in value.__mro__ and kind:
                found[kind] = value
    return dict(sorted(found.items()))


def built(kinds: dict[str, type], what: str, kind: str, fields: Any) -> Any:
    """Return the dataclass of a kind with the fields of a file's table.

    Args:
        kinds: classes by kind.
        what: they are, for errors.
        kind: which one.
        fields: its table.

    Raises:
        InvalidValue: there is no such kind, or a field is missing, unknown or wrong.
    """
    if kind not in kinds:
        raise InvalidValue(kind, str(UnknownName(what, kind, list(kinds))))
    if not isinstance(fields, dict):
        raise InvalidValue(kind, f"must be a table, such as {kind} = {{ ... }}")
    known = [field.name for field in dataclass_fields(kinds[kind])]
    for name in fields:
        if name not in known:
            raise InvalidValue(f"{kind}.{name}", f"unknown; fields are: {', '.join(known)}")
    try:
        return _adapter(kinds[kind]).validate_python(fields)
    except ValidationError as error:
        first = error.errors()[0]
        path = [part for part in first["loc"] if part in known or isinstance(part, int)]
        place = ".".join([kind, *(str(part) for part in path)])
        raise InvalidValue(place, why_wrong(first)) from None


@lru_cache(maxsize=64)
def _adapter(kind: type) -> TypeAdapter[Any]:
    return TypeAdapter(kind)
