# SPDX-License-Identifier: BSD-3-Clause
"""What functions share is found in their graphs, and computes the same there."""

from __future__ import annotations

from collections.abc import Sequence
from functools import cache

import casadi as ca
import numpy as np
import pytest
from numpy.typing import NDArray

from softimpact.codegen.expressions.evaluate import evaluate_rounded
from softimpact.codegen.expressions.graph import Graph, graph_of
from softimpact.codegen.expressions.printer import Call, print_graph
from softimpact.codegen.inputs.defaults import Payload
from softimpact.codegen.inputs.samples import as_columns, draw_samples
from softimpact.codegen.package.generate import package_of
from softimpact.codegen.package.render import Package
from softimpact.codegen.sharing.split import Split, split_all
from softimpact.codegen.sharing.stage import SharedStage
from softimpact.codegen.sharing.values import Value, Values
from softimpact.codegen.sources.function import CSource
from softimpact.symbolic import load_robot

X = ca.SX.sym("x", 3)
A, B, C = ca.vertsplit(X)


def work(a: ca.SX, b: ca.SX) -> ca.SX:
    """Return sums and products enough to be worth a call."""
    for _ in range(25):
        a, b = a * b + a, a * b - b
    return a - b


def stage() -> SharedStage:
    j = ca.SX.sym("j", 2)
    return SharedStage("worked", "Work.", (X, ca.SX.sym("n", 3), j), ("j",), work(j[0], j[1]))


def at(values: Values, column: ca.SX) -> list[Value]:
    graph = graph_of([X], [column])
    found = values.of(graph, {})
    return [found[i] for i in graph.results[0]]


def splits(graphs: dict[str, Graph], columns: Sequence[ca.SX]) -> dict[str, Split]:
    values, shared = Values(), stage()
    uses = [shared.on(values, {2: at(values, column)}) for column in columns]
    return split_all(graphs, dict.fromkeys(graphs, uses), values, 2)


def test_a_stage_is_called_wherever_it_occurs() -> None:
    first, second = work(A, ca.sin(B)), work(C - A, 2 * B)
    graphs = {"f": graph_of([X], [first * C]), "g": graph_of([X], [C + first / second])}
    found = splits(graphs, [ca.vertcat(A, ca.sin(B)), ca.vertcat(C - A, 2 * B)])
    assert [stage.name for stage in found["f"].calls] == ["worked"]
    assert [stage.name for stage in found["g"].calls] == ["worked", "worked"]
    assert found["f"].graph.flops == 1
    assert found["g"].graph.flops <= 5  # what it passes on, and what it makes of the results


def test_a_stage_that_one_call_needs_stays_where_it_is() -> None:
    graphs = {"f": graph_of([X], [work(A, B)]), "g": graph_of([X], [A + B])}
    found = splits(graphs, [ca.vertcat(A, B)])
    assert found["f"].calls == ()
    assert found["f"].graph.flops == graphs["f"].flops


def test_values_are_the_same_up_to_their_sign() -> None:
    values = Values()
    first, second = at(values, ca.vertcat((A - B) * C, (B - A) * C))
    assert first == -second
    assert at(values, ca.vertcat(C * (A - B)))[0] == first
    assert at(values, ca.vertcat(ca.cos(A - B)))[0] == at(values, ca.vertcat(ca.cos(B - A)))[0]
    assert at(values, ca.vertcat(A - B + C))[0] != at(values, ca.vertcat(A - (B + C)))[0]


def test_calls_come_before_what_reads_them_and_take_arrays_as_they_are() -> None:
    shared, values = stage(), Values()
    graph = graph_of([X], [work(A, B) * ca.sin(work(B, C)) * ca.cos(work(B, C))])
    uses = [shared.on(values, {2: at(values, c)}) for c in (ca.vertcat(A, B), ca.vertcat(B, C))]
    split = split_all({"f": graph}, {"f": uses}, values, 2)["f"]
    names = ("one", "two")
    calls = [Call("x_worked", name, 1, 2 + k, [1 + k], ["j"]) for k, name in enumerate(names)]
    places = [["q[0]", "q[1]", "q[2]"], [], *([f"{name}[0]"] for name in names)]
    lines = print_graph(split.graph, places, [["y"]], "x", 0, calls).lines
    text = "\n".join(line.strip() for line in lines)
    for k, name in enumerate(names):
        array = "&q[1]" if k else "q"
        call = f"x_real {name}[1];\nx_worked({array}, {name});"
        assert text.index(call) < text.index(f"{name}[0]")


@cache
def built(name: str, *, loaded: bool = False) -> Package:
    payload = Payload(2.0, (0.0, 0.1, 0.1)) if loaded else None
    return package_of(load_robot(name), payload=payload, verified=False)


def composed(source: CSource, inputs: Sequence[NDArray[np.float64]]) -> list[NDArray[np.float64]]:
    """Return what a function computes with the calls that it makes."""
    split = source.split
    assert split is not None
    own = len(source.function.outputs) + len(source.function.guards)
    known = [*inputs, *[np.full((s.size, inputs[0].shape[1]), np.nan) for s in split.calls]]
    for _ in split.calls:  # those whose arguments are there come first
        results = evaluate_rounded(split.graph, known, np.float64)[own:]
        for k, stage_ in enumerate(split.calls):
            count = len(stage_.arguments)
            arguments, results = results[:count], results[count:]
            full = [*inputs, *[np.zeros((0, 0))] * (len(stage_.symbols) + 2 - len(inputs))]
            for argument, value in zip(stage_.arguments, arguments, strict=True):
                places = [place for _, place in argument.elements]
                column = np.full((max(places) + 1, value.shape[1]), np.nan)
                column[places] = value
                full[argument.elements[0][0]] = column
            known[len(inputs) + k] = evaluate_rounded(stage_.graph, full, np.float64)[0]
    return evaluate_rounded(split.graph, known, np.float64)[:own]


@pytest.mark.slow
@pytest.mark.parametrize(("robot", "loaded"), [("panda", False), ("ur5e", True)])
def test_functions_compute_what_they_would_on_their_own(robot: str, loaded: bool) -> None:
    package = built(robot, loaded=loaded)
    q, n, *others = as_columns(draw_samples(package.robot, package.parameters, 50, seed=5))
    inputs = [q, n / np.linalg.norm(n, axis=0), *others]
    calling = [source for source in package.functions if source.split]
    assert len(calling) > 15
    for source in calling:
        alone = evaluate_rounded(source.function.graph, inputs, np.float64)
        for found, right in zip(composed(source, inputs), alone, strict=True):
            scale = abs(right).max(axis=0)
            assert abs(found - right).max(axis=0) == pytest.approx(
                0 * scale, abs=1e-6 * scale.max()
            )


@pytest.mark.slow
def test_next_to_nothing_is_computed_twice() -> None:
    """What the design says of operations holds of the C, too."""
    for source in built("panda").functions:
        if source.split:
            calls = sum(stage_.graph.flops for stage_ in source.split.calls)
            assert source.split.graph.flops + calls <= 1.15 * source.function.graph.flops + 10
