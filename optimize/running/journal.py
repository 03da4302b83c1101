# SPDX-License-Identifier: BSD-3-Clause
"""Results of jobs on disk as they arrive, so that a run that was ended goes on where it was.

A journal is a text file with one job a line: what it was, by the digest of all that went into it,
and what came out. The same study asks for the same jobs again; those that are there are not run.
"""

from __future__ import annotations

import hashlib
import json
import os
import threading
from collections.abc import Callable
from concurrent.futures import Executor, Future
from dataclasses import fields, is_dataclass
from enum import Enum
from importlib.metadata import version
from pathlib import Path
from typing import Any

import numpy as np

from softimpact.symbolic import InvalidValue

from ..robust.screening import Screened
from ..search.ipopt import Found
from ..search.solve import Outcome
from .workers import works_elsewhere

KINDS = {kind.__name__: kind for kind in (Found, Outcome, Screened)}
"""Results that a journal can hold, beside lists of them."""


class Journal(Executor):
    """An executor that writes what jobs find, and knows what earlier ones found.

    Attributes:
        known: number of results that were there at the start.
        used: number of those that were asked for again.
        recorded: number of results that were added.
    """

    def __init__(self, path: Path, inner: Executor, *, resume: bool) -> None:
        """Open a journal.

        Args:
            path: of the file; made if there is none.
            inner: where jobs run.
            resume: whether to keep what is there; else it is emptied.

        Raises:
            InvalidValue: the file cannot be read or written, or is no journal.
        """
        self._inner, self._lock = inner, threading.Lock()
        self._found = _read(path) if resume and path.exists() else {}
        self.known, self.used, self.recorded = len(self._found), 0, 0
        try:
            path.parent.mkdir(parents=True, exist_ok=True)
            self._file = path.open("w", encoding="utf-8")
            self._write({"journal": version("softimpact")})
            for key, result in self._found.items():  # without a last line that was cut off
                self._write({"job": key, "result": result})
        except OSError as error:
            raise InvalidValue(str(path), f"cannot be written: {error}") from None

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Run a job, unless its result is known."""
        key = _digest(fn.__qualname__, args, sorted(kwargs.items()))
        if key in self._found:
            self.used += 1
            done: Future[Any] = Future()
            done.set_result(_decoded(self._found[key]))
            return done
        job = self._inner.submit(fn, *args, **kwargs)
        job.add_done_callback(lambda ended: self._record(key, ended))
        return job

    @property
    def elsewhere(self) -> bool:
        """Whether jobs run on other machines."""
        return works_elsewhere(self._inner)

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Close the file; the executor inside stays open."""
        with self._lock:
            self._file.close()

    def _record(self, key: str, job: Future[Any]) -> None:
        if job.cancelled() or job.exception() is not None or job.result() is None:
            return
        with self._lock:
            if not self._file.closed:
                self._write({"job": key, "result": _encoded(job.result())})
                self.recorded += 1

    def _write(self, line: dict[str, Any]) -> None:
        self._file.write(json.dumps(line) + "\n")
        self._file.flush()
        os.fsync(self._file.fileno())


def _read(path: Path) -> dict[str, Any]:
    """Return results by job; a last line that was cut off is left out."""
    try:
        first, *lines = path.read_text(encoding="utf-8").splitlines() or [""]
        header = json.loads(first or "{}")
    except (OSError, ValueError) as error:
        raise InvalidValue(str(path), f"is no journal of an earlier run: {error}") from None
    if not isinstance(header, dict) or "journal" not in header:
        raise InvalidValue(str(path), "is no journal of an earlier run")
    found = {}
    for line in lines:
        try:
            entry = json.loads(line)
            _decoded(entry["result"])
            found[entry["job"]] = entry["result"]
        except (ValueError, KeyError, TypeError):
            continue
    return found if header["journal"] == version("softimpact") else {}


def _encoded(value: Any) -> Any:
    if is_dataclass(value) and not isinstance(value, type):
        parts = {field.name: _encoded(getattr(value, field.name)) for field in fields(value)}
        return {"kind": type(value).__name__, **parts}
    if isinstance(value, np.ndarray):
        return {"kind": "array", "shape": list(value.shape), "values": value.ravel().tolist()}
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, (list, tuple)):
        return [_encoded(item) for item in value]
    return value


def _decoded(value: Any) -> Any:
    if isinstance(value, list):
        return [_decoded(item) for item in value]
    if not isinstance(value, dict):
        return value
    parts = {name: _decoded(part) for name, part in value.items() if name != "kind"}
    if value["kind"] == "array":
        return np.array(parts["values"], dtype=float).reshape(parts["shape"])
    return KINDS[value["kind"]](**parts)


def _digest(*values: Any) -> str:
    """Return what tells two jobs apart, the same in every process."""
    found = hashlib.sha256()
    for value in values:
        _feed(found.update, value)
    return found.hexdigest()


def _feed(feed: Callable[[bytes], None], value: Any) -> None:
    if is_dataclass(value) and not isinstance(value, type):
        feed(type(value).__name__.encode())
        for field in fields(value):
            _feed(feed, getattr(value, field.name))
    elif isinstance(value, np.ndarray):
        feed(repr(value.shape).encode() + np.ascontiguousarray(value).tobytes())
    elif isinstance(value, (list, tuple)):
        feed(f"({len(value)}".encode())
        for item in value:
            _feed(feed, item)
    elif isinstance(value, dict):
        _feed(feed, sorted(value.items()))
    elif isinstance(value, (Path, Enum)):  # a library by its name, the digest of what it does
        feed(value.name.encode())
    else:
        feed(f"{type(value).__name__} {value!r};".encode())
