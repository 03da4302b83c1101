# SPDX-License-Identifier: BSD-3-Clause
"""Laws of contact in C: points never below a law, impacts as Python and SciPy have them."""

from __future__ import annotations

import ctypes
import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import casadi as ca
import numpy as np
import pytest
from compiled_impacts import (
    DRIVEN,
    FREE,
    FREE_OR_DRIVEN,
    NOT_FINITE,
    OK,
    OUT_OF_RANGE,
    SERVO,
    Impacts,
    Motion,
    impacts,
)
from compiled_packages import KINDS, Generated
from hypothesis import given, settings
from hypothesis import strategies as st
from impact_models import model_of
from independent_impacts import arm_of, force_by_scipy
from scipy.optimize import brentq

from softimpact.codegen import region_parameters
from softimpact.codegen.inputs.law_points import ABOVE, FAINT, MOST_POINTS, law_points
from softimpact.simulate import Approach, simulate_impact
from softimpact.symbolic import (
    Contact,
    Curve,
    InvalidValue,
    Law,
    Motors,
    PowerLaw,
    body_region,
    in_series,
)
from softimpact.symbolic.body.devices import DEVICES
from softimpact.symbolic.body.laws.series import points_of
from softimpact.symbolic.body.pads import PADS
from softimpact.symbolic.robot.rigid import Array

ACCURACY = 2e-3
FOAM = Curve([0, 2e-3, 5e-3, 10e-3, 15e-3, 18e-3, 20e-3], [0, 5, 12, 25, 60, 200, 900])


@dataclass(frozen=True)
class Stiffening(Law):
    """f = k d (exp(δ/d) − 1): a law that packages have never heard of."""

    stiffness: float
    depth: float

    def force(self, depth: Any) -> Any:
        """Return f [N]."""
        return self.stiffness * self.depth * (ca.exp(ca.fmax(depth, 0) / self.depth) - 1)


def force_of(points: Array, depth: Array) -> Array:
    """Return the force at depths, from the parabolas as they are defined: by their parameter."""
    last = points[-1]
    found = last[1] + (depth - last[0]) * (last[3] - last[1]) / (last[2] - last[0])
    for a, b in pairwise(points):
        t = np.array([0.0, *np.geomspace(1e-6, 1, 20001)])
        weights = np.array([(1 - t) ** 2, 2 * t * (1 - t), t**2])
        x, y = (weights.T @ np.array([a[k], a[k + 2], b[k]]) for k in (0, 1))
        inside = (depth >= a[0]) & (depth < b[0])
        found[inside] = np.interp(depth[inside], x, y)
    return np.asarray(found)


def check_points(law: Law) -> None:
    points, known = law_points(law), points_of(law)
    assert (np.diff(points[:, :2], axis=0) > 0).all()
    forces = np.geomspace(1.5 * FAINT, 5e4, 400)
    low, high = np.full(400, 1e-12), np.full(400, 10.0)
    for _ in range(100):
        depth = np.sqrt(low * high)
        above = known.evaluated(depth)[0] > forces
        low, high = np.where(above, low, depth), np.where(above, depth, high)
    off = force_of(points, depth) / known.evaluated(depth)[0] - 1
    assert off.max() < 1.2 * ABOVE
    assert off.min() > -3e-6  # interpolation of this test's own
    assert len(points) <= MOST_POINTS


@pytest.mark.parametrize(
    "law",
    [
        PowerLaw(5e4, 1.0),
        PowerLaw(3e8, 2.0),
        PowerLaw(5e6, 1.1),
        FOAM,
        in_series(FOAM, PowerLaw(1.9e7)),
        in_series(FOAM, PowerLaw(2e4, 1.0), PowerLaw(1.9e7)),
    ],
    ids=str,
)
def test_points_are_never_softer_than_the_law_and_hardly_stiffer(law: Law) -> None:
    check_points(law)


@pytest.mark.slow
@settings(max_examples=8)
@given(
    st.lists(st.tuples(st.floats(1e-4, 3e-3), st.floats(0.5, 200)), min_size=1, max_size=12),
    st.booleans(),
)
def test_points_of_any_curve_are_so(steps: list[tuple[float, float]], padded: bool) -> None:
    depth, force = np.cumsum([(0.0, 0.0), *steps], axis=0).T
    curve = Curve(depth.tolist(), force.tolist())
    check_points(in_series(curve, PowerLaw(1.9e7)) if padded else curve)


def test_a_law_with_too_many_corners_is_refused() -> None:
    forces = np.cumsum(np.tile([1.0, 30.0], 100))
    with pytest.raises(InvalidValue, match=r"law: needs \d+ points in C, which takes 128"):
        law_points(Curve([0, *np.linspace(1e-3, 0.2, 200)], [0, *forces]))


def region_of(compiled: Impacts, contact: Contact) -> tuple[Any, Array]:
    """Return a contact's struct, and the law's points, which it must not outlive."""
    real, kind = KINDS[compiled.real]
    found = region_parameters(contact)
    region = compiled.region("chest", contact.clamped)
    points = np.array(found.pop("law") if found["law"] is not None else [], dtype=kind)
    found.pop("law", None)
    for name, value in found.items():
        setattr(region, name, real(value) if name != "clamped" else int(value))
    if points.size:
        region.law, region.law_points = points.ctypes.data, len(points)
    return region, points


BODIES: Mapping[str, Contact] = {
    "a pad": Contact(body_region("hand"), cover=PADS["sh10"].law),
    "foam": Contact(body_region("chest"), clamped=False, cover=FOAM),
    "foam twice": Contact(body_region("head"), cover=in_series(FOAM, PowerLaw(3e4, 1.0))),
    "a linear cover": Contact(body_region("abdomen"), cover=PowerLaw(2e4, 1.0)),
    "a stiffening cover": Contact(body_region("hand"), clamped=False, cover=PowerLaw(3e8, 2.0)),
    "a device": Contact(DEVICES["device_75_sh30"]),
    "a device on a slide": Contact(DEVICES["device_40_sh70"], clamped=False, cover=FOAM),
}
LAWS: Mapping[int, Any] = {FREE: "free", DRIVEN: "driven", SERVO: "servo"}


def check_body(compiled: Impacts, contact: Contact, count: int, seed: int) -> None:
    region, points = region_of(compiled, contact)
    assert (points.size == 0) == isinstance(contact.law, PowerLaw)
    for k, case in enumerate(impacts(compiled.package, count, seed)):
        kind = (FREE, DRIVEN, SERVO)[k % 3]
        motion = Motion(kind, 0.02, 0.1, 100_000)
        status, (force, _) = compiled.call("peak_force", case.sample, case.speed, region, motion)
        right = simulate_impact(
            model_of(compiled, case.sample),
            Approach(case.sample.q, case.sample.n, case.speed),
            contact,
            "linearised",
            motors=Motors(LAWS[kind], 0.02),
            horizon=0.1,
        ).peak
        assert status == OK
        assert force == pytest.approx(right, rel=ACCURACY)


@pytest.mark.parametrize("body", ["a linear cover"])
def test_impacts_on_any_body_are_as_python_has_them(
    package: Callable[[str], Generated], body: str
) -> None:
    check_body(Impacts(package("panda"), "double"), BODIES[body], 2, seed=41)


@pytest.mark.slow
@pytest.mark.parametrize("body", BODIES)
def test_many_impacts_on_any_body_are_as_python_has_them(
    package: Callable[[str], Generated], body: str
) -> None:
    real = "float" if len(body) % 2 else "double"  # either, as it comes
    check_body(Impacts(package("panda"), real), BODIES[body], 3, seed=42)


def in_a_row(*depths: Callable[[float], float]) -> Callable[[float], float]:
    """Return the force over the depth of laws that are given as depths over force."""

    def force(depth: float) -> float:
        if depth <= 0:
            return 0.0
        return float(brentq(lambda f: sum(law(f) for law in depths) - depth, 0, 1e5, xtol=1e-9))

    return force


@pytest.mark.slow
@pytest.mark.parametrize(("clamped", "damping"), [(True, 10.0), (False, 300.0)])
def test_scipy_finds_the_same_forces(
    package: Callable[[str], Generated], clamped: bool, damping: float
) -> None:
    """With laws written down as depths: a rubber that stiffens exponentially, before the skin."""
    compiled = Impacts(package("panda"), "double")
    gel = lambda f: 4e-3 * math.log1p(f / (4e-3 * 2e4))  # noqa: E731
    skin = lambda f: (f / 1.9e7) ** (2 / 3)  # noqa: E731
    region = replace(body_region("chest"), damping=damping)
    contact = Contact(region, clamped, cover=Stiffening(2e4, 4e-3))
    struct, points = region_of(compiled, contact)
    case = impacts(compiled.package, 3, seed=43)[2]
    for kind in (FREE, DRIVEN):
        status, (force, _) = compiled.call(
            "peak_force", case.sample, 0.6, struct, Motion(kind, 0.02, 0.1, 100_000)
        )
        arm = arm_of(
            model_of(compiled, case.sample), Approach(case.sample.q, case.sample.n, 0.6), full=False
        )
        times = np.linspace(0, 0.1, 4001)
        right = force_by_scipy(
            arm, contact, Motors(LAWS[kind], 0.02), times, 1e-7, skin=in_a_row(gel, skin)
        )
        assert status == OK
        assert force == pytest.approx(right.max(), rel=ACCURACY)
    assert points.size


@pytest.mark.parametrize("real", ["double", "float"])
def test_safe_speeds_against_a_cover_keep_the_limit(
    package: Callable[[str], Generated], real: str
) -> None:
    compiled = Impacts(package("panda"), real)
    contact = BODIES["foam"]
    region, points = region_of(compiled, contact)
    bare = compiled.region("chest", clamped=False)
    for case in impacts(compiled.package, 2, seed=44):
        motion = Motion(FREE_OR_DRIVEN, 0.02, 0.1, 100_000)
        status, (speed, _) = compiled.call("safe_speed", case.sample, 280.0, region, motion)
        assert status == OK
        model = model_of(compiled, case.sample)
        peaks = [
            simulate_impact(
                model,
                Approach(case.sample.q, case.sample.n, speed),
                contact,
                "linearised",
                motors=Motors(kind, 0.02),
                horizon=0.1,
            ).peak
            for kind in ("free", "driven")
        ]
        assert 0.95 * 280 < max(peaks) <= 280  # 1 % of the speed is kept free of jumps
        assert speed > compiled.call("safe_speed", case.sample, 280.0, bare, motion)[1][0]
    assert points.size


def test_what_is_no_law_is_refused(package: Callable[[str], Generated]) -> None:
    compiled = Impacts(package("panda"), "double")
    sample = impacts(compiled.package, 1, seed=45)[0].sample
    region, points = region_of(compiled, BODIES["foam"])
    good = points.copy()
    assert compiled.call("peak_force", sample, 0.5, region)[0] == OK
    for row, column, value in (
        (0, 0, 1e-3), (0, 1, 1.0), (1, 0, 0.0), (1, 1, 0.0), (2, 2, 1.0), (2, 3, -1.0),
        (3, 1, np.nan), (3, 3, np.nan), (4, 0, np.inf), (-1, 2, np.inf), (-1, 3, -1.0),
        (-1, 2, 0.0), (-1, 1, np.nan),
    ):  # fmt: skip
        points[:] = good
        points[row, column] = value
        for function in ("peak_force", "safe_speed"):
            status, out = compiled.call(function, sample, 0.5, region)
            assert status in (OUT_OF_RANGE, NOT_FINITE), (row, column)
            assert np.isnan(out).all()
    points[:] = good
    for count in (0, -1, MOST_POINTS + 1):
        region.law_points = count
        assert compiled.call("peak_force", sample, 0.5, region)[0] == OUT_OF_RANGE


def test_one_point_is_a_straight_law(package: Callable[[str], Generated]) -> None:
    compiled = Impacts(package("panda"), "double")
    sample = impacts(compiled.package, 1, seed=46)[0].sample
    line = np.array([[0.0, 0.0, 1.0, 5e4]])
    region, points = region_of(compiled, Contact(body_region("chest"), cover=PowerLaw(5e4, 1.0)))
    region.hertz_stiffness = ctypes.c_double(math.nan)  # not read
    region.law, region.law_points = line.ctypes.data, 1
    model = model_of(compiled, sample)
    skin = replace(body_region("chest"), skin=PowerLaw(5e4, 1.0))
    right = simulate_impact(
        model,
        Approach(sample.q, sample.n, 0.5),
        Contact(skin),
        "linearised",
        motors=Motors("free"),
        horizon=0.1,
    ).peak
    status, (force, _) = compiled.call("peak_force", sample, 0.5, region)
    assert status == OK
    assert force == pytest.approx(right, rel=5e-4)
    assert points.size
