# SPDX-License-Identifier: BSD-3-Clause
"""``softimpact generate``; what is in a package is tested in ``codegen/``."""

from __future__ import annotations

from pathlib import Path

import pytest
from command_line import refusal, run, run_json

from softimpact.codegen import Payload, generate_package
from softimpact.studio.typed.pose_table import pose_table
from softimpact.symbolic import drives, load_robot

STUDY = Path(__file__).parents[2] / "robots/studies/panda_24_poses.toml"


def contents(folder: Path) -> dict[str, str]:
    return {
        path.relative_to(folder).as_posix(): path.read_text()
        for path in folder.rglob("*")
        if path.is_file()
    }


@pytest.mark.slow
def test_writes_what_the_library_writes(tmp_path: Path) -> None:
    typed, called = tmp_path / "typed", tmp_path / "called"
    options = ("--real", "float", "--position-gain", "[500, 0, 400, 0]", "--order", 2)
    result = run_json("generate", "rr", "--out", typed, *options)
    robot = load_robot("rr")
    gains = drives(robot, position_gain=[500, 0, 400, 0])
    manifest = generate_package(robot, called, real="float", drives=gains, chain_order=2)
    assert contents(typed) == contents(called)
    assert result["real"] == manifest.real == "float"
    assert result["chain_order"] == 2
    assert set(result["files"]) | {"manifest.json"} == set(contents(typed))


def test_table_for_people_and_a_prefix(tmp_path: Path) -> None:
    outcome = run("generate", "rr", "--out", tmp_path / "c", "--name", "my-elbow")
    assert outcome.code == 0
    warnings = [line for line in outcome.err.splitlines() if line.startswith("warning: ")]
    assert warnings == ["warning: 'my-elbow' cannot begin C names; they begin with 'my_elbow'"]
    for function in ("mass_matrix", "peak_force", "safe_speed", "speed_factor"):
        assert f"my_elbow_{function}" in outcome.out
    assert (tmp_path / "c/include/my_elbow.h").is_file()


@pytest.mark.parametrize(
    ("options", "reason"),
    [
        (["--real", "half"], "unknown number type 'half'; known: double, float"),
        (["--tip", "elbow"], "unknown frame 'elbow'; known: "),
        (["--order", "99"], "chain_order: must be from 1 to"),
        (["--gravity", "[0, 0]"], "gravity: has 2 values, but 3 are needed"),
        (["--rotor-inertia", "[1]"], "rotor_inertia: has 1 values, but 4 are needed"),
    ],
)
def test_bad_input(tmp_path: Path, options: list[str], reason: str) -> None:
    assert reason in refusal("generate", "rr", "--out", tmp_path / "c", *options)
    assert not (tmp_path / "c").exists()


@pytest.mark.slow
def test_candidate_poses_come_from_a_file(tmp_path: Path) -> None:
    path = tmp_path / "poses.json"
    path.write_text('{"low": [0.1, 0, 0.2, 0], "high": [1, 0, 1, 0]}')
    result = run_json("generate", "rr", "--out", tmp_path / "c", "--poses", path)
    assert result["poses"] == ["low", "high"]
    assert "RR_CANDIDATES 2" in (tmp_path / "c/include/rr.h").read_text()


def test_a_byte_order_mark_is_no_content(tmp_path: Path) -> None:
    path = tmp_path / "poses.json"
    path.write_text('{"low": [0.1, 0, 0.2, 0]}', encoding="utf-8-sig")
    assert pose_table(path, load_robot("rr")) == {"low": [0.1, 0, 0.2, 0]}


@pytest.mark.parametrize(
    ("name", "text", "reason"),
    [
        ("poses.json", "[[0, 0, 0]]", "poses.pose 0: needs 4 finite numbers"),
        ("poses.json", '{"low": "q"}', "must hold a list of lists of numbers"),
        ("poses.json", "[[", "poses.json: not valid JSON"),
        ("poses.toml", STUDY.read_text(), "is a study of 'panda'"),
    ],
)
def test_bad_poses(tmp_path: Path, name: str, text: str, reason: str) -> None:
    path = tmp_path / name
    path.write_text(text)
    assert reason in refusal("generate", "rr", "--out", tmp_path / "c", "--poses", path)
    assert not (tmp_path / "c").exists()


def test_unknown_robot(tmp_path: Path) -> None:
    assert "known: " in refusal("generate", "rrr", "--out", tmp_path / "c")


def test_a_file_in_the_way_stays(tmp_path: Path) -> None:
    path = tmp_path / "notes"
    path.write_text("mine")
    assert f"{path}: " in refusal("generate", "rr", "--out", path)
    assert f"{path}" in refusal("generate", "rr", "--out", path / "package")
    assert path.read_text() == "mine"


def test_foreign_files_stay(tmp_path: Path) -> None:
    (tmp_path / "notes.txt").write_text("mine")
    assert "notes.txt" in refusal("generate", "rr", "--out", tmp_path)
    assert contents(tmp_path) == {"notes.txt": "mine"}


@pytest.mark.slow
def test_failure_leaves_the_older_package(tmp_path: Path) -> None:
    folder = tmp_path / "c"
    assert run("generate", "rr", "--out", folder).code == 0
    before = contents(folder)
    refusal("generate", "rr", "--out", folder, "--order", "99")
    assert contents(folder) == before
    (folder / "README.md").write_text("edited")
    refusal("generate", "rr", "--out", folder)
    assert (folder / "README.md").read_text() == "edited"


@pytest.mark.slow
def test_payload_and_frozen_parameters(tmp_path: Path) -> None:
    typed, called = tmp_path / "typed", tmp_path / "called"
    options = ("--payload", "--payload-mass", 2, "--payload-com", "[0, 0, 0.125]", "--order", 2)
    result = run_json(
        "generate", "rr", "--out", typed, *options, "--freeze", "rotor_inertia, payload_mass"
    )
    generate_package(
        load_robot("rr"),
        called,
        drives=drives(load_robot("rr")),
        chain_order=2,
        payload=Payload(2.0, (0.0, 0.0, 0.125)),
        freeze=["rotor_inertia", "payload_mass"],
    )
    assert contents(typed) == contents(called)
    assert result["parameters"] == ["position_gain", "damping_gain", "payload_com"]
    assert result["frozen"]["payload_mass"] == [2.0]


@pytest.mark.parametrize(
    ("options", "field"),
    [
        (["--payload-mass", "1"], "payload_mass: is read with --payload only"),
        (["--payload-com", "[0, 0, 1]"], "payload_com: is read with --payload only"),
        (["--payload", "--payload-mass", "-1"], "payload_mass"),
        (["--payload", "--payload-com", "[0, 1]"], "payload_com"),
        (["--freeze", "joint_stiffness"], "joint_stiffness"),
        (["--freeze", "payload_mass"], "payload_mass"),
        (["--freeze", " "], "parameter to freeze"),
    ],
)
def test_refuses_inputs_without_meaning(tmp_path: Path, options: list[str], field: str) -> None:
    assert field in refusal("generate", "panda", "--out", tmp_path / "p", *options)
    assert not (tmp_path / "p").exists()


@pytest.mark.slow
def test_a_package_has_the_whole_arm(tmp_path: Path) -> None:
    """RR's elbow: the link beyond the contact point stays, as in ``analyze``."""
    elbow = ("generate", "rr", "--tip", "O3", "--rotor-inertia", 0.2)
    whole = run_json(*elbow, "--out", tmp_path / "whole")
    short = run_json(*elbow, "--end", "O3", "--out", tmp_path / "short")
    assert (len(whole["joints"]), len(short["joints"])) == (4, 2)


ONE_JOINT = """<mujoco model="main"><worldbody><body name="lever">
  <joint name="turn" axis="0 0 1" armature="0.1"/>
  <inertial mass="3" pos="0.3 0 0" diaginertia="0.01 0.1 0.1"/><site name="tip" pos="0.6 0 0"/>
</body></worldbody></mujoco>"""


def test_a_package_without_impacts_says_so_and_takes_no_points(tmp_path: Path) -> None:
    model = tmp_path / "lever.xml"
    model.write_text(ONE_JOINT)
    told = ("generate", model, "--tip", "tip", "--out", tmp_path / "c")
    assert "points: robot 'main' has no impacts" in refusal(
        *told, "--point", "middle=lever@0.2,0,0"
    )
    assert "warning: the package has no peak_force, safe_speed or speed_factor" in run(*told).err
