# SPDX-License-Identifier: BSD-3-Clause
"""What is hit, from the command line: shapes, covers, own bodies and devices."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest
from command_line import refusal, run_json

from softimpact.symbolic import Sphere

IMPACT = [
    *("simulate", "panda", "--q", "[-1.22,0.84,0.72,-2.41,0.79,1.97,-2.04]"),
    *("--direction", "[0,1,0]", "--speed", "0.4", "--joint-stiffness", "1e4"),
]
DRIVEN = ("--motors", "driven")


def simulated(*options: str) -> dict[str, Any]:
    return run_json(*IMPACT, *DRIVEN, *options)


def test_a_shape_lets_pressure_bind() -> None:
    found = simulated("--region", "sternum", "--shape", "sphere:0.003")
    assert found["binding"] == "transient pressure"
    assert found["verdict"] == "exceeded"
    assert found["pressure"] == pytest.approx(Sphere(0.003).pressure(found["peak"]))
    assert found["limits"]["transient_pressure"] == 2.4e6
    assert found["limits"]["least_transient_force"] < 10
    blunt = simulated("--region", "sternum")
    assert (blunt["binding"], blunt["pressure"]) == ("transient force", None)


def test_a_cover_is_worn_and_warned_about_beyond_its_data(tmp_path: Path) -> None:
    cover = tmp_path / "cover.toml"
    cover.write_text('[law]\nkind = "curve"\ndepths = [0, 2e-3, 4e-3]\nforces = [0, 10, 50]\n')
    bare = simulated("--region", "hand")
    worn = simulated("--region", "hand", "--cover", str(cover))
    assert worn["peak"] < bare["peak"]
    assert [line for line in worn["warnings"] if "what is known of cover and skin (50 N)" in line]
    assert not [line for line in bare["warnings"] if "known of cover" in line]
    assert worn["cover"]["forces"] == [0, 10, 50]


def test_own_bodies_and_devices_are_hit(tmp_path: Path) -> None:
    body = tmp_path / "rig.toml"
    body.write_text(
        'name = "rig"\nregion = "hand"\nplate_mass = 0.3\npad = "sh70"\ndamping = 0.0\n'
    )
    rig = simulated("--body", str(body))
    assert rig["body"]["plate_mass"] == 0.3
    assert rig["limits"]["transient"] == 280
    device = simulated("--region", "device_75_sh70")
    assert (device["verdict"], device["within_limit"]) == ("no limit", False)
    assert rig["reading"] < 0.8 * rig["peak"]  # the plate hides the first blow from the spring
    assert device["reading"] is None


def test_without_limits_the_worse_end_still_counts() -> None:
    found = run_json(*IMPACT, "--region", "device_75_sh70")
    assert found["peak"] == max(found["bracket"].values())


@pytest.mark.parametrize(
    ("options", "message"),
    [
        (("--region", "chest", "--shape", "cone:1"), "shape: must be sphere:RADIUS"),
        (("--region", "chest", "--cover", "absent.toml"), "absent.toml: no such file"),
        (("--region", "chest", "--cover", "sh1"), "did you mean 'sh10'?"),
        (("--body", "absent.toml"), "absent.toml: no such file"),
        (("--body", "chest"), "it goes by --region"),
        (("--region", "sternun"), "unknown body region 'sternun'"),
    ],
)
def test_bad_bodies_are_one_line(options: tuple[str, ...], message: str) -> None:
    assert message in refusal(*IMPACT, *options)
