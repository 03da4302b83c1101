# SPDX-License-Identifier: BSD-3-Clause
"""``softimpact map``: the numbers are simulate's, and no direction is worse than the worst."""

from __future__ import annotations

import csv
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import refusal, run, run_json

from softimpact.batch import NoCompiler
from softimpact.simulate.sampled import Samples
from softimpact.simulate.sampled_speeds import safe_speeds
from softimpact.studio.map import worst_directions
from softimpact.studio.page.opened import opened
from softimpact.symbolic import (
    Contact,
    ImpactModel,
    Motors,
    Robot,
    SingularDirection,
    approach_velocity,
    body_region,
    drives,
    load_robot,
)

Q = "0,0.2,0,-1.8,0,2,0.78"
PANDA = ("panda", "--q", Q, "--joint-stiffness", 1e4)
COARSE = ("--step", 0.25, "--motors", "driven", "--horizon", 0.1, "--free")


def mapped(out: Path, *options: object) -> dict[str, Any]:
    outcome = run("map", *PANDA, *options, "--out", out, "--json")
    assert outcome.code == 0, outcome
    found = json.loads(outcome.out)
    assert isinstance(found, dict)
    return found


@pytest.mark.slow
def test_numbers_are_simulates(tmp_path: Path) -> None:
    found = mapped(tmp_path / "map", *COARSE, "--direction", "0,1,0", "--speed", 0.4)
    count = len(found["q"])
    assert count == len(found["safe_speed"]) == len(found["place"]) == len(found["cells"]) > 8
    assert found["direction"] == [[0, 1, 0]] * count
    for k in (0, count - 1):
        told = run_json(
            "simulate", "panda", "--q", ",".join(map(str, found["q"][k])), "--direction", "0,1,0",
            "--joint-stiffness", 1e4, "--region", "chest", "--free", "--speed", 0.4,
            "--motors", "driven", "--horizon", 0.1, "--safe-speed",
        )  # fmt: skip
        assert found["peak"][k] == pytest.approx(told["peak"], rel=2e-3)
        assert 0.99 * told["safe_speed"] < found["safe_speed"][k] <= told["safe_speed"]
    with (tmp_path / "map" / "map.csv").open(newline="") as file:
        rows = list(csv.DictReader(file))
    assert [float(row["safe_speed"]) for row in rows] == pytest.approx(found["safe_speed"])
    assert (tmp_path / "map" / "map.png").read_bytes().startswith(b"\x89PNG")
    assert found["slowest"]["safe_speed"] == min(found["safe_speed"])
    shown = opened(str(tmp_path / "map"))  # the page takes it
    assert shown.map is not None
    assert shown.map.axes == "xz"
    assert len(shown.map.q) == len(shown.map.place) == count
    assert shown.q.tolist() == found["q"][found["begun"]]
    assert (shown.kind, shown.body.clamped, shown.horizon) == ("driven", False, 0.1)


@pytest.mark.slow
def test_no_direction_is_worse_than_the_worst(tmp_path: Path) -> None:
    found = mapped(tmp_path / "map", *COARSE)
    robot = load_robot("panda")
    model = ImpactModel(robot, "hand_tcp", drives(robot, joint_stiffness=1e4))
    source = np.random.default_rng(4)
    rows, postures, directions, rates = [], [], [], []
    for k in range(0, len(found["q"]), 3):
        q = np.array(found["q"][k])
        for along in source.normal(size=(30, 3)):
            n = along / np.linalg.norm(along)
            try:
                rates.append(approach_velocity(model, q, n))
            except SingularDirection:
                continue
            rows.append(k)
            postures.append(q)
            directions.append(n)
    at = Samples(np.array(postures), np.array(directions), np.array(rates))
    chest = Contact(body_region("chest"), clamped=False)
    tried = np.full(len(rows), 8.0)
    speeds = safe_speeds(model, at, tried, chest, Motors("driven"), 0.1).safe
    compared = 0
    for k, q, n, speed in zip(rows, postures, directions, speeds, strict=True):
        reach = abs(n @ np.array(model.jacobian(q))) @ robot.speed_limits
        if speed < reach:  # in other directions the joints keep the tip slower
            assert found["safe_speed"][k] < 1.01 * speed
            compared += 1
    assert compared > len(rows) / 4


@pytest.mark.slow
def test_self_motion_is_mapped_along_its_arc(tmp_path: Path) -> None:
    found = mapped(
        tmp_path / "map", "--over", "self-motion", "--direction", "0,1,0",
        "--step", 0.3, "--motors", "driven", "--free",
    )  # fmt: skip
    assert (np.diff(found["arc"]) > 0).all()
    assert found["arc"][found["begun"]] == 0
    assert np.ptp(found["place"], axis=0).max() < 1e-7
    assert found["cells"] is found["grid"] is found["plane"] is None


def test_what_cannot_be_mapped_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    out = ("--out", tmp_path / "map")
    bare = (
        "map",
        "rr",
        "--q",
        "0.3,0.8,-0.4,0.9",
        *out,
        "--joint-stiffness",
        1e4,
        "--motors",
        "driven",
    )
    assert "behind a spring" in refusal(*bare)
    rr = ("map", "rr", "--q", "0.3,0.8,-0.4,0.9", *out)
    assert "step" in refusal(*rr, "--plane", "xy", "--step", 0)
    assert "self-motion" in refusal(*rr, "--over", "sphere")
    assert "xy" in refusal(*rr, "--plane", "zz")
    assert "pose" in refusal(*rr, "--hold", "nothing")
    assert "nose" in refusal(*rr, "--region", "nose")
    assert "held" in refusal(*rr, "--motors", "held", "--position-gain", 10)
    assert "moves nowhere" in refusal(*rr, "--direction", "0,0,1", "--step", 1)
    assert "seven joints" in refusal(*rr, "--over", "self-motion")
    assert "closed loops" in refusal("map", "rmin", *out)
    assert "no map can begin" in refusal("map", "panda", "--q", "0,0,0,1,0,2,0", *out)

    def missing(robot: Robot) -> None:
        raise NoCompiler

    monkeypatch.setattr(worst_directions, "compiled", missing)
    assert "no C compiler" in refusal(*rr, "--plane", "xy", "--step", 1)
    assert not (tmp_path / "map").exists()
