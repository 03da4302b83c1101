# SPDX-License-Identifier: BSD-3-Clause
"""What a package's header declares, for everything that calls it from other languages.

The header is the one place that says what there is; this reads it back. It knows the C that our
templates write, not C at large, and refuses what it does not know.
"""

from __future__ import annotations

import json
import math
import re
import zlib
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

from ..errors import UnknownDeclaration

POINTER = 8
"""Size of an address where a library for Python runs [bytes]; WebAssembly has ``WASM_POINTER``."""

WASM_POINTER = 4

SIZES = {"int": 4, "unsigned int": 4, "unsigned char": 1, "double": 8, "float": 4}
"""Of the types that headers use [bytes], on every machine that has 32-bit int."""

NUMPY = {"int": "i4", "unsigned int": "u4", "unsigned char": "u1", "double": "f8", "float": "f4"}
"""The same in NumPy."""


@dataclass(frozen=True)
class CVariable:
    """A member of a struct, an argument, or a table.

    Attributes:
        name: in C.
        type: ``real``, one of ``SIZES``, or a struct's name without the prefix.
        shape: of an array; a pointer to many has a first size of None.
        pointer: whether an address is passed, or kept in a struct.
        written: whether the function writes there.
        comment: behind it, without the marks.
    """

    name: str
    type: str
    shape: tuple[int | None, ...] = ()
    pointer: bool = False
    written: bool = False
    comment: str = ""


@dataclass(frozen=True)
class Struct:
    """A struct; its name is without the prefix."""

    name: str
    fields: tuple[CVariable, ...]


@dataclass(frozen=True)
class Entry:
    """A function; its name is without the prefix.

    Attributes:
        name: in C, without the prefix.
        returns: ``int``, mostly a status, or ``const char *``.
        arguments: in their order.
        comment: above it.
    """

    name: str
    returns: str
    arguments: tuple[CVariable, ...]
    comment: str


@dataclass(frozen=True)
class Interface:
    """What a header declares.

    Attributes:
        prefix: of all names.
        structs: by name.
        entries: functions by name.
        enums: members of each enumeration, all without the prefix.
        numbers: macros that stand for a whole number, without the prefix.
        texts: macros that stand for a text, likewise.
        tables: constant arrays by name.
        layout: what the header says of its own layout, without the size of ``real``; None where no
            function takes parameters.
    """

    prefix: str
    structs: Mapping[str, Struct]
    entries: Mapping[str, Entry]
    enums: Mapping[str, Mapping[str, int]]
    numbers: Mapping[str, int]
    texts: Mapping[str, str]
    tables: Mapping[str, CVariable]
    layout: int | None

    def layout_in(self, real: str) -> int:
        """Return the number by which a library knows its own parameter structs."""
        return (self.layout or 0) + SIZES[real]

    def fingerprint(self) -> int:
        """Return a number that changes with whatever a caller's compiler takes from the header.

        Its last four bits are 0, for the size of ``real``.
        """
        structs = [
            [s.name, *([f.name, f.type, f.shape, f.pointer] for f in s.fields)]
            for s in self.structs.values()
        ]
        entries = [
            [e.name, e.returns, *([a.type, a.shape, a.pointer] for a in e.arguments)]
            for e in self.entries.values()
        ]
        enums = {name: dict(members) for name, members in self.enums.items()}
        return zlib.crc32(json.dumps([structs, entries, enums]).encode()) & 0xFFFFFFF0

    def dtype(self, struct: str, real: str) -> np.dtype[Any]:
        """Return a struct as NumPy holds it."""
        offsets, size = self.offsets(struct, real)
        fields = self.structs[struct].fields
        kinds = ["u8" if f.pointer else NUMPY[real if f.type == "real" else f.type] for f in fields]
        return np.dtype({
            "names": [f.name for f in fields],
            "formats": [(k, f.shape) if f.shape else k for k, f in zip(kinds, fields, strict=True)],
            "offsets": list(offsets.values()),
            "itemsize": size,
        })  # fmt: skip

    def offsets(self, struct: str, real: str, pointer: int = POINTER) -> tuple[dict[str, int], int]:
        """Return the offset of each field of a struct, and its size [bytes].

        Args:
            struct: its name.
            real: number type.
            pointer: size of an address.
        """
        offsets, at, widest = {}, 0, 1
        for field in self.structs[struct].fields:
            size = pointer if field.pointer else SIZES[real if field.type == "real" else field.type]
            at = -(-at // size) * size
            offsets[field.name] = at
            at += size * math.prod(n or 0 for n in field.shape)
            widest = max(widest, size)
        return offsets, -(-at // widest) * widest

    def to_dict(self) -> dict[str, Any]:
        """Return all of it as JSON holds it."""
        return asdict(self)


def read_interface(package: Path) -> Interface:
    """Return what the header of a package's folder declares.

    Raises:
        UnknownDeclaration: it holds what our templates do not write.
    """
    header = next(
        (p for p in sorted(package.glob("include/*.h")) if not p.stem.endswith("_config")), None
    )
    if header is None:
        raise UnknownDeclaration(str(package), "a folder without a header in include/")
    return interface_of(header.read_text(encoding="utf-8"), header.stem)


def interface_of(header: str, prefix: str) -> Interface:
    """Return what the text of a header declares; ``prefix`` is that of its names."""
    return _Header(header, prefix).read()


ENUM = re.compile(r"typedef enum \{(.*?)\} (\w+);", re.DOTALL)
STRUCT = re.compile(r"typedef struct \{(.*?)\} (\w+);", re.DOTALL)
FUNCTION = re.compile(
    r"(?:/\*(?P<comment>(?:(?!\*/).)*)\*/\s*)?^(?P<returns>int|unsigned int|const char \*) ?"
    r"(?P<name>\w+)\((?P<arguments>[^;{]*)\);",
    re.DOTALL | re.MULTILINE,
)
TABLE = re.compile(r"^extern const (\w+) (\w+)((?:\[\w+\])+);", re.MULTILINE)
NUMBER = re.compile(r"^#define (\w+) (\d+|0x[0-9a-f]+)u?$", re.MULTILINE)
LAYOUT = re.compile(r"^#define \w+_LAYOUT \((0x[0-9a-f]+)u \+", re.MULTILINE)
TEXT = re.compile(r'^#define (\w+) (?:\\\n *)?"(.*)"$', re.MULTILINE)
MEMBER = re.compile(
    r"(?:const (\w+) \*|(\w+(?: \w+)*?) )(\w+)((?:\[\w*\])*);[ ]*(?:/\* (.*?) \*/)?", re.DOTALL
)
ARGUMENT = re.compile(r"(const )?(\w+(?: \w+)*?) (\*?)(\w+)((?:\[\w*\])*)$")


@dataclass(frozen=True)
class _Header:
    text: str
    prefix: str

    def read(self) -> Interface:
        numbers = {m[1]: int(m[2], 0) for m in NUMBER.finditer(self.text)}
        enums = {
            self._short(m[2]): {self._short(k): int(v) for k, v in self._members(m[1])}
            for m in ENUM.finditer(self.text)
        }
        structs = [self._struct(m[2], m[1], numbers) for m in STRUCT.finditer(self.text)]
        entries = [self._entry(m, numbers) for m in FUNCTION.finditer(self.text)]
        tables = [
            CVariable(self._short(m[2]), self._type(m[1]), self._shape(m[3], numbers))
            for m in TABLE.finditer(self.text)
        ]
        layout = LAYOUT.search(self.text)
        return Interface(
            prefix=self.prefix,
            structs={s.name: s for s in structs},
            entries={e.name: e for e in entries},
            enums=enums,
            numbers={self._short(k): v for k, v in numbers.items()},
            texts={self._short(m[1]): m[2] for m in TEXT.finditer(self.text)},
            tables={t.name: t for t in tables},
            layout=int(layout[1], 0) if layout else None,
        )

    def _short(self, name: str) -> str:
        for prefix in (self.prefix, self.prefix.upper()):
            if name.startswith(f"{prefix}_"):
                return name.removeprefix(f"{prefix}_")
        raise UnknownDeclaration(self.prefix, name)

    def _type(self, name: str) -> str:
        return name if name in SIZES else self._short(name)

    def _shape(self, brackets: str, numbers: Mapping[str, int]) -> tuple[int | None, ...]:
        sizes = re.findall(r"\[(\w*)\]", brackets)
        return tuple((numbers.get(s) or int(s)) if s else None for s in sizes)

    def _members(self, body: str) -> Iterator[tuple[str, str]]:
        plain = re.sub(r"/\*.*?\*/", "", body, flags=re.DOTALL)
        for member in filter(None, (part.strip() for part in plain.split(","))):
            name, _, value = member.partition(" = ")
            yield name, value

    def _struct(self, name: str, body: str, numbers: Mapping[str, int]) -> Struct:
        fields = [
            CVariable(
                m[3],
                self._type(m[1] or m[2]),
                self._shape(m[4], numbers),
                bool(m[1]),
                comment=m[5] or "",
            )
            for m in MEMBER.finditer(body)
        ]
        if re.sub(r"/\*.*?\*/", "", MEMBER.sub("", body), flags=re.DOTALL).strip():
            raise UnknownDeclaration(self.prefix, body)
        return Struct(self._short(name), tuple(fields))

    def _entry(self, found: re.Match[str], numbers: Mapping[str, int]) -> Entry:
        arguments = []
        for text in re.split(r",\s*", found["arguments"].strip()):
            if text == "void":
                continue
            m = ARGUMENT.match(text)
            if m is None:
                raise UnknownDeclaration(self.prefix, text)
            pointer = bool(m[3] or m[5])
            arguments.append(
                CVariable(m[4], self._type(m[2]), self._shape(m[5], numbers), pointer,
                         pointer and not m[1])
            )  # fmt: skip
        comment = re.sub(r"^ \* ?", "", found["comment"] or "", flags=re.MULTILINE).strip()
        return Entry(self._short(found["name"]), found["returns"], tuple(arguments), comment)
