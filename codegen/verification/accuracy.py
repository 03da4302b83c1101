# SPDX-License-Identifier: BSD-3-Clause
"""Golden results of a package's functions, and what single precision loses of them."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from decimal import Context, Decimal, localcontext
from typing import Any

import numpy as np
from numpy.typing import NDArray

from ..expressions.evaluate import evaluate_exactly, evaluate_rounded
from ..expressions.exact import DIGITS
from ..functions.description import CFunction
from ..inputs.samples import Sample

Inputs = Sequence[NDArray[np.float64]]
"""All inputs of many samples, as ``as_columns`` returns them."""

SHARE_STATED = 0.999
"""Share of configurations for which the stated errors hold."""

MARGIN = 4.0
"""Stated float error over the one measured: for other compilers, fused multiply-adds, and the
configurations between those measured."""

SAMPLES_AT_ONCE = 4096
"""Samples evaluated together: their values take some 100 MB for thirty joints."""

DOUBLE_ERROR = 1e-12
"""Least bound stated of a double build's error, against exact arithmetic and against CasADi, whose
constants have more digits than those printed."""


def golden_results(function: CFunction, samples: Sequence[Sample]) -> list[list[float]]:
    """Return for each sample the compared entries of each output and their scale.

    All are right to the last bit.
    """
    results = []
    for sample in samples:
        arguments: list[Sequence[float | Decimal]] = [sample.q, _exact_unit(sample.n)]
        arguments += [*sample.parameters, *((x,) for x in sample.scalars)]
        values = evaluate_exactly(function.graph, arguments)[: len(function.outputs)]
        own = iter(evaluate_exactly(function.scales, arguments))
        row: list[float] = []
        for output, entries in zip(function.outputs, values, strict=True):
            scale = max(map(abs, entries)) if output.scale is None else next(own)[0]
            row += [*entries, scale]
        results.append(row)
    return results


def _exact_unit(n: Sequence[float]) -> list[Decimal]:
    with localcontext(Context(prec=DIGITS)):
        length = sum((Decimal(x) * Decimal(x) for x in n), Decimal(0)).sqrt()
        return [Decimal(x) / length for x in n]


def is_regular(function: CFunction, inputs: Inputs) -> NDArray[np.bool_]:
    """Return for which samples the function answers instead of reporting a singularity."""
    return _evaluate(function, inputs, np.float64)[1]


@dataclass(frozen=True)
class Accuracy:
    """What a function's results lose to rounding.

    Attributes:
        double: error that 99.9 % of configurations stay below in double.
        single: the same in float, with a margin.
        single_worst: largest error found in float.
    """

    double: float
    single: float
    single_worst: float


def accuracy(function: CFunction, inputs: Inputs) -> Accuracy:
    """Return a function's accuracy, measured in single precision; errors scale with precision.

    Few configurations are so ill-conditioned that a bound over all of them would say nothing about
    the others. All numbers are rounded up to one digit.
    """
    samples = inputs[0].shape[1]
    parts = [
        [i[:, k : k + SAMPLES_AT_ONCE] for i in inputs] for k in range(0, samples, SAMPLES_AT_ONCE)
    ]
    ordered = np.sort(np.concatenate([_float_errors(function, part) for part in parts]))
    epsilon = float(np.finfo(np.float32).eps)
    usual = max(epsilon, float(ordered[int(SHARE_STATED * (ordered.size - 1))]))
    worst = max(epsilon, float(ordered[-1]))
    scale = float(np.finfo(np.float64).eps) / epsilon
    return Accuracy(
        double=max(DOUBLE_ERROR, rounded_up(usual * scale)),
        single=rounded_up(MARGIN * usual),
        single_worst=rounded_up(worst),
    )


def _float_errors(function: CFunction, inputs: Inputs) -> NDArray[np.float64]:
    """Return the largest error of each sample to which the function answers in both precisions."""
    reference, regular = _evaluate(function, inputs, np.float64)
    narrow, still_regular = _evaluate(function, inputs, np.float32)
    both = regular & still_regular
    scales = _scales(function, inputs, reference)
    errors = [
        _error(got[:, both], wide[:, both], scale[both])
        for wide, got, scale in zip(reference, narrow, scales, strict=True)
    ]
    return np.asarray(np.max(errors, axis=0))


def _error(
    found: NDArray[Any], right: NDArray[np.float64], scale: NDArray[np.float64]
) -> NDArray[np.float64]:
    """Error of each sample's entries over their scale."""
    return np.asarray(abs(found.astype(float) - right).max(axis=0) / np.where(scale > 0, scale, 1))


def _scales(
    function: CFunction, inputs: Inputs, values: Sequence[NDArray[np.float64]]
) -> list[NDArray[np.float64]]:
    """Return what the errors of each output are stated over, for each sample."""
    own = iter(evaluate_rounded(function.scales, _arguments(inputs, np.float64), np.float64))
    return [
        abs(value).max(axis=0) if output.scale is None else next(own)[0]
        for output, value in zip(function.outputs, values, strict=True)
    ]


def _arguments(inputs: Inputs, kind: type[np.floating[Any]]) -> list[NDArray[np.float64]]:
    """Return all inputs with unit directions as C computes them."""
    q, n, *others = inputs
    return [q, rounded_unit(n, kind), *others]


def rounded_up(value: float) -> float:
    """Return a positive number rounded up to one digit."""
    exponent = math.floor(math.log10(value))
    return float(f"{math.ceil(value / 10.0**exponent)}e{exponent}")


def _evaluate(
    function: CFunction, inputs: Inputs, kind: type[np.floating[Any]]
) -> tuple[list[NDArray[Any]], NDArray[np.bool_]]:
    """Return all outputs, and for which samples all guards hold."""
    values = evaluate_rounded(function.graph, _arguments(inputs, kind), kind)
    regular = np.ones(inputs[0].shape[1], dtype=bool)
    outputs = len(function.outputs)
    for guard, (value,) in zip(function.guards, values[outputs:], strict=True):
        regular &= (value > guard.low) & (guard.high is None or value < guard.high)
    return values[:outputs], regular


def rounded_unit(n: NDArray[np.float64], kind: type[np.floating[Any]]) -> NDArray[np.float64]:
    """Return unit vectors along columns as C computes them."""
    narrow = n.astype(kind)
    narrow = narrow / abs(narrow).max(axis=0)
    length = np.sqrt(narrow[0] * narrow[0] + narrow[1] * narrow[1] + narrow[2] * narrow[2])
    return np.asarray(narrow * (kind(1) / length), dtype=np.float64)
