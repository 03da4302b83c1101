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
    go on with what is no result.
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
    if not _in_solver(frame):
        raise KeyboardInterrupt
    for child in multiprocessing.active_children():
        child.terminate()
    if sys.stderr.isatty():
        sys.stderr.write(SHOW_CURSOR)  # a progress bar hides it
    report()
    sys.stdout.flush()
    os._exit(INTERRUPTED)


def _in_solver(frame: FrameType | None) -> bool:
    """Whether CasADi evaluates a function, which may be a solver."""
    casadi = sys.modules.get("casadi.casadi")
    while casadi is not None and frame is not None:
        code = frame.f_code
        if code.co_filename == casadi.__file__ and code.co_qualname.startswith("Function."):
            return True
        frame = frame.f_back
    return False


def report() -> None:
    """Say on stderr that the command was interrupted."""
    print("error: interrupted", file=sys.stderr, flush=True)
