# SPDX-License-Identifier: BSD-3-Clause
"""Fronts over objectives: no point beats another, none is beaten, each is what it says."""

from __future__ import annotations

import csv
import json
import re
import sys
from dataclasses import replace
from pathlib import Path
from unittest.mock import patch

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from matplotlib.text import Text
from small_arm import small_study
from studies import InProcess

from softimpact.optimize import Infeasible, Study, TradeOff, trade_off_front
from softimpact.optimize import bounds as of_bounds
from softimpact.optimize.evaluation import figures, kept
from softimpact.optimize.front.axes import asked_axes
from softimpact.optimize.front.dominance import knee, undominated
from softimpact.optimize.impact.impact_program import impact_program
from softimpact.optimize.robust.robust import robust_design
from softimpact.optimize.study.study_file import ParetoSection
from softimpact.optimize.study.study_scenarios import scenarios_of
from softimpact.optimize.study_check import study_problems
from softimpact.studio.figures.trade_off import figure_of_front
from softimpact.studio.figures.trade_off_hardware import figure_of_hardware
from softimpact.studio.front.trade_off_record import trade_off_record, write_points
from softimpact.studio.front.trade_off_report import TradeOffReport, trade_off_report
from softimpact.studio.front.trade_off_schema import ObjectivesResults
from softimpact.studio.front.trade_off_words import front_words, heading, in_words
from softimpact.studio.report.trade_off_pages import write_trade_off_report
from softimpact.symbolic import InvalidValue
from softimpact.symbolic.record import plain
from softimpact.symbolic.robot.rigid import Array

TWO = '[hardware]\njoint_stiffness = [["turn"], ["lift", "bend"]]\n'

SAME = 2e-3
"""Share to which forces of two programs agree."""

DOCS = Path(__file__).parents[2] / "docs"


def asked(study: Study, *objectives: str, **more: object) -> Study:
    """Return a study with a front to seek."""
    fields: dict[str, object] = {"objectives": list(objectives), **more}
    return replace(study, levels=ParetoSection.model_validate(fields))


@pytest.fixture(scope="module")
def study(tmp_path_factory: pytest.TempPathFactory) -> Study:
    return small_study(tmp_path_factory.mktemp("fronts"), TWO)


@pytest.fixture(scope="module")
def found(study: Study) -> TradeOff:
    return trade_off_front(
        asked(study, "force", "accuracy", "natural_frequency", points=3), InProcess()
    )


@pytest.fixture(scope="module")
def report(found: TradeOff) -> TradeOffReport:
    return trade_off_report(found, lambda *_: None)


def costs(found: TradeOff) -> Array:
    """Return the points' objectives, less being better."""
    values = np.array([point.values for point in found.points])
    return np.where([axis.more_is_better for axis in found.axes.all], 1 / values, values)


@pytest.mark.slow
def test_no_point_beats_another(found: TradeOff) -> None:
    rows = costs(found)
    assert len(rows) >= 6
    for i, row in enumerate(rows):
        others = np.delete(rows, i, axis=0)
        assert not np.any(np.all(others <= row, axis=1))
    assert found.unsolved == ()


@pytest.mark.slow
def test_values_are_what_the_hardware_has(found: TradeOff) -> None:
    for point in found.points:
        force, deflection, frequency = point.values
        each = [kept(point.study, q, point.springs) for q in point.postures]
        assert all(k.share <= 1 + 1e-5 for row in each for k in row)
        assert deflection == pytest.approx(max(row[0].figure for row in each))
        assert frequency == pytest.approx(min(row[1].figure for row in each))
        assert force == point.worst.share


@pytest.mark.slow
def test_no_springs_of_a_grid_beat_a_point(found: TradeOff) -> None:
    """Brute force: two springs, every combination of nine values, apart from the search."""
    study, scenarios, timing = found.study, found.scenarios, found.timing
    program = impact_program(study.model, timing.nodes, timing.substeps, compiled=False)
    rows, axis = costs(found), np.geomspace(500.0, 3e4, 9)
    bounds = study.bounds
    for large in axis:
        for small in axis:
            springs = np.array([large, small, small])
            looked = [
                [figures(bound, study, q, springs) for bound in bounds] for q in (
                    pose.q for pose in scenarios.poses)
            ]  # fmt: skip
            deflection = max(float(each[0].max()) for each in looked)
            frequency = min(float(each[1].min()) for each in looked)
            shares = []
            for i in range(len(scenarios)):
                x = np.r_[scenarios.poses[scenarios[i].pose].q, np.log10(springs)]
                peak = np.array(program["forces"](x, scenarios.numbers(scenarios[i], timing.step)))
                shares.append(peak.max() / scenarios.limit(scenarios[i]))
            cost = np.array([max(shares), deflection, 1 / frequency])
            assert not np.any(np.all(cost < rows * (1 - SAME), axis=1)), springs


@pytest.mark.slow
def test_a_front_of_springs_that_can_be_bought(tmp_path: Path) -> None:
    """No two springs of the catalogue beat a point; every point's can be bought."""
    entries = [1000.0, 2500.0, 5000.0, 9000.0, 20000.0]
    study = small_study(tmp_path, TWO + f"catalogue = {entries}")
    found = trade_off_front(asked(study, "force", "accuracy", points=4), InProcess())
    timing, scenarios = found.timing, found.scenarios
    program = impact_program(study.model, timing.nodes, timing.substeps, compiled=False)
    assert found.points
    assert found.searched - found.not_sold >= len(found.points)
    for point in found.points:
        assert set(point.springs) <= set(entries)
        assert point.bought is not None
        assert point.bought.loss > -SAME
        assert point.worst.keeps
        assert point.values[0] == point.worst.share
    rows = np.array([point.values for point in found.points])
    for large in entries:
        for small in entries:
            springs = np.array([large, small, small])
            worst, bent = 0.0, 0.0
            for i in range(len(scenarios)):
                q = scenarios.poses[scenarios[i].pose].q
                bent = max(bent, float(figures(study.deflection, study, q, springs).max()))
                row = scenarios.numbers(scenarios[i], timing.step)
                peak = np.array(program["forces"](np.r_[q, np.log10(springs)], row)).max()
                worst = max(worst, float(peak / scenarios.limit(scenarios[i])))
            assert not np.any(np.all([worst, bent] < rows * (1 - SAME), axis=1)), springs


@pytest.mark.slow
def test_prices_are_slopes(found: TradeOff) -> None:
    """One per cent more deflection, sought again, saves a tenth of what a price says of ten."""
    point = next(
        p for p in found.points if p.prices and p.prices[0].bound == "accuracy.max_deflection"
    )
    price = next(p for p in point.prices if p.bound == "accuracy.max_deflection")
    study = point.study
    forces = [
        robust_design(
            replace(study, max_deflection=factor * study.max_deflection),
            point.scenarios,
            InProcess(),
        ).worst.force
        for factor in (0.99, 1.01)
    ]
    assert (forces[0] - forces[1]) / 0.02 * 0.1 == pytest.approx(price.gain, rel=0.1)


@pytest.mark.slow
def test_what_is_indifferent_costs_little_and_keeps_the_bounds(found: TradeOff) -> None:
    study, scenarios, timing = found.study, found.scenarios, found.timing
    program = impact_program(study.model, timing.nodes, timing.substeps, compiled=False)
    random = np.random.default_rng(0)

    def share(springs: Array) -> float:
        shares = []
        for i in range(len(scenarios)):
            x = np.r_[scenarios.poses[scenarios[i].pose].q, np.log10(springs)]
            peak = np.array(program["forces"](x, scenarios.numbers(scenarios[i], timing.step)))
            shares.append(peak.max() / scenarios.limit(scenarios[i]))
        return float(max(shares))

    for point in found.points[::3]:
        own = share(point.springs)
        for group, (low, high) in enumerate(point.indifferent):
            assert low <= point.springs[study.groups.index(group)] * (1 + 1e-9)
            for value in (low, high, random.uniform(low, high)):
                springs = np.where(np.array(study.groups) == group, value, point.springs)
                assert share(springs) <= own * (1 + 0.005 + SAME)
                for q in point.postures:
                    assert all(k.share <= 1 + 2e-5 for k in kept(point.study, q, springs))


@pytest.mark.slow
def test_the_record_has_the_published_form(report: TradeOffReport, tmp_path: Path) -> None:
    record = plain(trade_off_record(report))
    assert json.loads(json.dumps(record, allow_nan=False)) == record
    ObjectivesResults.model_validate(record)
    assert [one["kind"] for one in record["objectives"]] == [
        "worst_force", "deflection", "natural_frequency"]  # fmt: skip
    for point in record["points"]:
        assert point["check"]["linearised"] == pytest.approx(point["check"]["nlp"], rel=1e-3)
        assert point["prices"]
    assert sum(point["knee"] for point in record["points"]) == (report.found.knee is not None)
    write_points(report, tmp_path / "front.csv")
    with (tmp_path / "front.csv").open(encoding="utf-8", newline="") as file:
        table = list(csv.DictReader(file))
    for row, point in zip(table, record["points"], strict=True):
        assert float(row["deflection [m]"]) == point["values"]["deflection"]
        assert float(row["worst_force_N"]) == point["worst_force"]
        assert float(row["k_s_lift"]) == point["springs"][1]


@pytest.mark.slow
def test_a_front_is_a_table_and_a_drawing(found: TradeOff) -> None:
    told = found.to_dict()
    assert json.loads(json.dumps(told, allow_nan=False)) == told
    rows = found.rows()
    assert [row["worst_force"] for row in rows] == [point.values[0] for point in found.points]
    axes = found.plot()
    assert "deflection [m]" in axes.get_xlabel()
    marks = axes.collections[0].get_offsets()
    np.testing.assert_allclose(marks[:, 1], [point.values[0] for point in found.points])


@pytest.mark.slow
def test_words_and_figures(report: TradeOffReport, tmp_path: Path) -> None:
    said = "\n".join([heading(report), *in_words(report)])
    for piece in ("worst force, deflection and natural frequency", "Before", "SUNDIALS", "Hz"):
        assert piece in said
    assert "# " in front_words(report).markdown(["front.png"])
    assert "front" in write_trade_off_report(report, tmp_path / "page.html").read_text("utf-8")
    for figure in (figure_of_front(report), figure_of_hardware(report)):
        figure.draw_without_rendering()
        shown = [t for t in figure.findobj(Text) if t.get_visible() and t.get_text().strip()]
        assert min(float(text.get_fontsize()) for text in shown) >= 9
        box, (width, height) = figure.get_tightbbox(), figure.get_size_inches()
        assert 0 <= box.x0 < box.x1 <= width
        assert 0 <= box.y0 < box.y1 <= height


@pytest.mark.slow
def test_speed_is_held_and_force_grows_with_it(study: Study) -> None:
    ends = {"safe_speed": [0.5, 1.0]}
    found = trade_off_front(asked(study, "speed", "force", points=2, ends=ends), InProcess())
    assert found.axes.sought.kind == "worst_force"
    (fast, strong), (slow, weak) = sorted((p.values for p in found.points), reverse=True)
    assert (fast, slow) == (1.0, 0.5)
    assert strong > 1.5 * weak
    alone = robust_design(study, scenarios_of(study).faster(0.5), InProcess())
    assert weak == pytest.approx(alone.worst.share, rel=1e-3)


@pytest.mark.slow
def test_a_new_bound_is_an_objective_where_it_lies(
    tmp_path: Path, study: Study, monkeypatch: pytest.MonkeyPatch
) -> None:
    """The bound of docs/own-bound.md, as a file beside the others."""
    text = (DOCS / "own-bound.md").read_text(encoding="utf-8")
    source = re.findall(r"```python\n(.*?)```", text, re.DOTALL)[0]
    (tmp_path / "felt_mass.py").write_text(source, encoding="utf-8")
    with patch.object(of_bounds, "__path__", [*of_bounds.__path__, str(tmp_path)]):
        front = asked(replace(study, lower=np.full(3, 2e3)), "force", "felt_mass", points=2)
        result = trade_off_front(front, InProcess())
    sys.modules.pop("softimpact.optimize.bounds.felt_mass", None)
    assert [axis.kind for axis in result.axes.all] == ["worst_force", "felt_mass"]
    assert result.levels["felt_mass"].size == 1  # springs do not change it: nothing to trade


@pytest.mark.parametrize(
    ("names", "reason"),
    [
        (["force"], "name two or three, not 1"),
        (["force", "accuracy", "mass", "giaf"], "name two or three, not 4"),
        (["force", "worst_force"], "'worst_force' is named twice"),
        (["force", "beauty"], "unknown objective or bound 'beauty'"),
        (["mass", "accuracy"], "one of them must be an objective: mean_force"),
        (["force", "mean_force"], "both say what forces are worth"),
        (["speed", "time"], "both say how fast impacts are"),
        (["mean_force", "time"], "cannot be held at a value, only sought"),
    ],
)
def test_objectives_that_make_no_front(study: Study, names: list[str], reason: str) -> None:
    with pytest.raises(InvalidValue, match=rf"pareto\.objectives: .*{reason}"):
        asked_axes(study, names)


@pytest.mark.parametrize(
    ("names", "more", "reason"),
    [
        (("speed", "energy"), {}, "'safe_speed' changes the speeds for which bounds.energy holds"),
        (("force", "mass"), {"ends": {"weight": [1, 2]}}, r"pareto\.ends\.weight: is not held"),
        (("force", "joint_speed"), {}, r"bounds\.joint_speed\.most: nothing of this study moves"),
    ],
)
def test_fronts_that_cannot_be(
    study: Study, names: tuple[str, ...], more: dict[str, object], reason: str
) -> None:
    with pytest.raises(InvalidValue, match=reason):
        trade_off_front(asked(study, *names, **more), InProcess())


@pytest.mark.parametrize(
    ("tables", "field"),
    [
        ('[pareto]\nobjectives = ["force", "beauty"]', ("pareto", "objectives")),
        ('[pareto]\nobjectives = ["speed", "energy"]', ("pareto", "objectives")),
        ("", ()),
    ],
)
def test_a_check_looks_at_what_a_front_trades(
    tmp_path: Path, tables: str, field: tuple[str, ...]
) -> None:
    problems = study_problems(small_study(tmp_path, tables).source)
    assert [tuple(problem.field.split(".")) for problem in problems] == ([field] if field else [])


def test_a_check_looks_at_scenarios(tmp_path: Path) -> None:
    source = small_study(tmp_path, scenarios='points = ["hand"]').source
    (problem,) = study_problems(source)
    assert problem.field == "scenarios"
    assert "unknown frame 'hand'" in problem.reason


def test_bounds_beside_the_objectives_must_be_within_reach(tmp_path: Path) -> None:
    stiff = small_study(tmp_path, f"{TWO}[bounds.cartesian_stiffness]\nleast = 1e7")
    with pytest.raises(Infeasible, match=r"bounds\.cartesian_stiffness\.least above 1e\+07 N/m"):
        trade_off_front(asked(stiff, "force", "accuracy"), InProcess())


def test_the_published_schema_is_that_of_the_results() -> None:
    schema = json.loads((DOCS / "objectives.schema.json").read_text(encoding="utf-8"))
    assert schema == ObjectivesResults.model_json_schema()


@given(arrays(float, st.tuples(st.integers(1, 30), st.integers(2, 3)),
              elements=st.floats(1.0, 2.0)))  # fmt: skip
def test_undominated_points_are_those_of_the_definition(rows: Array) -> None:
    worth = 1e-4
    left = rows[undominated(rows, worth)]
    for i, row in enumerate(left):
        assert not np.any(np.all(np.delete(left, i, axis=0) <= row * (1 - worth), axis=1))
    for row in rows:  # each is matched by one that is left
        assert np.any(np.all(left <= row * (1 + 3 * worth), axis=1))


def test_the_knee_of_a_bent_sheet_is_its_corner() -> None:
    ends = [[0.0, 1.0, 1.0], [1.0, 0.0, 1.0], [1.0, 1.0, 0.0]]
    assert knee(np.array([*ends, [0.2, 0.2, 0.2], [0.5, 0.3, 0.3]])) == 3
    assert knee(np.array(ends)) is None
    assert knee(np.array([[0.0, 1.0, 1.0], [0.1, 0.5, 1.0], [1.0, 0.0, 1.0]])) == 1
