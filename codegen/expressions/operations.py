# SPDX-License-Identifier: BSD-3-Clause
"""The operations of CasADi's scalar expressions that the generator knows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from decimal import Decimal
from enum import IntEnum
from typing import Any, Literal

import casadi as ca
import numpy as np

from ..errors import UnsupportedOperation
from . import exact, sine


class Binding(IntEnum):
    """How tightly C binds an expression's outermost operator."""

    SUM = 1
    PRODUCT = 2
    SIGN = 3
    ATOM = 4


@dataclass(frozen=True)
class Operation:
    """One operation, in C and in the two arithmetics that the generator evaluates it in.

    Attributes:
        arity: number of operands.
        text: of the C expression; ``{0}`` and ``{1}`` are operands, ``{R}`` prefixes macros.
        binding: of the C expression.
        operands: how tightly each operand must bind at least to go without parentheses.
        exact: evaluates it on ``decimal.Decimal``.
        rounded: evaluates it on NumPy arrays, in their precision.
        commutes: whether operands may be swapped without changing a bit.
        repeats: whether the text names an operand twice, which must then be a variable.
        parity: ``odd`` if the sign of an operand is the sign of the value, ``even`` if it does not
            matter, None if it is more than a sign.
    """

    arity: int
    text: str
    binding: Binding
    operands: tuple[Binding, ...]
    exact: Callable[..., Decimal]
    rounded: Callable[..., Any]
    commutes: bool = False
    repeats: bool = False
    parity: Literal["odd", "even"] | None = None


def _call(
    name: str,
    exact_: Callable[..., Decimal],
    rounded: Callable[..., Any],
    parity: Literal["odd", "even"] | None = None,
) -> Operation:
    text, binds = f"{{R}}{name}({{0}})", (Binding.SUM,)
    return Operation(1, text, Binding.ATOM, binds, exact_, rounded, parity=parity)


def _call2(name: str, exact_: Callable[..., Decimal], rounded: Callable[..., Any]) -> Operation:
    binds = (Binding.SUM, Binding.SUM)
    return Operation(2, f"{{R}}{name}({{0}}, {{1}})", Binding.ATOM, binds, exact_, rounded)


_SUM, _PRODUCT, _SIGN, _ATOM = Binding

OPERATIONS: dict[int, Operation] = {
    ca.OP_ADD: Operation(
        2, "{0} + {1}", _SUM, (_SUM, _PRODUCT), lambda a, b: a + b, np.add, commutes=True
    ),
    ca.OP_SUB: Operation(2, "{0} - {1}", _SUM, (_SUM, _PRODUCT), lambda a, b: a - b, np.subtract),
    ca.OP_MUL: Operation(
        2,
        "{0}*{1}",
        _PRODUCT,
        (_PRODUCT, _SIGN),
        lambda a, b: a * b,
        np.multiply,
        commutes=True,
        parity="odd",
    ),
    ca.OP_DIV: Operation(
        2, "{0}/{1}", _PRODUCT, (_PRODUCT, _SIGN), lambda a, b: a / b, np.divide, parity="odd"
    ),
    ca.OP_NEG: Operation(1, "-{0}", _SIGN, (_ATOM,), lambda a: -a, np.negative),
    ca.OP_SQ: Operation(
        1,
        "{0}*{0}",
        _PRODUCT,
        (_ATOM,),
        lambda a: a * a,
        lambda a: a * a,
        repeats=True,
        parity="even",
    ),
    ca.OP_TWICE: Operation(
        1, "{R}R(2.0)*{0}", _PRODUCT, (_SIGN,), lambda a: 2 * a, lambda a: a + a, parity="odd"
    ),
    ca.OP_INV: Operation(
        1, "{R}R(1.0)/{0}", _PRODUCT, (_SIGN,), lambda a: 1 / a, lambda a: 1 / a, parity="odd"
    ),
    ca.OP_SQRT: _call("SQRT", lambda a: a.sqrt(), np.sqrt),
    ca.OP_SIN: _call("SIN", exact.sine, sine.sine, "odd"),
    ca.OP_COS: _call("COS", exact.cosine, sine.cosine, "even"),
    ca.OP_EXP: _call("EXP", lambda a: a.exp(), exact.correctly_rounded(np.exp)),
    ca.OP_LOG: _call("LOG", lambda a: a.ln(), exact.correctly_rounded(np.log)),
    ca.OP_FABS: _call("FABS", abs, np.abs, "even"),
    ca.OP_FMIN: _call2("FMIN", min, np.minimum),
    ca.OP_FMAX: _call2("FMAX", max, np.maximum),
    ca.OP_COPYSIGN: _call2("COPYSIGN", lambda a, b: a.copy_sign(b), np.copysign),
    ca.OP_POW: _call2("POW", lambda a, b: a**b, exact.correctly_rounded(np.power)),
    ca.OP_CONSTPOW: _call2("POW", lambda a, b: a**b, exact.correctly_rounded(np.power)),
}
"""Every known operation by CasADi's number."""

_NAMES = {getattr(ca, name): name for name in dir(ca) if name.startswith("OP_")}


def operation(number: int) -> Operation:
    """Return an operation by CasADi's number; raises UnsupportedOperation."""
    if number not in OPERATIONS:
        raise UnsupportedOperation(number, _NAMES.get(number, "unknown"))
    return OPERATIONS[number]
