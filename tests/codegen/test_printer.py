# SPDX-License-Identifier: BSD-3-Clause
"""C text of expressions, and the arithmetics that the generator evaluates them in."""

from __future__ import annotations

import ctypes
import random
from collections.abc import Callable
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from compiled_packages import WARNINGS, run, tool

from softimpact.codegen import UnsupportedOperation
from softimpact.codegen.expressions.evaluate import evaluate_exactly, evaluate_rounded
from softimpact.codegen.expressions.graph import graph_of
from softimpact.codegen.expressions.printer import LINE, print_graph
from softimpact.symbolic.robot.rigid import Array

HEAD = """
#include <math.h>
#define X_R(x) x
#define X_SIN sin
#define X_COS cos
#define X_EXP exp
#define X_LOG log
#define X_SQRT sqrt
#define X_FABS fabs
#define X_FMIN fmin
#define X_FMAX fmax
#define X_COPYSIGN copysign
#define X_POW pow
typedef double x_real;
static inline void x_sines_cosines(const double *x, int count, double *s, double *c)
{
    for (int i = 0; i < count; ++i) {
        s[i] = sin(x[i]);
        c[i] = cos(x[i]);
    }
}
"""
X = ca.SX.sym("x", 3)
A, B, C = X[0], X[1], X[2]
OPERATIONS: dict[str, ca.SX] = {
    "add": A + B,
    "sub": A - B,
    "mul": A * B,
    "div": A / B,
    "neg": -A,
    "sq": A**2,
    "twice": 2 * A,
    "inv": 1 / A,
    "sqrt": ca.sqrt(A),
    "sin": ca.sin(A),
    "cos": ca.cos(A),
    "exp": ca.exp(A),
    "copysign": ca.copysign(A, B),
    "log": ca.log(A),
    "fabs": ca.fabs(A),
    "fmin": ca.fmin(A, B),
    "fmax": ca.fmax(A, B),
    "pow": A**B,
    "constpow": A**2.5,
    "negative angle": ca.sin(-A) + ca.cos(-A),
    "two angles": ca.sin(A) * ca.cos(A) - ca.sin(C) / ca.cos(C),
    "negative argument": ca.exp(-A) + ca.fmax(-A, -B),
    "negative divisor": (A - B) / -C,
    "reversed difference": (A - B) * C + (B - A),
    "nested difference": A - (B - (C - A)),
    "nested quotient": A / (B / (C / A)),
    "square of a sum": (A + B) ** 2 / (A - C) ** 2,
    "inverse of a product": 1 / (A * B) * C,
    "constants": -0.1 * A - 1e-30 + 3 * B - 1e30 / C,
}
Compiled = Callable[[Array], Array]
POINTS = np.random.default_rng(0).uniform(0.2, 3.0, (3, 50))


def c_function(expressions: list[ca.SX], tmp_path: Path, compiler: str = "gcc") -> Compiled:
    """Compile expressions of x as one C function of double."""
    graph = graph_of([X], [ca.vertcat(*expressions)])
    names = [[f"y{i}" for i in range(len(expressions))]]
    printed = print_graph(graph, [["x[0]", "x[1]", "x[2]"]], names, "x", angles=0)
    writes = [f"    y[{i}] = {text};" for i, text in enumerate(printed.results[0])]
    head = "void f(const double x[3], double *y);\nvoid f(const double x[3], double *y)\n{"
    source = tmp_path / "f.c"
    source.write_text("\n".join([HEAD, head, *printed.lines, *writes, "}\n"]))
    library = tmp_path / "f.so"
    run(tool(compiler), "-std=c99", "-O2", "-ffp-contract=off", *WARNINGS, "-shared", "-fPIC",
        source, "-o", library, "-lm")  # fmt: skip
    entry = ctypes.CDLL(str(library)).f

    def call(x: Array) -> Array:
        y = np.full(len(expressions), np.nan)
        x = np.ascontiguousarray(x)
        entry(ctypes.c_void_p(x.ctypes.data), ctypes.c_void_p(y.ctypes.data))
        return y

    return call


def random_expression(source: random.Random, depth: int) -> ca.SX:
    """Return a random sum of products, differences, quotients and sines."""
    if depth == 0:
        return source.choice([A, B, C, -2.5 * A, C - 7, 0.25 - B])  # no constant loses a digit
    first, second = (random_expression(source, depth - 1) for _ in range(2))
    return source.choice(
        [first + second, first - second, first * second, first / (5 + second * second),
         -first, first**2, 2 * first, ca.sin(first), first - first * second]
    )  # fmt: skip


@pytest.mark.parametrize("compiler", ["gcc", "clang"])
def test_every_operation_rounds_as_in_casadi(compiler: str, tmp_path: Path) -> None:
    expressions = list(OPERATIONS.values())
    call = c_function(expressions, tmp_path, compiler)
    reference = ca.Function("f", [X], [ca.vertcat(*expressions)])
    for point in POINTS.T:
        np.testing.assert_allclose(call(point), np.array(reference(point)).ravel(), rtol=4e-16)


def test_random_expressions_agree_to_the_last_bit(tmp_path: Path) -> None:
    source = random.Random(7)
    expressions = [random_expression(source, 5) for _ in range(150)]
    call = c_function(expressions, tmp_path)
    reference = ca.Function("f", [X], [ca.vertcat(*expressions)])
    for point in POINTS.T:
        np.testing.assert_array_equal(call(point), np.array(reference(point)).ravel())


@pytest.mark.parametrize("name", OPERATIONS)
def test_exact_and_rounded_arithmetic_agree_with_casadi(name: str) -> None:
    graph = graph_of([X], [OPERATIONS[name]])
    reference = ca.Function("f", [X], [OPERATIONS[name]])
    (wide,) = evaluate_rounded(graph, [POINTS], np.float64)
    (narrow,) = evaluate_rounded(graph, [POINTS], np.float32)
    assert narrow.dtype == np.float32
    for k, point in enumerate(POINTS.T):
        right = float(reference(point))
        assert wide[0, k] == pytest.approx(right, rel=1e-13, abs=1e-14)
        assert evaluate_exactly(graph, [point])[0][0] == pytest.approx(right, rel=1e-13, abs=1e-14)
        assert narrow[0, k] == pytest.approx(right, rel=1e-4, abs=1e-5)


@pytest.mark.parametrize("angle", [0.0, 1e-9, 0.7, -2.5, 3.14159265358979, 100.0, -1e6])
def test_exact_sines_are_right_to_the_last_bit(angle: float) -> None:
    graph = graph_of([X], [ca.vertcat(ca.sin(A), ca.cos(A))])
    (found,) = evaluate_exactly(graph, [[angle, 0, 0]])
    np.testing.assert_array_max_ulp(np.array(found), [np.sin(angle), np.cos(angle)], maxulp=1)


@pytest.mark.parametrize("expression", [ca.tanh(A), ca.if_else(A < B, A, B), ca.floor(A)])
def test_unknown_operations_are_named(expression: ca.SX) -> None:
    with pytest.raises(UnsupportedOperation, match="OP_"):
        graph_of([X], [expression])


def test_values_that_differ_in_sign_are_computed_once() -> None:
    graph = graph_of([X], [ca.vertcat((A - B) * C, (-0.5 * A) * C + (B - A), 0.5 * A)])
    assert graph.count(ca.OP_SUB) == 1
    assert graph.count(ca.OP_NEG) == 1  # the second result is minus a sum
    assert all(node.value >= 0 for node in graph.nodes)


def test_sines_of_shifted_angles_keep_their_joints_name() -> None:
    graph = graph_of([X], [ca.sin(A + 0.25) * ca.cos(B) + ca.sin(A * B)])
    printed = print_graph(graph, [["q[0]", "q[1]", "q[2]"]], [["y"]], "x", angles=0)
    assert printed.lines[0].strip() == "const x_real s1 = X_SIN(q[0] + X_R(0.25));"
    assert printed.lines[1].strip() == "const x_real c2 = X_COS(q[1]);"
    assert printed.lines[-1].strip() == "const x_real y = s1*c2 + X_SIN(q[0]*q[1]);"


def test_sines_and_cosines_of_all_angles_are_computed_at_once() -> None:
    graph = graph_of([X], [ca.sin(B) + ca.cos(B + 0.5) * ca.sin(0.5 + B) * ca.cos(B) - ca.cos(C)])
    printed = print_graph(graph, [["q[0]", "q[1]", "q[2]"]], [["y"]], "x", angles=0)
    text = "\n".join(printed.lines)
    assert "t1 = q[1] + X_R(0.5);\n    const x_real angles[2] = {q[1], t1};" in text
    assert "x_sines_cosines(angles, 2, sines, cosines);" in text
    for line in ("s2 = sines[0];", "c2 = cosines[0];", "s2_2 = sines[1];", "c2_2 = cosines[1];"):
        assert f"    const x_real {line}" in text
    assert "c3 = X_COS(q[2]);" in text
    assert text.count("X_SIN") + text.count("sines_cosines") == 1


def test_angles_that_stand_side_by_side_are_read_where_they_are() -> None:
    pair = ca.sin(B) * ca.cos(B) + ca.sin(C) * ca.cos(C)
    printed = print_graph(graph_of([X], [pair]), [["q[0]", "q[1]", "q[2]"]], [["y"]], "x", angles=0)
    assert "x_sines_cosines(&q[1], 2, sines, cosines);" in "".join(printed.lines)
    apart = ca.sin(A) * ca.cos(A) + ca.sin(C) * ca.cos(C)
    printed = print_graph(
        graph_of([X], [apart]), [["q[0]", "q[1]", "q[2]"]], [["y"]], "x", angles=0
    )
    assert "angles[2] = {q[0], q[2]};" in "".join(printed.lines)


def test_lines_stay_short() -> None:
    total = ca.SX(0)
    for i in range(60):
        total = total + (A * (i + 0.123456789012345) + B) * ca.sin(C + i)
    graph = graph_of([X], [total])
    printed = print_graph(graph, [["p->long_name[0]", "p->long_name[1]", "q"]], [["y"]], "prefix")
    assert max(map(len, printed.lines)) <= LINE
    operations = graph.flops + graph.count(ca.OP_SIN)
    assert operations > 2.5 * len(printed.lines)  # and still hold several operations each


def test_constants_read_back_as_they_were_rounded() -> None:
    graph = graph_of([X], [A + 0.1 + B * (1 / 3)])
    printed = print_graph(graph, [["a", "b", "c"]], [["y"]], "x")
    assert "X_R(0.333333333333333)" in printed.lines[0]
    assert "X_R(0.1)" in printed.lines[0]
