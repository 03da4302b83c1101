# SPDX-License-Identifier: BSD-3-Clause
"""Results as dictionaries, data frames and figures; several impacts in one call."""

from __future__ import annotations

import json
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from command_line import refusal, run, run_json
from matplotlib.figure import Figure
from studies import InProcess, study_of

import softimpact
from softimpact import plots
from softimpact.simulate import Assessments
from softimpact.symbolic import FrameNotFound, ImpactModel, InvalidValue
from softimpact.symbolic.record import NeedsPackage, Record

Q = [0, 0.3, 0, -2, 0, 2, 0.8]
ALONG = [0.0, 1.0, 0.0]
DOWN = [0.0, 0.0, -1.0]
TYPED = ("panda", "--q", "0,0.3,0,-2,0,2,0.8", "--joint-stiffness", "1e4")


@pytest.fixture(scope="module")
def model() -> ImpactModel:
    panda = softimpact.load_robot("panda")
    return softimpact.impact_model(panda, drives=softimpact.drives(panda, joint_stiffness=1e4))


def on(region: str) -> softimpact.Contact:
    return softimpact.Contact(softimpact.body_region(region))


@pytest.fixture(scope="module")
def many(model: ImpactModel) -> Assessments:
    contacts = [on("chest"), on("hand")]
    return softimpact.assess_impacts(model, Q, [ALONG, [0, 0, -5]], contacts, speed=0.3)


@pytest.fixture(scope="module")
def results(model: ImpactModel, many: Assessments) -> dict[str, Record]:
    found = many.cases[0].found
    return {
        "analysis": softimpact.analyse(model, Q, ALONG),
        "factors": softimpact.impact_factors(model, Q, ALONG),
        "assessment": found,
        "history": found.history,
        "many": many,
    }


@pytest.mark.parametrize("kind", ["analysis", "factors", "assessment", "history", "many"])
def test_results_are_dictionaries_and_tables(results: dict[str, Record], kind: str) -> None:
    result = results[kind]
    assert json.loads(json.dumps(result.to_dict(), allow_nan=False)) == result.to_dict()
    frame = result.to_frame()
    assert isinstance(frame, pd.DataFrame)
    assert len(frame) == len(result.rows()) > 0
    assert not frame.columns.empty


@pytest.mark.parametrize("kind", ["analysis", "assessment", "history", "many"])
def test_figures_are_drawn_into_axes_given_or_their_own(
    results: dict[str, Record], kind: str
) -> None:
    given = Figure().add_subplot()
    assert results[kind].plot(given) is given
    own = results[kind].plot()
    for axes in (given, own):
        assert axes.get_title()
        assert axes.get_xlabel()
        assert axes.lines or axes.patches


def test_what_has_no_figure_says_so(results: dict[str, Record]) -> None:
    with pytest.raises(InvalidValue, match="no figure of a ImpactFactors"):
        results["factors"].plot()


def test_the_limit_is_in_the_picture(results: dict[str, Record]) -> None:
    axes = plots.plot(results["assessment"])
    assert axes.get_ylim()[1] > 280.0


def test_frames_say_what_they_need(
    results: dict[str, Record], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "pandas", None)
    with pytest.raises(NeedsPackage, match="needs pandas: pip install pandas"):
        results["analysis"].to_frame()


def test_many_impacts_are_those_one_by_one(model: ImpactModel, many: Assessments) -> None:
    assert [case.point for case in many.cases] == ["hand_tcp"] * 4
    assert [case.region for case in many.cases] == ["chest", "hand"] * 2
    np.testing.assert_allclose([c.direction for c in many.cases], [ALONG, ALONG, DOWN, DOWN])
    alone = softimpact.assess_impact(model, softimpact.Approach(Q, DOWN, 0.3), on("hand"))
    assert many.cases[3].found.history.peak == alone.history.peak
    assert many.worst is max(many.cases, key=lambda case: case.found.verdict.share)
    assert many.safe_speed is None
    frame = many.to_frame()
    assert frame.loc[3, "peak"] == alone.history.peak
    assert frame["peak"].max() == many.worst.found.history.peak


@pytest.mark.slow
def test_points_of_many_impacts(model: ImpactModel) -> None:
    points = ["hand_tcp", "link5@0,0.05,-0.1"]
    steps: list[tuple[int, int]] = []
    found = softimpact.assess_impacts(
        model,
        Q,
        [ALONG],
        [on("chest")],
        speed=0.3,
        points=points,
        safe_speed=True,
        on_case=lambda done, of: steps.append((done, of)),
    )
    assert [case.point for case in found.cases] == points
    assert steps == [(1, 2), (2, 2)]
    speeds = [case.found.safe_speed for case in found.cases]
    assert found.safe_speed == min(speed for speed in speeds if speed is not None)
    with pytest.raises(FrameNotFound):
        softimpact.assess_impacts(model, Q, [ALONG], [on("chest")], speed=0.3, points=["nose"])
    with pytest.raises(InvalidValue, match="need one of each"):
        softimpact.assess_impacts(model, Q, [], [on("chest")], speed=0.3)


def test_a_list_of_poses_is_refused_in_words(model: ImpactModel) -> None:
    with pytest.raises(InvalidValue, match="q: must be a flat list of numbers, not 3 of them"):
        softimpact.analyse(model, [Q, Q, Q], ALONG)


def test_several_impacts_on_the_command_line(many: Assessments) -> None:
    asked = ["--direction", "0,0,-1", "--region", "chest", "--region", "hand", "--speed", "0.3"]
    found = run_json("simulate", *TYPED, *asked)
    peaks = [record["peak"] for record in found["impacts"]]
    assert peaks == pytest.approx([case.found.history.peak for case in many.cases[2:]], rel=1e-9)
    assert found["worst"] == many.cases.index(many.worst) - 2
    assert found["safe_speed"] is None


@pytest.mark.slow
def test_a_table_of_several_impacts() -> None:
    asked = ["--direction", "0,0,-1", "--region", "chest", "--region", "hand", "--speed", "0.3"]
    table = run("simulate", *TYPED, *asked).out
    assert table.count("(held)") == 2
    assert table.count("worst") == 1


def test_several_analyses_on_the_command_line(model: ImpactModel) -> None:
    asked = ("--direction", "0,1,0", "--direction", "0,0,-1", "--tip", "hand_tcp", "--tip", "link5")
    found = run_json("analyze", *TYPED, *asked)["analyses"]
    assert [(a["tip"], a["direction"]) for a in found] == [
        (tip, direction) for tip in ("hand_tcp", "link5") for direction in (ALONG, DOWN)
    ]
    assert found[1]["m_c"] == pytest.approx(softimpact.analyse(model, Q, DOWN).m_c)
    assert run("analyze", *TYPED, *asked).out.count("link5") == 2


def test_bad_input_among_several_is_found_before_the_work(
    monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    def work(*arguments: object) -> None:
        raise AssertionError("nothing may be simulated")

    monkeypatch.setattr("softimpact.studio.impact.impacts.impact", work)
    asked = ("--direction", "0,1,0", "--region", "chest", "--region", "nose", "--speed", "0.3")
    assert "unknown body region 'nose'" in refusal("simulate", *TYPED, *asked)
    asked = ("--direction", "0,1,0", "--region", "chest", "--region", "hand", "--speed", "0.3")
    report = ("--report", tmp_path / "report.html")
    assert "report: is of one impact" in refusal("simulate", *TYPED, *asked, *report)


def test_springs_stiffer_than_any_are_rigid(model: ImpactModel) -> None:
    """A simulation would follow vibrations of a megahertz, for minutes."""
    stiff, rigid = (
        softimpact.impact_model(
            model.robot, drives=softimpact.drives(model.robot, joint_stiffness=k)
        )
        for k in (1e12, np.inf)
    )
    assert stiff.drives.elastic == rigid.drives.elastic == (False,) * 7
    nearly = softimpact.drives(model.robot, joint_stiffness=1e7)
    near = softimpact.impact_model(model.robot, drives=nearly)
    peaks = [
        softimpact.assess_impact(m, softimpact.Approach(Q, ALONG, 0.5), on("chest")).history.peak
        for m in (stiff, near)
    ]
    assert peaks[0] == pytest.approx(peaks[1], rel=2e-3)
    typed = ("panda", *TYPED[1:3], "--direction", "0,1,0", "--joint-stiffness", "1e12")
    assert run_json("analyze", *typed)["warnings"] == [
        "joints of 1e+09 N·m/rad and more count as rigid"
    ]


@pytest.mark.slow
def test_designs_are_dictionaries_tables_and_figures(tmp_path: Path) -> None:
    study = study_of(tmp_path, None, ("q9",))
    found = softimpact.design(study, executor=InProcess())
    told = found.to_dict()
    assert json.loads(json.dumps(told, allow_nan=False)) == told
    assert "study" not in told
    frame = found.to_frame()
    assert list(frame["pose"]) == ["q9", "q9"]
    assert frame["force"].min() == found.winner.force
    assert {"q_joint1", "k_joint7", "force_before", "deflection"} <= set(frame.columns)
    assert len(found.plot().lines) == 3
