# SPDX-License-Identifier: BSD-3-Clause
"""Programs by the generated C are slowed down as Python slows them, from the safe side."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from command_line import refusal, run
from compiled_packages import tool

from softimpact.batch import NoCompiler, compiled_arm
from softimpact.simulate.bracket import bracket
from softimpact.simulate.sampled import SampledImpacts, Samples
from softimpact.simulate.zones import Somebody
from softimpact.studio.program import engine as program_engine
from softimpact.studio.program.engine import why_not_in_c
from softimpact.symbolic import (
    Contact,
    Motors,
    body_region,
    close_loops,
    drives,
    impact_model,
    load_robot,
)
from softimpact.symbolic.body.laws import PowerLaw

PANDA = load_robot("panda")
REST = np.array([0, 0.3, 0, -2, 0, 2, 0.8])
ZONES = """
everywhere = ["hand"]
[[zones]]
name = "desk"
regions = ["chest"]
box = [[-1.0, 0.4, 0.0], [1.0, 1.0, 2.0]]
"""
HELD = """
[[zones]]
name = "door"
regions = ["chest"]
time = [0.0, 0.4]
clamped = true
"""


@pytest.fixture(scope="module")
def files(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """A motion with a corner, and zones."""
    folder = tmp_path_factory.mktemp("engine")
    t = np.linspace(0, 2, 17)
    way = np.where(t < 1, t, 2 - t) + 0.3 * np.sin(3 * np.pi * t)
    q = REST + np.outer(way, [1.1, 0.4, 0.2, 0.5, 0.2, 0.3, 0])
    header = ",".join(("t", *PANDA.joint_names))
    table = np.column_stack([t, q])
    np.savetxt(folder / "motion.csv", table, delimiter=",", header=header, comments="")
    (folder / "zones.toml").write_text(ZONES)
    nowhere = ZONES.replace("[-1.0, 0.4, 0.0], [1.0, 1.0, 2.0]", "[5, 5, 5], [6, 6, 6]")
    (folder / "hand.toml").write_text(nowhere)
    (folder / "held.toml").write_text(ZONES + HELD)
    return folder / "motion.csv", folder / "zones.toml"


QUICK = ("--motors", "driven", "--joint-stiffness", 1e4, "--horizon", 0.02)


def answer(files: tuple[Path, Path], *more: object) -> dict[str, Any]:
    motion, zones = files
    outcome = run(
        *("program", motion, "--model", "panda", "--points", "hand_tcp", "link5"),
        *("--zones", zones, "--free", *more, "--json"),
    )
    assert outcome.code == 0, outcome.err
    return dict(json.loads(outcome.out))


@pytest.mark.slow
@pytest.mark.parametrize("elastic", [True, False], ids=["elastic, held", "rigid"])
def test_both_engines_agree_from_the_safe_side(files: tuple[Path, Path], elastic: bool) -> None:
    tool("gcc")
    motion, zones = files
    more: tuple[object, ...] = ("--horizon", 0.05)
    if elastic:
        zones = zones.with_name("held.toml")
        more = (*more, "--joint-stiffness", 1e4, "--motors", "driven")
    by_c, right = (answer((motion, zones), *more, "--engine", name) for name in ("c", "python"))
    factor, own = np.array(right["factor"]), np.array(by_c["factor"])
    assert (factor < 1).mean() > 0.2
    assert (own <= 1.001 * factor).all()
    assert (own >= 0.97 * factor).all()
    assert by_c["engine"]["name"] == "c"
    assert by_c["engine"]["largest_difference"] < 0.03
    assert by_c["iso"]["factor"] == pytest.approx(right["iso"]["factor"])
    same = [
        a["point"] == b["point"] and a["region"] == b["region"]
        for a, b in zip(by_c["binding"], right["binding"], strict=True)
        if a and b
    ]
    assert np.mean(same) > 0.9
    assert {row["region"] for row in right["binding"] if row} == {"chest", "hand"}


@pytest.mark.slow
def test_closed_chains_are_slowed_down_by_c(tmp_path: Path) -> None:
    tool("gcc")
    robot, t = load_robot("rmin"), np.linspace(0, 0.7, 9)
    way = np.sin(np.pi * t / 0.7)
    angles = np.array([-2.2794, -0.872665]) + np.outer(way, [-0.5, -0.4])
    q = [close_loops(robot, [*motors, 0.0, 0.0]) for motors in angles]
    header = ",".join(("t", *robot.joint_names))
    path, table = tmp_path / "motion.csv", np.column_stack([t, q])
    np.savetxt(path, table, delimiter=",", header=header, comments="")
    factors = []
    for engine in ("c", "python"):
        outcome = run(
            *("program", path, "--model", "rmin", "--points", "P", "O13", "--regions", "chest"),
            *("--motors", "driven", "--free", "--horizon", 0.03, "--engine", engine, "--json"),
        )
        assert outcome.code == 0, outcome.err
        factors.append(np.array(json.loads(outcome.out)["factor"]))
    by_c, right = factors
    assert (right < 0.9).any()
    assert (by_c <= 1.001 * right).all()
    assert (by_c >= 0.97 * right).all()


@pytest.mark.slow
def test_a_cover_of_any_law_is_known_to_c(files: tuple[Path, Path], tmp_path: Path) -> None:
    tool("gcc")
    foam = tmp_path / "foam.toml"
    foam.write_text('[law]\nkind = "curve"\ndepths = [0, 4e-3, 8e-3]\nforces = [0, 20, 300]\n')
    more = (*QUICK, "--cover", foam)
    by_c, right = (answer(files, *more, "--engine", name) for name in ("c", "python"))
    factor, own = np.array(right["factor"]), np.array(by_c["factor"])
    assert by_c["engine"]["name"] == "c"
    assert (factor < 1).mean() > 0.2
    assert (own <= 1.001 * factor).all()
    assert (own >= 0.97 * factor).all()


@pytest.mark.slow
def test_what_presses_late_is_never_missed() -> None:
    tool("gcc")
    numbers = drives(PANDA, joint_stiffness=5e3)
    model = impact_model(PANDA, drives=numbers)
    package = compiled_arm(PANDA, numbers, tip="hand_tcp")
    random = np.random.default_rng(7)
    q, rate = REST + random.uniform(-0.6, 0.6, (60, 7)), random.normal(size=(60, 7))
    velocity = np.array([np.array(model.jacobian(a)) @ b for a, b in zip(q, rate, strict=True)])
    speed = np.linalg.norm(velocity, axis=1)
    at = Samples(q, velocity / speed[:, None], rate / speed[:, None])
    found = set()
    for reaction, rounds in ((0.02, 5.0), (0.45, 5.0), (np.inf, 5.0)):
        chest = Contact(body_region("chest"), clamped=True)
        impacts = SampledImpacts(model, at, chest, Motors("driven", reaction), 0.5)
        presses = impacts.peaks(speed).pressing > 140.0
        found_by_c = package.may_press(
            q,
            rate,
            140.0,
            region="chest",
            motors="driven",
            reaction_time=min(reaction, rounds),
            horizon=0.6,
            steps=100_000,
        )
        may = (found_by_c["may"] != 0) | (found_by_c["status"] != 0)
        assert (may | ~presses).all()
        found |= {bool(may.any()), bool(may.all())}
    assert found == {True, False}


def test_zones_say_where_and_when_somebody_is(files: tuple[Path, Path]) -> None:
    found = answer(files, *QUICK)
    bodies = {(body["region"], body["clamped"], *body["zones"]) for body in found["bodies"]}
    assert bodies == {("chest", False, "desk"), ("hand", False)}
    motion, zones = files
    alone = answer((motion, zones.with_name("hand.toml")), *QUICK)
    factor, hands = np.array(found["factor"]), np.array(alone["factor"])
    assert (factor <= hands).all()
    at_desk = np.array([bool(row and row["region"] == "chest") for row in found["binding"]])
    assert 0 < at_desk.sum() < len(factor)
    assert (factor[~at_desk] == hands[~at_desk]).all()


@pytest.mark.parametrize(
    ("text", "reason"),
    [
        ("", "zones: is missing"),
        ("zones = [", "not valid TOML"),
        ('[[zones]]\nname = "a"\nregions = ["hand"]\n', "give a box"),
        ('[[zones]]\nname = "a"\nregions = ["hand"]\ntime = [2, 1]\n', "a later end"),
        ('[[zones]]\nname = "a"\nregions = ["hand"]\nbox = [[0,0,0],[1,0,1]]\n', "upper corner"),
        ('[[zones]]\nname = "a"\nregions = ["nose"]\ntime = [1, 2]\n', "unknown body region"),
        ('[[zones]]\nname = "a"\nregion = ["hand"]\ntime = [1, 2]\n', "zones.0.regions"),
    ],
)
def test_zones_that_are_none(
    files: tuple[Path, Path], tmp_path: Path, text: str, reason: str
) -> None:
    path = tmp_path / "zones.toml"
    path.write_text(text)
    told = refusal("program", files[0], "--model", "panda", "--zones", path)
    assert reason in told


def test_what_c_does_not_know_is_named() -> None:
    elastic = impact_model(PANDA, drives=drives(PANDA, joint_stiffness=1e4))
    chest = [Somebody(Contact(body_region("chest")))]
    ends, _ = bracket(elastic, None)
    kinds = {kind: end for kind, end in ends.items() if isinstance(end, Motors)}
    assert why_not_in_c(elastic, chest, kinds) is None
    stops = {"driven": Motors("driven", reaction="stop")}
    assert why_not_in_c(elastic, chest, stops) == "motors that stop"
    skin = [Somebody(Contact(body_region("chest"), cover=PowerLaw(1e6, 1.2)))]
    assert why_not_in_c(elastic, skin, kinds) is None
    plate = replace(body_region("chest"), plate_mass=0.5)
    assert why_not_in_c(elastic, [Somebody(Contact(plate))], kinds) == "a device's plate"
    closed = load_robot("rmin")
    assert why_not_in_c(impact_model(closed), chest, kinds) is None
    springs = [1e4, np.inf, np.inf, 1e4, np.inf, np.inf]
    sprung = impact_model(closed, drives=drives(closed, springs, 0.1))
    assert "springs behind motors" in (why_not_in_c(sprung, chest, kinds) or "")


def test_without_a_compiler_python_does_it_and_says_so(
    files: tuple[Path, Path], monkeypatch: pytest.MonkeyPatch
) -> None:
    def missing(*_: object, **__: object) -> None:
        raise NoCompiler

    monkeypatch.setattr(program_engine, "compiled_arm", missing)
    monkeypatch.setattr("softimpact.studio.program.run.FEW", 10)
    found = answer(files, *QUICK)
    assert found["engine"] == {"name": "python"}
    assert any("no C compiler found" in line for line in found["warnings"])
    motion, zones = files
    told = refusal("program", motion, "--model", "panda", "--zones", zones, "--engine", "c")
    assert "engine: cannot be c: no C compiler found" in told
