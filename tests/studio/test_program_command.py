# SPDX-License-Identifier: BSD-3-Clause
"""``softimpact program``."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import refusal, run
from pages import well_formed

from softimpact.symbolic import load_robot

Found = dict[str, Any]

PANDA = load_robot("panda")
REST = np.array([0, 0.3, 0, -2, 0, 2, 0.8])


@pytest.fixture(scope="module")
def motion(tmp_path_factory: pytest.TempPathFactory) -> Path:
    t = np.linspace(0, 2, 9)
    q = REST + np.outer(np.sin(np.pi * t / 2) ** 2, [0.8, 0.3, 0.2, 0.4, 0.1, 0.2, 0])
    path = tmp_path_factory.mktemp("program") / "motion.csv"
    header = ",".join(("t", *PANDA.joint_names))
    np.savetxt(path, np.column_stack([t, q]), delimiter=",", header=header, comments="")
    return path


QUICK = ("--motors", "driven", "--joint-stiffness", 1e4, "--horizon", 0.05, "--free")
"""Fewer and shorter impacts."""


@pytest.fixture(scope="module")
def result(motion: Path, tmp_path_factory: pytest.TempPathFactory) -> tuple[Found, Path]:
    out = tmp_path_factory.mktemp("program") / "out"
    where = ("--model", "panda", "--points", "hand_tcp", "link5@0,0.05,-0.1")
    outcome = run(
        "program", motion, *where, "--regions", "hand", "chest", *QUICK, "--out", out, "--json"
    )
    assert outcome.code == 0
    return json.loads(outcome.out), out


def test_json_has_an_entry_a_sample(result: tuple[Found, Path]) -> None:
    found, _ = result
    count = len(found["time"])
    assert count == len(found["factor"]) == len(found["binding"]) == 9
    assert all(0 < factor <= 1 for factor in found["factor"])
    for factor, binding in zip(found["factor"], found["binding"], strict=True):
        assert (binding is None) == (factor == 1)
        if binding:
            assert binding["factor"] == factor
            assert binding["point"] in found["points"] == ["hand_tcp", "link5@0,0.05,-0.1"]
            assert binding["region"] in found["regions"] == ["hand", "chest"]
            assert binding["limit"].startswith("transient")
            assert binding["safe_speed"] == pytest.approx(factor * binding["speed"])
    assert found["time_before"] == pytest.approx(2)
    assert found["time_after"] > 2


def test_worst_moments(result: tuple[Found, Path]) -> None:
    worst = result[0]["worst"]
    assert len(worst) == 5
    assert worst[0]["factor"] == min(result[0]["factor"])
    assert worst[0]["q"] == pytest.approx(worst[0]["q"])
    assert {"t", "point", "region", "limit", "motors", "direction", "peak"} <= set(worst[0])


def test_files(result: tuple[Found, Path]) -> None:
    found, out = result
    names = {path.name for path in out.iterdir()}
    assert names == {
        "results.json",
        "program.csv",
        "points.csv",
        "program.png",
        "speed_factor.casadi",
    }
    with (out / "program.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [float(row["factor"]) for row in rows] == pytest.approx(found["factor"])
    with (out / "points.csv").open() as file:
        points = list(csv.DictReader(file))
    assert {row["point"] for row in points} == set(found["points"])
    least = min(points, key=lambda row: float(row["factor"]))
    assert float(least["factor"]) == pytest.approx(min(found["factor"]))
    assert json.loads((out / "results.json").read_text())["factor"] == found["factor"]


def test_coarse_motions_are_called_so(result: tuple[Found, Path]) -> None:
    assert any("cm between samples" in line for line in result[0]["warnings"])


def test_table(motion: Path) -> None:
    outcome = run(
        *("program", motion, "--model", "panda", "--points", "hand_tcp"),
        *("--regions", "hand", *QUICK, "--band"),
    )
    assert outcome.code == 0
    assert "2 s become" in outcome.out
    assert "hand_tcp" in outcome.out
    assert "95 of 100 cases" in outcome.out


def test_points_by_default_are_the_end_and_some_along_the_arm() -> None:
    from softimpact.studio.program.program import default_points

    points = default_points(PANDA, REST)
    assert points[0] == "hand_tcp"
    assert 2 <= len(points) <= 6


def test_points_that_stay_where_they_are_are_not_watched_by_default(motion: Path) -> None:
    found = run_json_with_warnings(
        "program", motion, "--model", "panda", "--regions", "hand", *QUICK
    )
    assert found["points"][0] == "hand_tcp"
    assert "link1" not in found["points"]


def test_options_may_be_repeated_instead(motion: Path) -> None:
    found = run_json_with_warnings(
        *("program", motion, "--model", "panda", "--points", "hand_tcp", "--points", "link6"),
        *("--regions", "hand,chest", *QUICK),
    )
    assert found["points"] == ["hand_tcp", "link6"]
    assert found["regions"] == ["hand", "chest"]


def run_json_with_warnings(*arguments: object) -> Found:
    outcome = run(*arguments, "--json")
    assert outcome.code == 0
    assert all(line.startswith("warning: ") for line in outcome.err.splitlines())
    return dict(json.loads(outcome.out))


def arguments(motion: Path, *more: object) -> tuple[object, ...]:
    return ("program", motion, "--model", "panda", "--points", "hand_tcp", "--regions", *more)


@pytest.mark.parametrize(
    ("more", "reason"),
    [
        (("nose",), "unknown body region 'nose'"),
        (("device_75_sh70",), "regions: 'device_75_sh70' has no limits to be kept"),
        (("hand", "--motors", "held", "--position-gain", 1), "cannot give a safe program"),
        (("hand", "--horizon", 0), "horizon: must be"),
        (("hand", "--end", "elbow"), "unknown frame 'elbow'"),
        (("hand", "--reaction-time", -1), "reaction_time: must be"),
        (("hand", "--payload", "x"), "payload"),
    ],
)
def test_options_that_cannot_be(motion: Path, more: tuple[object, ...], reason: str) -> None:
    assert reason in refusal(*arguments(motion, *more))


def test_points_that_cannot_be(motion: Path) -> None:
    where = ("program", motion, "--model", "panda", "--regions", "hand", "--points")
    assert "unknown frame 'nose'" in refusal(*where, "nose")
    assert "points: 'link0' never moves" in refusal(*where, "link0")


def test_motions_that_cannot_be(tmp_path: Path) -> None:
    path = tmp_path / "motion.csv"
    path.write_text("t,joint1\n0,0\n")
    assert "has no column for joint 'joint2'" in refusal(*arguments(path, "hand"))
    assert "No such file" in refusal(*arguments(tmp_path / "none.csv", "hand"))


def test_earlier_files_of_others_stay(motion: Path, tmp_path: Path) -> None:
    (tmp_path / "mine.txt").write_text("keep")
    assert "choose another folder" in refusal(*arguments(motion, "hand", "--out", tmp_path))
    assert (tmp_path / "mine.txt").read_text() == "keep"


def test_unknown_rotors_keep_driving(tmp_path: Path) -> None:
    """The Gen3 states none: the worse case, and a line that says so."""
    robot = load_robot("gen3")
    path = tmp_path / "motion.csv"
    rows = [[0, *7 * [0.5]], [0.1, *7 * [0.5002]]]
    text = [",".join(("t", *robot.joint_names)), *(",".join(map(str, row)) for row in rows)]
    path.write_text("\n".join(text))
    found = run_json_with_warnings(
        *("program", path, "--model", "gen3", "--regions", "chest", "--points", "end_effector"),
        *("--joint-stiffness", 1e4, "--free", "--horizon", 0.02),
    )
    assert [*found["motors"]] == ["driven"]
    assert any("rotor inertia of joint" in line for line in found["warnings"])


def test_json_needs_no_folder(motion: Path) -> None:
    slow = ("--motors", "free", "--horizon", 0.02, "--free", "--points", "link6")
    found = run_json_with_warnings(
        "program", motion, "--model", "panda", "--regions", "abdomen", *slow
    )
    assert found["out"] is None


def test_the_report_is_one_page_with_the_answer(motion: Path, tmp_path: Path) -> None:
    path = tmp_path / "program.html"
    shape = ("--shape", "sphere:0.01")
    found = run_json_with_warnings(*arguments(motion, "hand", *QUICK, *shape, "--report", path))
    page = path.read_text("utf-8")
    assert well_formed(page)
    worst = found["worst"][0]
    assert f"It must slow down to {100 * worst['factor']:.0f} % at {worst['t']:.4g} s" in page
    assert worst["limit"] == "transient pressure"
    assert worst["pressure"] > 0
    assert page.count('<svg class="arm"') == 5
    assert "&#34;faint&#34;" in page


def test_a_motion_in_which_nothing_moves(tmp_path: Path) -> None:
    path = tmp_path / "still.csv"
    rows = np.array([[0.0, *REST], [1.0, *REST]])
    header = ",".join(("t", *PANDA.joint_names))
    np.savetxt(path, rows, delimiter=",", header=header, comments="")
    told = refusal("program", path, "--model", "panda", "--regions", "hand")
    assert "motion: moves no point of the arm" in told


def test_a_report_without_a_folder_is_refused_first(motion: Path, tmp_path: Path) -> None:
    told = refusal(*arguments(motion, "hand", "--report", tmp_path / "no" / "page.html"))
    assert "No such file or directory" in told
