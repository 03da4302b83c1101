# SPDX-License-Identifier: BSD-3-Clause
"""Equality by content: what was read or built twice is one and the same to a cache."""

from __future__ import annotations

import hashlib
from collections.abc import Iterator, Mapping
from dataclasses import fields, is_dataclass
from enum import Enum
from functools import cached_property
from typing import Any

import casadi as ca
import numpy as np


class ByContent:
    """Frozen data that equals any other of its class with the same names and numbers, to the bit.

    Dataclasses that hold arrays or CasADi's matrices inherit this, with ``eq=False``: neither has
    an equality that could be used. A symbol equals itself only, whatever its name.
    """

    @cached_property
    def content(self) -> bytes:
        """A hash of the class and all fields; good within this process, as symbols are."""
        digest = hashlib.sha256()
        for part in _parts(self, outermost=True):
            digest.update(b"%d:" % len(part) + part)  # lengths keep neighbours apart
        return digest.digest()

    def __eq__(self, other: object) -> bool:
        if self is other:
            return True
        if not isinstance(other, type(self)):
            return NotImplemented
        return self.content == other.content

    def __hash__(self) -> int:
        return hash(self.content)

    def __getstate__(self) -> dict[str, Any]:
        """Leave the hash behind: another process has other symbols."""
        return {name: value for name, value in vars(self).items() if name != "content"}


def _parts(value: Any, *, outermost: bool = False) -> Iterator[bytes]:
    """Yield a value's content, each kind of value with a head of its own."""
    if isinstance(value, ByContent) and not outermost:
        yield value.content
    elif is_dataclass(value) and not isinstance(value, type):
        yield type(value).__qualname__.encode()
        for field in fields(value):
            yield from _parts(getattr(value, field.name))
    elif isinstance(value, Mapping):
        yield from _parts(tuple(value.items()))
    elif isinstance(value, tuple | list):
        yield b"(%d" % len(value)
        for item in value:
            yield from _parts(item)
    else:
        yield _leaf(value)


def _leaf(value: Any) -> bytes:
    if isinstance(value, np.ndarray):
        return f"array {value.shape} {value.dtype} ".encode() + value.tobytes()
    if isinstance(value, ca.SX):
        entries = [
            float(x) if x.is_constant() else x.element_hash()
            for x in (value.nz[i] for i in range(value.nnz()))
        ]
        return f"SX {value.shape} {value.sparsity().find()} {entries}".encode()
    if isinstance(value, ca.MX):
        return f"MX {value.shape} {hash(value)}".encode()
    if isinstance(value, ca.DM):
        return f"DM {value.shape} {value.sparsity().find()} {value.nonzeros()}".encode()
    if value is None or isinstance(value, str | int | float | Enum | np.generic):
        return repr(value).encode()
    raise TypeError(f"{type(value).__name__} has no content that could be compared")
