# SPDX-License-Identifier: BSD-3-Clause
"""Calls of a package's functions for the rows of arrays."""

from __future__ import annotations

import ctypes
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field
from functools import cached_property, partial
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from softimpact.symbolic import REGIONS, InvalidValue
from softimpact.symbolic.body.verdict import limits_of

from .build import PREFIX, Sources

if TYPE_CHECKING:
    from softimpact.codegen.bindings.interface import Entry, Interface, CVariable

Arrays = dict[str, NDArray[Any]]
"""Results by name, one row a call, and ``status``."""

CHUNK = 1024
"""Fewest rows of a closed form that are worth a thread of their own; of an impact one is."""

JUDGED = {
    "safe_speed": "allowed_speed_at",
    "safe_speed_at": "allowed_speed_at",
    "speed_factor": "allowed_factor",
}
"""Functions that take a limit, and those that take all limits of a region."""

TIP = 0
"""Number of the package's own contact point."""

IMPACT = "region"
"""Argument of functions that integrate in time, and its type."""


SPRUNG = ("joint_stiffness", "rotor_inertia")
"""Parameters that stand at zero where a robot's file does not tell them, and must be greater."""


@dataclass(frozen=True, eq=False)
class CompiledPackage:
    """A package's functions over arrays; each is a method by its C name without the prefix.

    ``q`` is N×n, or n for all rows; so are ``n`` (3), ``dq`` (n), other arguments and parameters
    by the names of the C struct's fields. A region is the name of one, with ``clamped``, or a
    mapping of the fields of the C struct, such as ``region_parameters`` gives of any contact. Where
    no ``limit`` is given, all that the region has must be kept: the least of force and energy in the
    first half second and, clamped, what may press later (``pressed`` says that this decides).
    ``motors``, ``point`` and ``frame`` may be names. Results are arrays of N rows by
    name, with ``status`` beside them; rows whose status is neither OK (0) nor BOUNDED (9) hold NaN,
    or -1 where numbers are whole.

    Attributes:
        sources: of the package, in the cache.
        threads: that calls are spread over.
    """

    sources: Sources
    threads: int
    _entries: dict[str, Callable[..., int]] = field(default_factory=dict, init=False, repr=False)
    _laws: dict[bytes, NDArray[Any]] = field(default_factory=dict, init=False, repr=False)

    def __getattr__(self, name: str) -> Any:
        """Return a method for a function of the package."""
        if not name.startswith("_") and name in self.functions:
            return partial(self._asked, self.interface.entries[name])
        raise AttributeError(f"the package has no function '{name}'")

    def __dir__(self) -> list[str]:
        """Return the names of all functions, too."""
        return [*super().__dir__(), *self.functions]

    @cached_property
    def interface(self) -> Interface:
        """What the package's header declares."""
        return self.sources.interface()

    @cached_property
    def functions(self) -> tuple[str, ...]:
        """Names of the functions."""
        paths = self.sources.folder.glob("batch/*.c")
        found = {path.stem for path in paths}
        return tuple(name for name in self.interface.entries if name in found)

    def status_text(self, status: int) -> str:
        """Return what a status means."""
        entry = self._common.batched_status_text
        entry.restype = ctypes.c_char_p
        return str(entry(ctypes.c_int(status)).decode())

    @cached_property
    def _common(self) -> ctypes.CDLL:
        return self.sources.library(f"src/{PREFIX}_common.c")

    @cached_property
    def _defaults(self) -> NDArray[Any]:
        """The parameter struct as the package fills it in."""
        p = np.zeros(1, self.interface.dtype("params", self.sources.real))
        layout = ctypes.c_uint(self.interface.layout_in(self.sources.real))
        self._common.batched_fill_params(ctypes.c_void_p(p.ctypes.data), layout)
        return p

    def _rows_of(self, name: str) -> Callable[..., int]:
        if name not in self._entries:
            self._entries[name] = self.sources.library(f"batch/{name}.c").batched_rows
        return self._entries[name]

    def _asked(self, entry: Entry, *given: Any, **options: Any) -> Arrays:
        """Call a function; of safe speeds without a limit, the one that judges all limits."""
        read = [a.name for a in entry.arguments if a.name not in (IMPACT, "p") and not a.written]
        named = {*read[: len(given)], *options}
        if entry.name not in JUDGED or "limit" in named:
            return self._call(entry, *given, **options)
        if entry.name == "safe_speed":
            if "point" in options:
                raise InvalidValue("point", "is read by safe_speed_at; safe_speed is the tip's")
            options["point"] = TIP
        known = dict(zip(read, given, strict=False))
        return self._call(self.interface.entries[JUDGED[entry.name]], **known, **options)

    def _call(self, entry: Entry, *given: Any, **options: Any) -> Arrays:
        named = set(options)
        inputs = self._inputs(entry, given, options)
        counts = [len(rows) for rows in inputs]
        count = max(counts) if all(counts) else 0
        for rows in inputs:
            if len(rows) not in (1, count):
                raise InvalidValue("rows", f"needs {count} rows or one everywhere, not {len(rows)}")
        (written,) = [a for a in entry.arguments if a.written]
        out, found = self._results(written, count)
        status = np.empty(count, dtype=np.int32)
        impact = any(a.name == IMPACT for a in entry.arguments)
        self._run(self._rows_of(entry.name), inputs, out, status, 1 if impact else CHUNK)
        if count > 0 and (status == self.interface.enums["status"]["OUT_OF_RANGE"]).all():
            self._name_unknown(named)
        return {**found, "status": status}

    def _name_unknown(self, given: set[str]) -> None:
        """Raise an error for a parameter that no row can do without and nobody has given."""
        fields = self._defaults.dtype.names or ()
        for name in SPRUNG:
            if name in fields and name not in given and not (self._defaults[name] > 0).all():
                raise InvalidValue(name, "is not known of this robot; give one value, or one a joint")

    def _inputs(
        self, entry: Entry, given: tuple[Any, ...], options: dict[str, Any]
    ) -> list[NDArray[Any]]:
        """Return an array of rows for each argument that a function reads."""
        read = [a for a in entry.arguments if not a.written]
        plain = [a for a in read if a.type not in self.interface.structs]
        if len(given) > len(plain):
            raise InvalidValue(entry.name, f"takes {', '.join(a.name for a in plain)}, and names")
        values = dict(zip((a.name for a in plain), given, strict=False))
        region = None
        if any(a.type == IMPACT for a in read):
            asked, clamped = options.pop(IMPACT, "chest"), options.pop("clamped", True)
            region = self._region(asked, clamped)
            if entry.name in JUDGED.values():
                region = _with_limits(asked, region)
        for a in plain:
            if a.name in options:
                values[a.name] = options.pop(a.name)
            if a.name not in values:
                raise InvalidValue(a.name, f"is needed by {entry.name}")
        inputs = []
        for a in read:
            if a.type == "params":
                inputs.append(self._parameters(options))
            elif a.type == IMPACT:
                assert region is not None
                inputs.append(region)
            else:
                inputs.append(self._rows(a, values[a.name]))
        if options:
            fields = (*(a.name for a in plain), *(self._defaults.dtype.names or ()))
            known = ", ".join(name for name in fields if name != "layout")
            raise InvalidValue(next(iter(options)), f"is nothing that {entry.name} reads: {known}")
        return inputs

    def _kind(self, type_: str) -> np.dtype[Any]:
        from softimpact.codegen.bindings.interface import NUMPY

        return np.dtype(NUMPY[self.sources.real if type_ == "real" else type_])

    def _rows(self, a: CVariable, values: Any) -> NDArray[Any]:
        width = int(np.prod([size or 1 for size in a.shape]))
        array = _numbers(a.name, self._unnamed(a.name, values), self._kind(a.type))
        rows = array.reshape(-1, 1) if width == 1 else np.atleast_2d(array)
        if rows.ndim != 2 or rows.shape[1] != width:
            raise InvalidValue(a.name, f"needs rows of {width} numbers, not {array.shape}")
        return rows

    def _region(self, region: str | Mapping[str, Any], clamped: bool) -> NDArray[Any]:
        row = np.zeros(1, self.interface.dtype("region", self.sources.real))
        if not isinstance(region, str):
            given = {**region, "clamped": region.get("clamped", clamped)}
            if given.get("law") is not None:
                given["law_points"], given["law"] = self._law(given["law"])
            else:
                given.pop("law", None)
            return _filled(row, given, "region")
        parts = {name.lower(): n for name, n in self.interface.enums["body_part"].items()}
        if region not in parts:
            raise InvalidValue("region", f"must be one of {', '.join(parts)}, not '{region}'")
        entry = self._common.batched_body_region
        entry(ctypes.c_int(parts[region]), ctypes.c_int(clamped), ctypes.c_void_p(row.ctypes.data))
        return row

    def _law(self, law: Any) -> tuple[int, int]:
        """Return how many points a law has, and their address, which holds as long as the package."""
        points = _numbers("law", law, self._kind("real"))
        width = len(self.interface.structs["law_point"].fields)
        if points.ndim != 2 or points.shape[1] != width:
            raise InvalidValue("law", f"needs rows of {width} numbers, not {points.shape}")
        kept = self._laws.setdefault(points.tobytes(), points)
        return len(kept), kept.ctypes.data

    def _parameters(self, options: dict[str, Any]) -> NDArray[Any]:
        """Return parameter structs, one or one a row; takes the fields out of ``options``."""
        names = [name for name in self._defaults.dtype.names or () if name in options]
        given = {name: options.pop(name) for name in names}
        if "motors" in given:
            given["motors"] = self._unnamed("motors", given["motors"])
        return _filled(self._defaults, given, "parameters")

    def _unnamed(self, field: str, values: Any) -> Any:
        """Return numbers of an enum (motors, point, frame) in place of names."""
        if field not in self.interface.enums or np.asarray(values).dtype.kind != "U":
            return values
        known = {name.removeprefix(f"{field.upper()}_").lower(): number
                 for name, number in self.interface.enums[field].items()}  # fmt: skip
        names = np.asarray(values)
        for name in names.flat:
            if name not in known:
                raise InvalidValue(field, f"must be one of {', '.join(known)}, not '{name}'")
        return np.reshape([known[str(name)] for name in names.flat], names.shape)

    def _results(self, written: CVariable, count: int) -> tuple[NDArray[Any], Arrays]:
        """Return room for results, and how it is seen by name."""
        if written.type not in self.interface.structs:
            sizes = [size or 1 for size in written.shape]
            kind = self._kind(written.type)
            plain = np.full((count, *sizes), np.nan if kind.kind == "f" else -1, dtype=kind)
            return plain, {written.name: plain}
        out = np.empty(count, self.interface.dtype(written.type, self.sources.real))
        for name in out.dtype.names or ():
            out[name] = np.nan if out[name].dtype.kind == "f" else -1
        return out, {name: out[name] for name in out.dtype.names or ()}

    def _run(
        self,
        rows: Callable[..., int],
        inputs: list[NDArray[Any]],
        out: NDArray[Any],
        status: NDArray[np.int32],
        chunk: int,
    ) -> None:
        """Call a function for all rows, in pieces that threads share."""
        strides = [0 if len(x) == 1 else x.strides[0] for x in inputs]
        steps = (ctypes.c_long * len(inputs))(*strides)

        def part(bounds: tuple[int, int]) -> None:
            first, last = bounds
            places = [x.ctypes.data + first * s for x, s in zip(inputs, strides, strict=True)]
            at = (ctypes.c_void_p * len(inputs))(*places)
            row = out.ctypes.data + first * out.strides[0]
            rows(ctypes.c_long(last - first), at, steps, ctypes.c_void_p(row),
                 ctypes.c_void_p(status.ctypes.data + first * status.itemsize))  # fmt: skip

        count = len(status)
        pieces = min(16 * self.threads, count // chunk) if self.threads > 1 else 1
        if pieces <= 1:
            part((0, count))
            return
        edges = np.linspace(0, count, pieces + 1).astype(int).tolist()
        with ThreadPoolExecutor(self.threads) as pool:
            list(pool.map(part, zip(edges[:-1], edges[1:], strict=True)))


def _with_limits(asked: str | Mapping[str, Any], region: NDArray[Any]) -> NDArray[Any]:
    """Return a region with the least of its limits of each kind, of force and energy [N]."""
    if isinstance(asked, str):
        limits = limits_of(REGIONS[asked], clamped=True)
        if not limits.permitted:
            raise InvalidValue("limit", f"'{asked}' may not be hit at all; give a limit [N]")
        assert limits.quasi_static is not None
        region["force_limit"] = limits.transient.force
        region["quasi_static_limit"] = limits.quasi_static.force
    elif not (region["force_limit"] > 0).all():
        raise InvalidValue("limit", "is needed: the region has no force_limit")
    elif not (region["quasi_static_limit"][region["clamped"] != 0] > 0).all():
        raise InvalidValue("limit", "is needed: the clamped region has no quasi_static_limit")
    return region


def _numbers(name: str, values: Any, kind: np.dtype[Any]) -> NDArray[Any]:
    """Return numbers of a kind; raises InvalidValue where they would not be those that were given."""
    try:
        array = np.asarray(values)
    except ValueError:  # rows of different lengths
        array = np.asarray(None)
    if array.dtype.kind not in "buif":
        raise InvalidValue(name, f"needs real numbers, in rows of one length, not {values!r:.60}")
    if kind.kind in "iu" and array.dtype.kind == "f" and not (array == np.rint(array)).all():
        raise InvalidValue(name, "needs whole numbers")
    return np.ascontiguousarray(array, dtype=kind) if array.ndim else np.asarray(array, dtype=kind)


def _filled(row: NDArray[Any], given: Mapping[str, Any], what: str) -> NDArray[Any]:
    """Return structs like a row with other fields, each one value or one a row."""
    fields: Mapping[str, Any] = row.dtype.fields or {}
    for name in given:
        if name not in fields:
            raise InvalidValue(name, f"is no field of {what}: {', '.join(fields)}")
    values = {name: _numbers(name, value, fields[name][0].base) for name, value in given.items()}
    depth = {name: len(fields[name][0].shape) for name in values}
    counts = [len(v) for name, v in values.items() if v.ndim > depth[name]]
    table = np.repeat(row, max(counts, default=1))
    for name, value in values.items():
        try:
            table[name] = value
        except ValueError:
            shape = (*table.shape, *fields[name][0].shape)
            raise InvalidValue(name, f"needs {shape} numbers, not {value.shape}") from None
    return table
