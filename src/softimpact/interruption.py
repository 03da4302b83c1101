# SPDX-License-Identifier: BSD-3-Clause
"""Ctrl-C ends a command at once, whatever it does."""

from __future__ import annotations

import multiprocessing
import os
import signal
import sys
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from types import FrameType

INTERRUPTED = 130
"""Exit code, as shells have it: 128 and the signal's number."""

SHOW_CURSOR = "\x1b[?25h"


@contextmanager
def interruptible() -> Iterator[None]:
    """Let Ctrl-C raise KeyboardInterrupt, or end the process where that would be lost.

    CasADi's solvers take an exception that Ctrl-C raises for their own end, and the command would
    go on with what is no result. CasADi's Python drops it, or makes another of it.
    """
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, _interrupt)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def _interrupt(signum: int, frame: FrameType | None) -> None:
    casadi = _casadi_frames(frame)
    if any(each.f_code.co_qualname.startswith("Function.") for each in casadi):
        _end()  # it may be a solver
    caller = casadi[-1].f_back if casadi else None
    if caller is None:
        raise KeyboardInterrupt
    _raise_in(caller)


def _casadi_frames(frame: FrameType | None) -> list[FrameType]:
    """Return the frames in which CasADi's Python is, from the inside out."""
    module, found = sys.modules.get("casadi.casadi"), []
    while module is not None and frame is not None:
        if frame.f_code.co_filename == module.__file__:
            found.append(frame)
        frame = frame.f_back
    return found


def _end() -> None:
    """End this process and its children at once."""
    for child in multiprocessing.active_children():
        child.terminate()
    if sys.stderr.isatty():
        sys.stderr.write(SHOW_CURSOR)  # a progress bar hides it
    report()
    sys.stdout.flush()
    os._exit(INTERRUPTED)


def _raise_in(frame: FrameType) -> None:
    """Raise KeyboardInterrupt as soon as a frame goes on, or ends."""

    def interrupt(*_: object) -> None:
        sys.settrace(None)
        frame.f_trace = None
        raise KeyboardInterrupt

    frame.f_trace = interrupt
    sys.settrace(lambda *_: None)  # without one, no frame is traced


def report() -> None:
    """Say on stderr that the command was interrupted."""
    print("error: interrupted", file=sys.stderr, flush=True)
