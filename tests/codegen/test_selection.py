# SPDX-License-Identifier: BSD-3-Clause
"""Choosing among candidate poses in C: the same choice as Python's, from the same poses."""

from __future__ import annotations

import ctypes
import re
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from compiled_impacts import FREE_OR_DRIVEN, OK, SINGULAR, Impacts, Motion, choose
from compiled_packages import KINDS, Generated

from softimpact.codegen import generate_package
from softimpact.optimize import load_study
from softimpact.studio.design.selection import PoseFigures, ranking
from softimpact.symbolic import InvalidValue, load_robot
from softimpact.symbolic.robot.rigid import Array

STUDY = Path(__file__).parents[2] / "robots/studies/panda_24_poses.toml"


def select(
    compiled: Impacts, poses: Array, allowed: Array | None = None
) -> tuple[int, ctypes.Structure]:
    """Return status and choice for the study's impact, which is on a held chest."""
    study = load_study(STUDY)
    rotors = np.array(study.model.drives.rotors).ravel()
    parameters = np.array([np.broadcast_to(study.nominal, 7), rotors, *np.zeros((2, 7))])
    # as the study is silent: the worse of free motors and motors that drive on
    motion = Motion(FREE_OR_DRIVEN, 0.02, study.horizon)
    return choose(compiled, poses, study.direction, study.speed, parameters, allowed, motion)


@pytest.fixture(scope="module")
def ranked() -> dict[str, PoseFigures]:
    """The study's poses as ``softimpact select`` ranks them, on the whole linear robot."""
    return {pose.name: pose for pose in ranking(load_study(STUDY), "peak_force", "linearised")}


def table(generated: Generated, real: str) -> Array:
    """Return the built-in candidates."""
    kind = KINDS[real][0]
    rows = len(generated.manifest.poses)
    array = (kind * 7 * rows).in_dll(Impacts(generated, real).library, "panda_candidates")
    return np.array(array, dtype=float)


def test_candidates_are_the_poses_that_select_ranks(
    package: Callable[[str], Generated], ranked: dict[str, PoseFigures]
) -> None:
    generated = package("panda")
    names = generated.manifest.poses
    assert list(names) == [f"q{i}" for i in range(1, 25)]
    built_in = table(generated, "double")
    assert built_in == pytest.approx(np.array([ranked[name].q for name in names]), abs=1e-6)
    header = (generated.folder / "include/panda.h").read_text()
    assert re.search(r"#define PANDA_CANDIDATES 24\n", header)


@pytest.mark.parametrize("real", ["double", "float"])
def test_choice_is_that_of_the_whole_linear_robot(
    package: Callable[[str], Generated], ranked: dict[str, PoseFigures], real: str
) -> None:
    generated = package("panda")
    compiled, poses = Impacts(generated, real), table(generated, real)
    names, order = list(generated.manifest.poses), list(ranked)
    left = np.ones(24, dtype=bool)
    for name in order:  # the best of those left, again and again
        status, found = select(compiled, poses, left)
        assert status == OK
        assert found.usable == left.sum()
        force = ranked[names[found.best]].peak_force
        assert found.force == pytest.approx(force, rel=2e-3)
        best = ranked[name].peak_force
        assert force == pytest.approx(best, rel=4e-3)  # the same but for near ties
        left[names.index(name)] = False
    assert select(compiled, poses, left)[0] == SINGULAR


def test_margin_is_the_distance_to_the_second(package: Callable[[str], Generated]) -> None:
    compiled = Impacts(package("panda"), "double")
    poses = table(package("panda"), "double")
    _, found = select(compiled, poses)
    without = np.arange(24) != found.best
    _, rest = select(compiled, poses, without)
    assert rest.best == found.second
    assert rest.force == pytest.approx(found.force + found.margin, rel=1e-12)
    _, alone = select(compiled, poses[:1])
    assert (alone.best, alone.second, alone.usable, alone.margin) == (0, -1, 1, 0)


def test_singular_poses_are_left_out(package: Callable[[str], Generated]) -> None:
    compiled = Impacts(package("rr"), "double")
    stretched, bent = [0.0] * 4, [0.3, 0.0, 1.2, 0.0]
    along, parameters = np.array([1.0, 0.0, 0.0]), np.array([[0.5] * 4, *np.zeros((2, 4))])
    assert choose(compiled, np.array([stretched]), along, 0.5, parameters)[0] == SINGULAR
    poses = np.array([stretched, bent, stretched])
    status, found = choose(compiled, poses, along, 0.5, parameters)
    assert (status, found.best, found.second, found.usable) == (OK, 1, -1, 1)


@pytest.mark.parametrize(
    ("poses", "reason"),
    [
        ({"a": [0.0]}, "needs 4 finite numbers"),
        ({"a": [0.0, 0.0, 0.0, float("nan")]}, "needs 4 finite numbers"),
    ],
)
def test_bad_poses_are_refused(tmp_path: Path, poses: dict[str, list[float]], reason: str) -> None:
    with pytest.raises(InvalidValue, match=reason):
        generate_package(load_robot("rr"), tmp_path / "rr", poses=poses)


def test_poses_beyond_limits_are_refused(tmp_path: Path) -> None:
    with pytest.raises(InvalidValue, match="joint 'joint4' is beyond its limits"):
        generate_package(load_robot("panda"), tmp_path / "panda", poses={"a": [0.0] * 7})
