# SPDX-License-Identifier: BSD-3-Clause
"""Packages over arrays: the same numbers as one call at a time, and errors that say what to do."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from compiled_packages import tool

from softimpact import batch
from softimpact.symbolic import InvalidValue, drives, impact_model, load_robot


@pytest.fixture(scope="module")
def rr(tmp_path_factory: pytest.TempPathFactory) -> Iterator[batch.CompiledPackage]:
    """RR with its elbow watched, in two threads, in a cache of its own."""
    tool("gcc")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("XDG_CACHE_HOME", str(tmp_path_factory.mktemp("cache")))
        yield batch.compiled("rr", rotor_inertia=0.5, points={"elbow": "O3"}, threads=2)


def poses(count: int) -> np.ndarray:
    """Return bent arms."""
    random = np.random.default_rng(1)
    q = np.zeros((count, 4))
    q[:, 0], q[:, 2] = random.uniform(-1, 1, count), random.uniform(0.5, 2, count)
    return q


def test_rows_are_what_one_call_says(rr: batch.CompiledPackage) -> None:
    q, n = poses(10_000), np.array([1.0, 0.5, 0.0])
    found = rr.reflected_mass(q, n)
    assert (found["status"] == 0).all()
    robot = load_robot("rr")
    model = impact_model(robot, drives_=drives(robot, rotor_inertia=0.5))
    for i in (0, 4_999, 9_999):
        right = float(model.reflected_mass(q[i], n / np.linalg.norm(n)))
        assert found["m_c"][i, ...] == pytest.approx(right, rel=1e-9)


def test_parameters_and_regions_may_differ_by_row(rr: batch.CompiledPackage) -> None:
    q, n = poses(4), [[1.0, 0.5, 0.0]]
    rotors = np.linspace(0.2, 2, 4)[:, None] * np.ones(4)
    together = rr.peak_force(q, n, 0.5, rotor_inertia=rotors, horizon=0.1, region="head")
    for i in range(4):
        alone = rr.peak_force(q[i], n, 0.5, rotor_inertia=rotors[i], horizon=0.1, region="head")
        assert alone["force"][0] == together["force"][i]
    free = rr.safe_speed(q, n, 280.0, motors="free", horizon=0.1)
    worse = rr.safe_speed(q, n, 280.0, horizon=0.1)
    assert (worse["speed"] <= 1.02 * free["speed"]).all()


def test_a_watched_elbow_can_bind(rr: batch.CompiledPackage) -> None:
    dq = np.zeros((50, 4))
    dq[:, 0], dq[:, 2] = 3.0, -3.0
    found = rr.speed_factor(poses(50), dq, 100.0, horizon=0.1)
    assert set(found["point"]) <= {0.0, 1.0}
    assert 1.0 in found["point"]
    assert ((found["factor"] > 0) & (found["factor"] <= 1)).all()


def test_wrong_rows_and_names_are_said(rr: batch.CompiledPackage) -> None:
    with pytest.raises(InvalidValue, match="rows of 4 numbers"):
        rr.reflected_mass(np.zeros((2, 3)), [1, 0, 0])
    with pytest.raises(InvalidValue, match="needs 3 rows or one"):
        rr.reflected_mass(poses(3), np.ones((2, 3)))
    with pytest.raises(InvalidValue, match=r"rotor_inertias.*nothing that"):
        rr.reflected_mass(poses(1), [1, 0, 0], rotor_inertias=1.0)
    with pytest.raises(InvalidValue, match="motors"):
        rr.peak_force(poses(1), [1, 0, 0], 0.5, motors="held")
    with pytest.raises(InvalidValue, match="region"):
        rr.peak_force(poses(1), [1, 0, 0], 0.5, region="nose")
    with pytest.raises(AttributeError, match="no function 'osim'"):
        _ = rr.osim


def test_without_a_compiler_it_says_what_else_there_is(
    rr: batch.CompiledPackage, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(batch, "COMPILERS", ("no-such-compiler",))
    monkeypatch.delenv("CC", raising=False)
    with pytest.raises(batch.NoCompiler, match=r"simulate one call at a time"):
        batch._built(rr.package)
