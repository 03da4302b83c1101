# SPDX-License-Identifier: BSD-3-Clause
"""Jobs on a Dask cluster that is there already.

A program goes to each worker once, as serialised functions; the worker compiles it, or runs it in
CasADi's virtual machine if it has no compiler. Dask runs the jobs of a worker that is lost again.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, Future
from contextlib import contextmanager
from dataclasses import replace
from typing import Any

from softimpact.symbolic import InvalidValue

from ..search.nlp import Program

PATIENCE = 10.0
"""Time [s] in which a cluster must answer."""


class ClusterSilent(Exception):
    """No scheduler answers, or it has no worker."""

    exit_code = 3


class Cluster(Executor):
    """A cluster as an executor.

    Attributes:
        elsewhere: True: jobs run where this machine's compiled libraries may not be.
    """

    elsewhere = True

    def __init__(self, client: Any) -> None:
        """Use a ``distributed.Client``."""
        self._client = client
        self._executor = client.get_executor(pure=False, retries=3)
        self._shipped: dict[int, tuple[Program, Any]] = {}

    def submit(self, fn: Callable[..., Any], /, *args: Any, **kwargs: Any) -> Future[Any]:
        """Run a job on some worker; programs, alone or part of an argument, are sent once."""
        programs = [_program_of(arg) for arg in args]
        pairs = zip(args, programs, strict=True)
        bare = [arg if own is None else _with(arg, None) for arg, own in pairs]
        sent = [None if own is None else self._sent(own) for own in programs]
        job: Future[Any] = self._executor.submit(_run, fn, bare, kwargs, *sent)
        return job

    def _sent(self, program: Program) -> Any:
        """Return what stands for a program: each worker fetches it once."""
        if id(program) not in self._shipped:
            shipped = self._client.scatter(program, broadcast=True)
            self._shipped[id(program)] = program, shipped
        return self._shipped[id(program)][1]


def _program_of(argument: Any) -> Program | None:
    """Return the program that an argument is or has."""
    found = getattr(argument, "program", argument)
    return found if isinstance(found, Program) else None


def _with(argument: Any, program: Program | None) -> Any:
    """Return an argument with this program."""
    return replace(argument, program=program) if hasattr(argument, "program") else program


def _run(fn: Callable[..., Any], args: Sequence[Any], named: dict[str, Any], *programs: Any) -> Any:
    """Run a job, its programs put back; on a worker."""
    pairs = zip(args, programs, strict=True)
    return fn(*[arg if own is None else _with(arg, own) for arg, own in pairs], **named)


@contextmanager
def cluster(address: str) -> Iterator[Cluster]:
    """Connect to a cluster for a ``with`` block; it goes on running after it.

    Args:
        address: of its scheduler, such as ``tcp://host:8786``.

    Raises:
        InvalidValue: ``distributed`` is not installed, or that is no address.
        ClusterSilent: nobody answers there, or no worker has joined.
    """
    try:
        from distributed import Client  # noqa: PLC0415 - an extra
        from distributed.comm.addressing import get_address_host_port  # noqa: PLC0415
    except ImportError:
        raise InvalidValue("--dask", "needs 'pip install softimpact[cluster]'") from None
    try:
        get_address_host_port(address)  # a client of none would complain of its own end
    except ValueError as error:
        raise InvalidValue("--dask", f"'{address}' is no address of a scheduler: {error}") from None
    try:
        client = Client(address, timeout=PATIENCE, set_as_default=False)
    except (OSError, TimeoutError):
        raise ClusterSilent(
            f"no Dask scheduler answers at '{address}'; start one there, or leave --dask out"
        ) from None
    try:
        try:
            client.wait_for_workers(1, timeout=PATIENCE)
        except TimeoutError:
            raise ClusterSilent(f"the Dask scheduler at '{address}' has no worker") from None
        yield Cluster(client)
    finally:
        client.close()
