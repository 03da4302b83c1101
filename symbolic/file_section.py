# SPDX-License-Identifier: BSD-3-Clause
"""What tables of TOML files that users write are made of, checked field by field."""

from __future__ import annotations

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

Finite = Annotated[float, Field(allow_inf_nan=False)]
Positive = Annotated[float, Field(gt=0, allow_inf_nan=False)]
NotNegative = Annotated[float, Field(ge=0, allow_inf_nan=False)]
Vector3 = Annotated[list[Finite], Field(min_length=3, max_length=3)]


class FileSection(BaseModel):
    """A table; what it does not know is an error, and numbers are not read from text."""

    model_config = ConfigDict(extra="forbid", frozen=True, strict=True)
