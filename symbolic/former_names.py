# SPDX-License-Identifier: BSD-3-Clause
"""Names of arguments that programs written for 0.1.0 still use."""

from __future__ import annotations

import functools
import warnings
from collections.abc import Callable
from typing import ParamSpec, TypeVar

P = ParamSpec("P")
R = TypeVar("R")


def renamed(**names: str) -> Callable[[Callable[P, R]], Callable[P, R]]:
    """Let a function take arguments by former names, with a DeprecationWarning.

    Args:
        names: the names of today, by the former ones.
    """

    def decorate(function: Callable[P, R]) -> Callable[P, R]:
        @functools.wraps(function)
        def called(*args: P.args, **kwargs: P.kwargs) -> R:
            for former in names.keys() & kwargs.keys():
                words = f"{function.__name__}({former}=…) is {names[former]}= now"
                warnings.warn(words, DeprecationWarning, stacklevel=2)
                kwargs[names[former]] = kwargs.pop(former)
            return function(*args, **kwargs)

        return called

    return decorate
