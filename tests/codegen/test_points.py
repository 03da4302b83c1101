# SPDX-License-Identifier: BSD-3-Clause
"""Impacts of several contact points and regions: each as if it were alone, the worst binds."""

from __future__ import annotations

import ctypes
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from compiled_packages import Generated

from softimpact.codegen import generate_package
from softimpact.codegen.verification.impacts import draw_impacts
from softimpact.symbolic import REGIONS, load_robot

OK, OUT_OF_RANGE = 0, 4
LIMITS = {"chest": 280.0, "hand": 280.0, "neck": 150.0}


@pytest.fixture(scope="module")
def watched(tmp_path_factory: pytest.TempPathFactory) -> Generated:
    """UR5e with two points on its way to the tip."""
    robot, folder = load_robot("ur5e"), tmp_path_factory.mktemp("watched") / "package"
    points = {"elbow": "forearm_link", "wrist": "wrist_2_link"}
    manifest = generate_package(robot, folder, name="ur5e", points=points)
    return Generated(robot, str(robot.tip), folder, manifest)


class Calls:
    """Calls of a package in double with pointers to its own structs."""

    def __init__(self, package: Generated) -> None:
        self.package, self.interface = package, package.interface
        self.library = package.load("double").library
        case = draw_impacts(package.robot, package.parameters, np.eye(3), 1, 5)[0]
        self.p = package.params(
            "double", case.sample.parameters, reaction_time=0.02, horizon=0.1, steps=4000
        )

    def region(self, name: str, clamped: bool) -> Any:
        region = np.zeros(1, self.interface.dtype("region", "double"))
        part = list(REGIONS).index(name)
        assert self.call("body_region", part, int(clamped), region) == OK
        return region

    def call(self, function: str, *arguments: Any) -> int:
        sent = [
            ctypes.c_void_p(x.ctypes.data) if isinstance(x, np.ndarray)
            else ctypes.c_double(x) if isinstance(x, float) else x
            for x in arguments
        ]  # fmt: skip
        status: int = getattr(self.library, f"{self.package.manifest.name}_{function}")(*sent)
        return status

    def factor(self, q: Any, dq: Any, table: list[tuple[str, int]]) -> tuple[int, Any]:
        """Return the status and the factor of a table of regions and points."""
        regions = np.zeros(len(table), self.interface.dtype("region", "double"))
        for row, (name, _) in enumerate(table):
            regions[row] = self.region(name, clamped=True)[0]
        limits = np.array([LIMITS[name] for name, _ in table])
        points = np.array([point for _, point in table], dtype=np.int32)
        out = np.zeros(1, self.interface.dtype("speed_factor_over_t", "double"))
        sent = (points, regions, limits, len(table), self.p, out)
        return self.call("speed_factor_over", q, dq, *sent), out[0]


def check_table(calls: Calls, points: int) -> None:
    """Check that a table's factor is the least of its entries alone."""
    random, n = np.random.default_rng(2), calls.package.robot.n
    table = [(name, point) for name in LIMITS for point in range(points)]
    seen = set()
    for _ in range(6):
        q, dq = random.uniform(-1.5, 1.5, n), 3 * random.normal(size=n)
        status, out = calls.factor(q, dq, table)
        alone = [calls.factor(q, dq, [entry])[1]["factor"] for entry in table]
        assert status == OK
        assert out["factor"] == pytest.approx(min(alone), rel=0.02)
        assert alone[out["entry"]] == pytest.approx(min(alone), rel=0.02)
        seen.add(table[out["entry"]][1])
    assert points == 1 or len(seen) > 1
    assert calls.factor(q, dq, [("chest", points)])[0] == OUT_OF_RANGE
    assert calls.factor(q, dq, [("chest", -1)])[0] == OUT_OF_RANGE


def test_several_regions_at_once_are_as_each_alone(package: Callable[[str], Generated]) -> None:
    check_table(Calls(package("panda")), 1)


@pytest.mark.slow
def test_the_worst_of_points_and_regions_binds(watched: Generated) -> None:
    check_table(Calls(watched), 3)


@pytest.mark.slow
def test_any_point_is_asked_for_its_force_and_speed(watched: Generated, tmp_path: Path) -> None:
    """As a package says of whose own point it is."""
    robot = watched.robot
    points = {"tool": str(robot.tip)}
    swapped = generate_package(
        robot, tmp_path / "p", tip="wrist_2_link", name="ur5e", points=points
    )
    other = Calls(Generated(robot, "wrist_2_link", tmp_path / "p", swapped))
    calls, n = Calls(watched), np.array([0.3, -1.0, 0.4])
    q = np.array([0.1, -1.2, 1.3, 0.2, 0.7, 0.3])
    region = calls.region("chest", clamped=False)
    wrist = calls.interface.enums["point"]["POINT_WRIST"]
    for function, number in (("peak_force", 0.4), ("safe_speed", 280.0)):
        out, right = np.zeros(2), np.zeros(2)
        assert calls.call(f"{function}_at", q, wrist, n, number, region, calls.p, out) == OK
        assert other.call(function, q, n, number, region, other.p, right) == OK
        assert out == pytest.approx(right, rel=1e-9)
        assert calls.call(f"{function}_at", q, 3, n, number, region, calls.p, out) == OUT_OF_RANGE
        assert calls.call(f"{function}_at", q, 0, n, number, region, calls.p, out) == OK
        assert calls.call(function, q, n, number, region, calls.p, right) == OK
        assert (out == right).all()
