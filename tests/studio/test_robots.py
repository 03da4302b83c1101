# SPDX-License-Identifier: BSD-3-Clause
"""``softimpact robots``."""

from __future__ import annotations

from pathlib import Path

from command_line import run, run_json

from softimpact.robots import built_in_robots


def test_every_built_in_robot_is_listed() -> None:
    listed = {entry["name"]: entry for entry in run_json("robots")["robots"]}
    assert set(listed) == set(built_in_robots())
    panda = listed["panda"]
    assert panda["joints"] == [f"joint{i}" for i in range(1, 8)]
    assert panda["tip"] == "hand_tcp"
    assert "flange" in panda["frames"]
    assert panda["rotor_inertia_sets"]["menagerie_panda"] == [0.1] * 7
    assert Path(panda["source"]).is_file()


def test_table_for_people() -> None:
    outcome = run("robots")
    assert (outcome.code, outcome.err) == (0, "")
    for name in built_in_robots():
        assert name in outcome.out
