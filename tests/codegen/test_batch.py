# SPDX-License-Identifier: BSD-3-Clause
"""Packages over arrays: the same numbers as one call at a time, and errors that say what to do."""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Literal

import numpy as np
import pytest
from compiled_packages import run, tool

from softimpact import batch
from softimpact.batch import build
from softimpact.codegen import region_parameters
from softimpact.codegen.expressions import wide_sine
from softimpact.symbolic import (
    Contact,
    InvalidValue,
    PowerLaw,
    body_region,
    drives,
    impact_model,
    load_robot,
)


@pytest.fixture(scope="module")
def rr(tmp_path_factory: pytest.TempPathFactory) -> Iterator[batch.CompiledPackage]:
    """RR with its elbow watched, in two threads, in a cache of its own."""
    tool("gcc")
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("SOFTIMPACT_CACHE", str(tmp_path_factory.mktemp("cache")))
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
    model = impact_model(robot, drives=drives(robot, rotor_inertia=0.5))
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
    unasked = rr.safe_speed(q, n, region="chest", horizon=0.1)  # the region's own limit
    assert np.array_equal(unasked["speed"], worse["speed"])
    of_hand = rr.safe_speed(q, n, np.sqrt(2 * 75e3 * 0.49), region="hand", horizon=0.1)
    assert np.array_equal(
        rr.safe_speed(q, n, region="hand", horizon=0.1)["speed"], of_hand["speed"]
    )
    with pytest.raises(InvalidValue, match="'head' may not be hit at all; give a limit"):
        rr.safe_speed(q, n, region="head", horizon=0.1)
    assert (worse["speed"] <= 1.02 * free["speed"]).all()


@pytest.mark.slow
def test_without_a_limit_what_presses_later_counts_too(rr: batch.CompiledPackage) -> None:
    q, n = poses(6), [1.0, 0.5, 0.0]
    more: dict[str, Any] = {"motors": "driven", "reaction_time": 9.0, "steps": 20_000}
    plain = rr.safe_speed(q, n, 280.0, region="hand", **more)
    judged = rr.safe_speed(q, n, region="hand", **more)
    assert (judged["status"] == 0).all()
    assert (judged["speed"] <= plain["speed"]).all()
    assert judged["pressed"].any()
    dq = np.array([[0.3, 0, -0.5, 0]])
    slow = rr.speed_factor(q, dq, region="hand", **more)
    assert slow["pressed"].any()
    assert (
        rr.may_press(q, dq * slow["factor"][:, None], 140.0, region="hand", **more)["may"] == 0
    ).all()
    given = {"stiffness": 75e3, "effective_mass": 0.6, "hertz_stiffness": 19e6, "force_limit": 280}
    with pytest.raises(InvalidValue, match="no quasi_static_limit"):
        rr.safe_speed(q, n, region=given)
    free = rr.safe_speed(q, n, region=given, clamped=False, steps=8000)
    assert (free["status"] == 0).all()  # slower speeds are tried as it does not damp
    with pytest.raises(InvalidValue, match="no force_limit"):
        rr.safe_speed(q, n, region={**given, "force_limit": 0.0})


def test_covers_are_laws_of_the_region(rr: batch.CompiledPackage) -> None:
    q, n = poses(3), [1.0, 0.5, 0.0]
    soft = region_parameters(Contact(body_region("hand"), cover=PowerLaw(3e4, 1.0)))
    bare = region_parameters(Contact(body_region("hand")))
    forces = [rr.peak_force(q, n, 0.5, region=r, horizon=0.1)["force"] for r in (soft, bare)]
    assert (forces[0] < 0.9 * forces[1]).all()
    named = rr.peak_force(q, n, 0.5, region="hand", horizon=0.1)["force"]
    assert np.array_equal(forces[1], named)
    with pytest.raises(InvalidValue, match="law: needs rows of 4 numbers"):
        rr.peak_force(q, n, 0.5, region={**soft, "law": [[0, 1]]}, horizon=0.1)


def test_points_and_motors_have_names(rr: batch.CompiledPackage) -> None:
    q, n, more = poses(3), [1.0, 0.5, 0.0], {"region": "hand", "horizon": 0.1}
    by_name = rr.safe_speed_at(q, "tip", n, motors=["free", "driven", "free"], **more)
    by_number = rr.safe_speed_at(q, 0, n, motors=[1, 2, 1], **more)
    assert (by_name["speed"] > 0).all()
    assert np.array_equal(by_name["speed"], by_number["speed"])
    with pytest.raises(InvalidValue, match="point: must be one of tip, elbow, not 'knee'"):
        rr.safe_speed_at(q, "knee", n, **more)
    assert rr.reflected_mass(q[:0], n)["status"].shape == (0,)


@pytest.mark.parametrize(
    ("given", "reason"),
    [
        ({"point": "elbow"}, "point: is read by safe_speed_at; safe_speed is the tip's"),
        ({"steps": 1.5}, "steps: needs whole numbers"),
        ({"horizon": "long"}, "horizon: needs real numbers"),
        ({"horizon": 0.1j}, "horizon: needs real numbers"),
        ({"horizn": 0.1}, "horizn: is nothing that .* reads: .*horizon"),
        ({"motors": ["free", "fast", "free"]}, "motors: must be one of .*, not 'fast'"),
    ],
)
def test_what_is_given_is_never_bent(
    rr: batch.CompiledPackage, given: dict[str, Any], reason: str
) -> None:
    with pytest.raises(InvalidValue, match=reason):
        rr.safe_speed(poses(3), [1.0, 0.5, 0.0], region="hand", **given)


def test_a_watched_elbow_can_bind(rr: batch.CompiledPackage) -> None:
    dq = np.zeros((50, 4))
    dq[:, 0], dq[:, 2] = 3.0, -3.0
    found = rr.speed_factor(poses(50), dq, 100.0, horizon=0.1)
    assert set(found["point"]) <= {0.0, 1.0}
    assert 1.0 in found["point"]
    assert ((found["factor"] > 0) & (found["factor"] <= 1)).all()


@pytest.mark.slow
def test_what_no_row_can_do_without_is_named(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SOFTIMPACT_CACHE", str(tmp_path))
    arm = batch.compiled("gen3")
    q, n = np.full(7, 0.4), [1.0, 0.0, 0.0]
    with pytest.raises(InvalidValue, match="joint_stiffness: is not known of this robot"):
        arm.peak_force(q, n, 0.5)
    with pytest.raises(InvalidValue, match="rotor_inertia: is not known of this robot"):
        arm.peak_force(q, n, 0.5, joint_stiffness=3e3)
    known = {"joint_stiffness": 3e3, "rotor_inertia": 0.5}
    assert arm.peak_force(q, n, 0.5, horizon=0.01, **known)["status"] in (0, 9)
    assert arm.peak_force(q, n, -0.5, **known)["status"] == 4  # not a matter of what is unknown


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
    with pytest.raises(InvalidValue, match=r"stiffnes.*no field of region: stiffness"):
        rr.peak_force(poses(1), [1, 0, 0], 0.5, region={"stiffnes": 1.0})
    with pytest.raises(InvalidValue, match=r"speed.*is needed by peak_force"):
        rr.peak_force(poses(1), [1, 0, 0])
    with pytest.raises(InvalidValue, match=r"rotor_inertia.*needs"):
        rr.reduced_model(poses(1), [1, 0, 0], rotor_inertia=[1.0, 2.0])
    with pytest.raises(AttributeError, match="no function 'osim'"):
        _ = rr.osim


def test_regions_are_names_or_numbers(rr: batch.CompiledPackage) -> None:
    q, n = poses(3), [1.0, 0.5, 0.0]
    named = rr.peak_force(q, n, 0.5, region="chest", clamped=False, horizon=0.1)
    numbers = {"stiffness": 25e3, "damping": 10.0, "effective_mass": 40.0, "hertz_stiffness": 19e6}
    given = rr.peak_force(q, n, 0.5, region={**numbers, "clamped": 0}, horizon=0.1)
    assert (given["force"] == named["force"]).all()
    stiffer = {**numbers, "stiffness": [25e3, 50e3, 75e3]}
    rows = rr.peak_force(q[:1], n, 0.5, region=stiffer, clamped=False, horizon=0.1)
    assert rows["force"][0] == named["force"][0]
    assert (np.diff(rows["force"]) > 0).all()
    assert rr.status_text(9).endswith("the result is on the safe side")
    assert {"peak_force", "chain", "mass_matrix"} <= set(dir(rr))


def test_what_is_wrong_holds_no_numbers(rr: batch.CompiledPackage) -> None:
    found = rr.speed_factor(poses(2), [[np.nan] * 4, [1.0, 0, 1.0, 0]], 100.0, horizon=0.1)
    assert found["status"].tolist() == [2, 0]
    assert found["point"][0] == -1
    assert np.isnan(found["factor"][0])
    assert np.isfinite(found["factor"][1])


def test_without_a_compiler_it_says_what_else_there_is(
    rr: batch.CompiledPackage, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(build, "c_compiler", lambda: None)
    monkeypatch.setattr(build, "find_spec", lambda _: None)
    with pytest.raises(batch.NoCompiler, match=r"simulate one call at a time"):
        batch.compiled("rr")


def test_a_broken_compiler_is_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    broken = tmp_path / "broken-cc"
    broken.write_text("#!/bin/sh\necho 'error: no licence' >&2; exit 1\n")
    broken.chmod(0o755)
    monkeypatch.setenv("CC", str(broken))
    monkeypatch.setenv("SOFTIMPACT_CACHE", str(tmp_path / "cache"))
    package = batch.compiled("rr")
    with pytest.raises(batch.CompilerFailed, match=r"broken-cc failed \(error: no licence\)"):
        package.reflected_mass(poses(1), [1, 0, 0])


def test_a_second_process_takes_it_from_the_cache(
    rr: batch.CompiledPackage, monkeypatch: pytest.MonkeyPatch
) -> None:
    q, n = poses(3), [1.0, 0.5, 0.0]
    first = rr.reflected_mass(q, n)

    def never(*_: object, **__: object) -> None:
        raise AssertionError

    monkeypatch.setattr(build, "_generate", never)
    monkeypatch.setattr(build.Sources, "_compile", never)
    again = batch.compiled("rr", rotor_inertia=0.5, points={"elbow": "O3"}, threads=1)
    assert (again.reflected_mass(q, n)["m_c"] == first["m_c"]).all()
    with pytest.raises(AssertionError):
        batch.compiled("rr", rotor_inertia=0.6)


def one_by_one(package: batch.CompiledPackage, name: str, *given: Any, **more: Any) -> batch.Arrays:
    """Call a function with parameters of its own for each row, so that rows are not joined."""
    count = len(given[0])
    rotors = np.repeat([more.pop("rotor_inertia")], count, axis=0)
    found: batch.Arrays = getattr(package, name)(*given, rotor_inertia=rotors, **more)
    return found


def difference(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Return the largest difference of each row over its largest entry."""
    a, b = a.reshape(len(a), -1), b.reshape(len(b), -1)
    return np.asarray(np.nan_to_num(abs(a - b)).max(axis=1) / np.maximum(abs(b).max(axis=1), 1e-30))


def agree(package: batch.CompiledPackage, name: str, given: tuple[Any, ...], rotors: Any) -> Any:
    """Compare rows side by side with single ones; return differences of good rows and statuses."""
    together = getattr(package, name)(*given, rotor_inertia=rotors)
    alone = one_by_one(package, name, *given, rotor_inertia=rotors)
    assert (together["status"] == alone["status"]).all(), name
    fine = together["status"] == 0
    assert all(np.isnan(together[key][~fine]).all() for key in together if key != "status")
    worst = [difference(together[k][fine], alone[k][fine]) for k in together if k != "status"]
    return np.max(worst, axis=0), set(together["status"].tolist())


def test_rows_side_by_side_are_what_single_ones_are(rr: batch.CompiledPackage) -> None:
    random = np.random.default_rng(3)
    q = random.uniform(-7, 7, (1000, 4))
    q[::7] *= 1e3
    n = random.normal(size=(1000, 3)) * 10.0 ** random.uniform(-3, 3, (1000, 1))
    n[:, 2] = 0
    q[3, 1], q[5], n[6] = np.nan, 2e5, 0  # not a number, many turns, no direction
    q[8, 2] = np.inf
    rotors = [0.4, 0.3, 0.2, 0.1]
    speeds = np.where(np.arange(1000) % 5 == 0, -1.0, 0.5)
    for name, given, statuses in (
        ("reduced_model", (q, n), {0, 2, 3}),
        ("chain", (q, n), {0, 2, 3}),
        ("generalised_mass_matrix", (q,), {0, 2}),
        ("joint_impulse", (q, n, speeds, 0.5, 0.1), {0, 2, 3, 4}),
    ):
        differences, found = agree(rr, name, given, rotors)
        assert np.quantile(differences, 0.98) < 1e-10, name  # some are ill-conditioned
        assert statuses <= found
    assert set(rr.reduced_model(q[:9], n[:9], rotor_inertia=-1.0)["status"]) == {2, 3, 4}


@pytest.mark.slow
@pytest.mark.parametrize("real", ["double", "float"])
def test_functions_of_the_panda_agree_side_by_side(real: Literal["double", "float"]) -> None:
    tool("gcc")
    panda = batch.compiled("panda", real=real, joint_stiffness=3e3)
    random = np.random.default_rng(4)
    q, n = random.uniform(-2.5, 2.5, (300, 7)), random.normal(size=(300, 3))
    rotors = [0.6, 0.6, 0.5, 0.5, 0.2, 0.2, 0.2]
    few = ("osim", "reduced_model")
    for name, entry in panda.interface.entries.items():
        names = [a.name for a in entry.arguments]
        mapped = name in panda.functions and "region" not in names and "p" in names
        if not mapped or (real == "float" and name not in few):
            continue
        given = [q, *[n] * ("n" in names), *[0.5, 0.3, 0.1] * ("restitution" in names)]
        differences, found = agree(panda, name, tuple(given), rotors)
        assert np.quantile(differences, 0.95) < (1e-8 if real == "double" else 2e-3), name
        assert 0 in found


SINES = """#include "batched_lanes.h"
void sines(int count, const batched_real *x, batched_real *s, batched_real *c);
void sines(int count, const batched_real *x, batched_real *s, batched_real *c)
{
    for (int i = 0; i < count; ++i) {
        s[i] = lane_sine(x[i]);
        c[i] = lane_cosine(x[i]);
    }
}
"""


def test_sines_side_by_side_are_right(rr: batch.CompiledPackage, tmp_path: Path) -> None:
    (tmp_path / "sines.c").write_text(SINES)
    include = [f"-I{rr.sources.folder / folder}" for folder in ("include", "src", "batch")]
    run(tool("gcc"), *build.FLAGS, *include, tmp_path / "sines.c", "-o", tmp_path / "s.so", "-lm")
    entry = ctypes.CDLL(str(tmp_path / "s.so")).sines
    random = np.random.default_rng(5)
    quarters = np.arange(-1000, 1001) * (np.pi / 2)
    x = np.concatenate([random.uniform(-4, 4, 20_000), random.uniform(-1e5, 1e5, 20_000), quarters,
                        10.0 ** random.uniform(-300, 0, 100), [0.0]])  # fmt: skip
    s, c = np.empty_like(x), np.empty_like(x)
    entry(len(x), *(ctypes.c_void_p(v.ctypes.data) for v in (x, s, c)))
    wide = x.astype(np.longdouble)
    assert abs(s - np.sin(wide)).max() < wide_sine.ERROR
    assert abs(c - np.cos(wide)).max() < wide_sine.ERROR
    small = abs(x) < 1e-3
    assert (abs(s - np.sin(wide))[small] <= 3e-16 * abs(x[small])).all()
