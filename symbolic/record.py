# SPDX-License-Identifier: BSD-3-Clause
"""What all results can do: become a dictionary, a table, or a drawing."""

from __future__ import annotations

import importlib
import math
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from html import escape
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from .errors import SoftImpactError

Row = dict[str, Any]
"""A line of a table: what stands in each column."""


class NeedsPackage(SoftImpactError):
    """Something that only works with a package that softimpact does not depend on."""

    def __init__(self, what: str, package: str) -> None:
        self.package = package
        super().__init__(f"{what} needs {package}: pip install {package}")


class Record:
    """A result.

    Attributes:
        UNSHOWN: fields that ``to_dict`` leaves out: what was asked, which is not in numbers.
    """

    UNSHOWN: ClassVar[tuple[str, ...]] = ()

    def to_dict(self) -> dict[str, Any]:
        """Return all numbers as JSON has them: lists, None for what is not finite."""
        return {
            field.name: plain(getattr(self, field.name))
            for field in fields(self)  # type: ignore[arg-type]
            if field.name not in self.UNSHOWN
        }

    def rows(self) -> list[Row]:
        """Return the result as a table's lines: one with its plain numbers, if not several."""
        kinds = (float, int, str, bool)
        return [{k: v for k, v in self.to_dict().items() if v is None or isinstance(v, kinds)}]

    def to_frame(self) -> Any:
        """Return ``rows`` as a pandas data frame; raises NeedsPackage."""
        try:
            pandas = importlib.import_module("pandas")
        except ImportError:
            raise NeedsPackage("a data frame", "pandas") from None
        return pandas.DataFrame(self.rows())

    def _repr_html_(self) -> str:
        """Return ``rows`` as a table, which notebooks show."""
        rows = self.rows()
        names = list(dict.fromkeys(name for row in rows for name in row))
        heads = "".join(f"<th>{escape(name)}</th>" for name in names)
        lines = "".join(
            f"<tr>{''.join(f'<td>{_shown(row.get(name))}</td>' for name in names)}</tr>"
            for row in rows
        )
        title = f"<caption>{escape(type(self).__name__)}</caption>"
        return f"<table>{title}<thead><tr>{heads}</tr></thead><tbody>{lines}</tbody></table>"

    def plot(self, axes: Any = None) -> Any:
        """Draw the result, see ``softimpact.plots``.

        Args:
            axes: Matplotlib's, to draw into; None makes a figure of its own.

        Returns:
            The axes; ``axes.figure.savefig(path)`` writes the figure.
        """
        # by name, as nothing here may depend on what draws
        return importlib.import_module("softimpact.plots").plot(self, axes)


def _shown(cell: Any) -> str:
    """Return a cell of HTML: numbers to four digits, a dash for what does not apply."""
    if cell is None:
        return "–"
    return f"{cell:.4g}" if isinstance(cell, float) else escape(str(cell))


def plain(value: Any) -> Any:
    """Return a value as JSON has it: dataclasses and arrays opened, NaN and infinity as null."""
    # most of what long tables hold is a number or a name
    return _scalar(value) if type(value) in (float, str) else _opened(value)


def _opened(value: Any) -> Any:
    if isinstance(value, Record):
        return value.to_dict()
    if is_dataclass(value) and not isinstance(value, type):
        return {field.name: plain(getattr(value, field.name)) for field in fields(value)}
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if hasattr(value, "full"):  # a CasADi matrix of numbers
        value = value.full().ravel() if 1 in value.shape else value.full()
    if isinstance(value, (np.ndarray, np.generic)):
        finite = value.dtype.kind == "f" and bool(np.isfinite(value).all())
        return value.tolist() if finite else plain(value.tolist())
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    return _scalar(value)


def _scalar(value: Any) -> Any:
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    return str(value) if isinstance(value, Path) else value
