# SPDX-License-Identifier: BSD-3-Clause
"""Figures show what the report holds, on any robot, whatever the solver did."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from design_reports import panda_report, ur5_report
from matplotlib.image import imread
from matplotlib.text import Annotation, Text
from mpl_toolkits.mplot3d.axes3d import Axes3D
from pages import well_formed

from softimpact.optimize.posture.tip_pose import tip_pose
from softimpact.studio.design.report import DesignReport, gains_in_words
from softimpact.studio.figures import (
    draw_figures,
    figure_of_forces,
    figure_of_gains,
    figure_of_postures,
    figure_of_ranking,
    figure_of_springs,
)
from softimpact.studio.report.design_pages import write_design_report
from softimpact.symbolic import Contact, body_region


@pytest.fixture(scope="module")
def panda(tmp_path_factory: pytest.TempPathFactory) -> DesignReport:
    return panda_report(tmp_path_factory.mktemp("panda"))


@pytest.fixture(scope="module")
def ur5(tmp_path_factory: pytest.TempPathFactory) -> DesignReport:
    return ur5_report(tmp_path_factory.mktemp("ur5"))


def _with_first_free(report: DesignReport, **changes: Any) -> DesignReport:
    """Return the report with another outcome in free mode for the pose of rank 1."""
    first, *rest = report.poses
    assert first.result.free is not None
    free = replace(first.result.free, **changes)
    poses = (replace(first, result=replace(first.result, free=free)), *rest)
    return replace(report, poses=poses)


def _shifted(report: DesignReport, shift: float) -> DesignReport:
    """Return the report of a table mode with other forces."""
    poses = []
    for pose in report.poses:
        result = pose.result
        assert result.table is not None
        table = replace(result.table, force=result.table.force + shift)
        before = result.force_before + shift
        poses.append(replace(pose, result=replace(result, table=table, force_before=before)))
    return replace(report, poses=tuple(poses))


def _line(axes: Any, label: str) -> Any:
    """The one line whose label begins so."""
    (line,) = [line for line in axes.lines if line.get_label().startswith(label)]
    return line


def _words(figure: Any) -> list[str]:
    return [text.get_text() for text in figure.findobj(Text) if text.get_visible()]


def _figures(report: DesignReport) -> list[Any]:
    gains = report.design.gains
    return [
        figure_of_forces(report),
        figure_of_ranking(report),
        figure_of_postures(report),
        figure_of_springs(report),
        *([] if gains is None else [figure_of_gains(report, gains)]),
    ]


@pytest.mark.slow
def test_all_figures_are_written(panda: DesignReport, tmp_path: Path) -> None:
    names = ["force_over_time", "ranking", "postures", "springs", "gains"]
    assert draw_figures(panda, tmp_path) == [tmp_path / f"{name}.png" for name in names]
    for path in tmp_path.iterdir():
        image = imread(path)
        assert image.shape[0] > 300
        assert image.shape[1] > 1000
        assert image.std() > 0.01


def test_gains_need_both_modes(ur5: DesignReport, tmp_path: Path) -> None:
    names = {path.stem for path in draw_figures(ur5, tmp_path)}
    assert names == {"force_over_time", "ranking", "postures", "springs"}


def test_the_same_report_gives_the_same_bytes(ur5: DesignReport, tmp_path: Path) -> None:
    folders = [tmp_path / "one", tmp_path / "two"]
    for folder in folders:
        folder.mkdir()
        draw_figures(ur5, folder)
    for path in folders[0].iterdir():
        assert path.read_bytes() == (folders[1] / path.name).read_bytes()


@pytest.mark.parametrize("name", ["ur5", pytest.param("panda", marks=pytest.mark.slow)])
def test_text_is_legible_and_inside_the_figure(name: str, request: pytest.FixtureRequest) -> None:
    for figure in _figures(request.getfixturevalue(name)):
        figure.draw_without_rendering()
        shown = [t for t in figure.findobj(Text) if t.get_visible() and t.get_text().strip()]
        assert min(text.get_size() for text in shown) >= 9
        box = figure.get_tightbbox()
        width, height = figure.get_size_inches()
        assert 0 <= box.x0 < box.x1 <= width
        assert 0 <= box.y0 < box.y1 <= height


@pytest.mark.parametrize("name", ["ur5", pytest.param("panda", marks=pytest.mark.slow)])
def test_forces_are_those_of_the_impact(name: str, request: pytest.FixtureRequest) -> None:
    report: DesignReport = request.getfixturevalue(name)
    figure = figure_of_forces(report)
    (axes,) = figure.axes
    ends = []
    for label, history in (("winner", report.winner_history), ("worst", report.worst_history)):
        time, force = _line(axes, label).get_data()
        apart = history.time[(history.time > history.time_of_peak) & (history.force <= 0)]
        assert time[-1] == pytest.approx(1e3 * apart[0])
        assert force[-1] == 0.0
        np.testing.assert_allclose(
            np.interp(time[:-1], 1e3 * history.time, history.force), force[:-1]
        )
        assert force.max() == pytest.approx(history.peak, rel=1e-3)
        assert any(f"{label}: {history.peak:.1f} N at " in words for words in _words(figure))
        ends.append(time[-1])
    assert axes.get_xlim() == (0.0, max(ends))
    limit = [line for line in axes.lines if "ISO/TS 15066" in str(line.get_label())]
    assert np.unique(limit[0].get_ydata()) == [report.limit]


def test_a_cut_history_is_drawn_to_its_end(ur5: DesignReport) -> None:
    history = ur5.worst_history
    early = history.time < 1.1 * history.time_of_peak
    short = replace(history, time=history.time[early], force=history.force[early])
    cut = replace(ur5, worst_history=short, winner_history=short)
    time = _line(figure_of_forces(cut).axes[0], "worst").get_xdata()
    assert time[-1] == pytest.approx(1e3 * short.time[-1])


def test_peaks_late_in_the_contact_are_named_on_the_left(ur5: DesignReport) -> None:
    end = 1e-3 * _line(figure_of_forces(ur5).axes[0], "worst").get_xdata()[-1]
    late = replace(ur5.worst_history, time_of_peak=0.9 * end)
    (axes,) = figure_of_forces(replace(ur5, worst_history=late, winner_history=late)).axes
    assert [text.get_horizontalalignment() for text in axes.texts] == ["left", "left"]


@pytest.mark.slow
def test_ranking_shows_every_force_in_its_row(panda: DesignReport) -> None:
    figure = figure_of_ranking(panda)
    (axes,) = figure.axes
    results = [pose.result for pose in panda.poses]
    series = {
        "before": [result.force_before for result in results],
        "after: springs designed": [result.table.force for result in results if result.table],
        "after: springs and posture": [result.free.force for result in results if result.free],
    }
    for label, forces in series.items():
        shown, ranks = _line(axes, label).get_data()
        np.testing.assert_array_equal(shown, forces)
        np.testing.assert_array_equal(ranks, [1, 2, 3])
        low, high = axes.get_xlim()
        assert low < min(forces) <= max(forces) < high


@pytest.mark.slow
def test_ranking_marks_recovered_and_turned_poses(panda: DesignReport) -> None:
    figure = figure_of_ranking(panda)
    rows = {label.get_text().split(".  ")[1] for label in figure.axes[0].get_yticklabels()}
    assert rows == {"q9", "q19*", "q22~"}
    legend = [text.get_text() for text in figure.legends[0].get_texts()]
    assert any("recovered" in words for words in legend)
    assert any("turned" in words for words in legend)


def test_ranking_explains_no_marks_that_do_not_occur(ur5: DesignReport) -> None:
    words = " ".join(text.get_text() for text in figure_of_ranking(ur5).legends[0].get_texts())
    assert "recovered" not in words
    assert "turned" not in words
    assert "not solved" not in words


@pytest.mark.parametrize(("region", "side"), [("face", "left"), ("thigh", "right")])
def test_ranking_says_where_a_far_limit_is(ur5: DesignReport, region: str, side: str) -> None:
    shift = 120.0  # to forces of 190 to 211 N, between the limits of 65 and 440 N
    contact = Contact(body_region(region))
    study = replace(ur5.study, contact=contact)
    report = replace(_shifted(ur5, shift), design=replace(ur5.design, study=study))
    (axes,) = figure_of_ranking(report).axes
    assert f"beyond the axis to the {side}" in axes.get_xlabel()
    assert f"{contact.region.force_limit:g} N" in axes.get_xlabel()
    assert not [line for line in axes.lines if "limit" in str(line.get_label())]


def test_ranking_shows_a_limit_that_is_near(ur5: DesignReport) -> None:
    (axes,) = figure_of_ranking(_shifted(ur5, 190.0)).axes  # to 260 to 281 N; the limit is 280 N
    (line,) = [line for line in axes.lines if "limit" in str(line.get_label())]
    assert np.unique(line.get_xdata()) == [ur5.limit]
    assert axes.get_xlim()[0] < ur5.limit < axes.get_xlim()[1]
    assert "beyond" not in axes.get_xlabel()


@pytest.mark.slow
@pytest.mark.parametrize("force", [1e9, np.nan])
def test_ranking_crosses_what_was_not_solved(panda: DesignReport, force: float) -> None:
    report = _with_first_free(panda, solved=False, force=force)
    (axes,) = figure_of_ranking(report).axes
    crosses = _line(axes, "not solved")
    assert crosses.get_data()[0].tolist() == [axes.get_xlim()[1]]
    assert list(crosses.get_data()[1]) == [1]
    assert list(_line(axes, "after: springs and posture").get_ydata()) == [2, 3]
    assert axes.get_xlim()[1] < 1e4


def _sticks(figure: Any, axes: int) -> list[Sequence[Any]]:
    """Data of the postures' lines: those with more points than the base's mark."""
    lines = figure.axes[axes].lines
    data = [line.get_data_3d() if axes == 0 else line.get_data() for line in lines]
    return [coordinates for coordinates in data if len(coordinates[0]) > 1]


@pytest.mark.parametrize("name", ["ur5", pytest.param("panda", marks=pytest.mark.slow)])
def test_postures_run_from_the_base_to_the_tip(name: str, request: pytest.FixtureRequest) -> None:
    report: DesignReport = request.getfixturevalue(name)
    figure = figure_of_postures(report)
    worst, winner = report.worst.candidate.q, report.design.winner.q
    postures = [*(pose.result.candidate.q for pose in report.poses), worst, winner]
    sticks = _sticks(figure, 0)
    assert len(sticks) == len(postures)
    for stick, q in zip(sticks, postures, strict=True):
        points = np.array(stick)
        assert points.shape == (3, report.study.robot.n + 2)
        np.testing.assert_array_equal(points[:, 0], np.zeros(3))
        np.testing.assert_allclose(points[:, -1], tip_pose(report.study.model, q)[0], atol=1e-12)
    for view, plane in ((1, [0, 1]), (2, [1, 2])):
        for stick, flat in zip(sticks, _sticks(figure, view), strict=True):
            np.testing.assert_array_equal(np.array(stick)[plane], np.array(flat))


@pytest.mark.slow
def test_postures_show_the_files_own_joint_frames(panda: DesignReport) -> None:
    robot = panda.study.robot
    points = np.array(_sticks(figure_of_postures(panda), 0)[-1])
    lengths = np.linalg.norm(np.diff(points, axis=1), axis=0)
    placements = [joint.placement.translation for joint in robot.joints]
    placements.append(robot.frame(panda.study.model.tip).placement.translation)
    np.testing.assert_allclose(lengths, [np.linalg.norm(p) for p in placements], atol=1e-12)


def test_postures_have_equal_axes_and_hold_all(ur5: DesignReport) -> None:
    figure = figure_of_postures(ur5)
    space = figure.axes[0]
    assert isinstance(space, Axes3D)
    limits = np.array([space.get_xlim(), space.get_ylim(), space.get_zlim()])
    np.testing.assert_allclose(np.ptp(limits, axis=1), np.ptp(limits[0]))
    points = np.hstack([np.array(stick) for stick in _sticks(figure, 0)])
    assert (limits[:, 0] < points.min(axis=1)).all()
    assert (points.max(axis=1) < limits[:, 1]).all()


def test_the_arrow_points_along_the_impact_from_the_winners_tip(ur5: DesignReport) -> None:
    figure = figure_of_postures(ur5)
    tip = tip_pose(ur5.study.model, ur5.design.winner.q)[0]
    for view, plane in ((1, [0, 1]), (2, [1, 2])):
        (arrow,) = figure.axes[view].texts
        assert isinstance(arrow, Annotation)
        start, end = np.array(arrow.xyann), np.array(arrow.xy)
        np.testing.assert_allclose(start, tip[plane], atol=1e-12)
        expected = ur5.study.direction[plane] / np.linalg.norm(ur5.study.direction[plane])
        np.testing.assert_allclose((end - start) / np.linalg.norm(end - start), expected)


@pytest.mark.parametrize("name", ["ur5", pytest.param("panda", marks=pytest.mark.slow)])
def test_springs_stand_over_their_joints(name: str, request: pytest.FixtureRequest) -> None:
    report: DesignReport = request.getfixturevalue(name)
    study = report.study
    (axes,) = figure_of_springs(report).axes
    joints, stiffness = _line(axes, "winner").get_data()
    np.testing.assert_array_equal(joints, np.arange(study.robot.n))
    np.testing.assert_array_equal(stiffness, report.design.winner.springs)
    bars = axes.containers[0]
    np.testing.assert_allclose([bar.get_y() for bar in bars], study.lower)
    np.testing.assert_allclose([bar.get_y() + bar.get_height() for bar in bars], study.upper)
    assert axes.get_yscale() == "log"
    assert [label.get_text() for label in axes.get_xticklabels()] == list(study.robot.joint_names)


@pytest.mark.slow
def test_springs_of_the_others_leave_out_the_winner(panda: DesignReport) -> None:
    shown = _line(figure_of_springs(panda).axes[0], "other outcomes").get_ydata()
    others = [o for o in panda.design.outcomes("free") if o is not panda.design.winner]
    assert sorted(shown) == sorted(np.concatenate([outcome.springs for outcome in others]))


@pytest.mark.slow
def test_springs_leave_out_what_was_not_solved(panda: DesignReport) -> None:
    report = _with_first_free(panda, solved=False)
    shown = _line(figure_of_springs(report).axes[0], "other outcomes").get_ydata()
    assert len(shown) == 2 * panda.study.robot.n


@pytest.mark.slow
def test_gains_are_bars_from_zero(panda: DesignReport) -> None:
    gains = panda.design.gains
    assert gains is not None
    figure = figure_of_gains(panda, gains)
    forces, speeds = figure.axes
    heights = [bar.get_height() for bar in forces.containers[0]]
    assert heights == [gains.before, gains.springs, gains.posture, gains.both]
    safe = [bar.get_height() for bar in speeds.containers[0]]
    assert safe == [panda.speed_before, panda.speed_after]
    assert forces.get_ylim()[0] == speeds.get_ylim()[0] == 0.0
    assert forces.get_ylim()[1] > panda.limit
    assert f"{100 * (1 - gains.both / gains.before):.1f} %" in " ".join(_words(figure))


def test_the_report_is_one_page_with_the_answer(panda: DesignReport, tmp_path: Path) -> None:
    page = write_design_report(panda, tmp_path / "design.html").read_text("utf-8")
    assert well_formed(page)
    winner = panda.design.winner
    assert f"{winner.name}, posture free: {winner.force:.0f} N, which breaks the limit" in page
    assert page.count("<svg ") >= 5
    for joint in panda.study.robot.joint_names:
        assert joint in page


def test_an_arm_without_other_postures_shows_none(panda: DesignReport) -> None:
    """One pose that was held: no bar of posture, no ranking of one, no faint poses."""
    gains = panda.design.gains
    assert gains is not None
    first = panda.poses[0]
    held = replace(first, result=replace(first.result, free=None))
    report = replace(panda, poses=(held,))
    forces, speeds = figure_of_gains(report, gains).axes
    assert [label.get_text() for label in forces.get_xticklabels()] == ["before", "springs"]
    assert [label.get_text() for label in speeds.get_xticklabels()] == ["before", "springs"]
    told = " ".join(gains_in_words(gains, report))
    assert "Posture alone" not in told
    assert "All, as there is no other posture" in told
    name = first.result.candidate.pose.name
    words = " ".join(_words(figure_of_ranking(report)))
    assert f"Peak force of {name}: {held.result.force_before:.1f} N before" in words
    words = " ".join(_words(figure_of_postures(report)))
    assert "all 1 poses" not in words
    assert "Posture as given and as designed" in words
    assert "before: " in " ".join(_words(figure_of_forces(report)))
