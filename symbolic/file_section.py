# SPDX-License-Identifier: BSD-3-Clause
"""What tables of TOML files that users write are made of, checked field by field."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import BaseModel, ConfigDict, Field, ValidationError

Finite = Annotated[float, Field(allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]
Vector3 = Annotated[list[Finite], Field(min_length=3, max_length=3)]


class FileSection(BaseModel):
    """A table; what it does not know is an error, and numbers are not read from text."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)


def why_unreadable(error: Exception) -> str:
    """Return why a file of a user's says nothing, in words of ours.

    Args:
        error: of opening it, of its letters, of TOML or JSON, or of what it must hold.
    """
    if isinstance(error, ValidationError):
        first = error.errors()[0]
        place = ".".join(str(part) for part in first["loc"])
        return f"{place}: {why_wrong(first)}" if place else why_wrong(first)
    if isinstance(error, OSError):
        return f"cannot be read: {error.strerror or error}"
    if isinstance(error, UnicodeDecodeError):
        return "cannot be read: it is no text file in UTF-8"
    if isinstance(error, tomllib.TOMLDecodeError):
        return f"not valid TOML: {error}"
    if isinstance(error, json.JSONDecodeError):
        return f"not valid JSON: {error}"
    return f"cannot be read: {error}"


def why_wrong(fault: Mapping[str, Any]) -> str:
    """Return what is wrong with a field, from one of pydantic's errors."""
    kind, message = fault["type"], str(fault["msg"])
    if kind == "missing":
        return "is missing"
    if kind == "model_type":
        return "must be a table of fields by name"
    if kind == "too_short":
        return f"needs {fault['ctx']['min_length']}, not {fault['ctx']['actual_length']}"
    return message.removeprefix("Value error, ").replace("Input should", "must")
