# SPDX-License-Identifier: BSD-3-Clause
"""``benchmarks/cost`` compares like with like, and runs."""

from __future__ import annotations

import sys
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from compiled_packages import run, tool
from oracles import Pinocchio, assert_near, configurations

from softimpact.symbolic import Robot, frame_pose, load_robot, mass_matrix

COST = Path(__file__).parents[2] / "benchmarks" / "cost"
sys.path.insert(0, str(COST))

from arm import urdf  # noqa: E402
from expressions import QUANTITIES, built_on, our_expressions  # noqa: E402
from page import page  # noqa: E402
from samples import still_samples  # noqa: E402


@pytest.fixture(scope="module")
def panda() -> Robot:
    return load_robot("panda")


def test_urdf_is_the_same_robot(panda: Robot, tmp_path: Path) -> None:
    path = tmp_path / "panda.urdf"
    path.write_text(urdf(panda))
    again = load_robot(path)
    oracle = Pinocchio.of_urdf(path, again)
    for q in configurations(panda, 3):
        assert_near(oracle.mass_matrix(q), mass_matrix(panda, q))
        assert_near(again.frames["tip"].placement.translation, [0, 0, 0.2104])


def test_formulas_on_another_librarys_matrices_give_our_numbers(panda: Robot) -> None:
    ours = our_expressions(panda)
    q = ca.SX.sym("q", panda.n)
    J = ca.jacobian(frame_pose(panda, str(panda.tip), q).position, q)
    theirs = built_on("theirs", ca.Function("theirs", [q], [mass_matrix(panda, q), J]))
    for sample in still_samples(panda, 5):
        given = (sample.q, sample.n, sample.springs, sample.rotors, sample.gains)
        for quantity in QUANTITIES:
            left, right = ours.functions[quantity](*given), theirs.functions[quantity](*given)
            np.testing.assert_allclose(left, right, rtol=1e-9, atol=1e-9)


def test_page_shows_ratios_and_who_is_missing() -> None:
    times = {"giaf": {"ours": 200.0, "CasADi": 230.0}, "safe_speed": {"ours": 5e3, "RK4": 1e5}}
    flops, divisions = {"ours": 1174.0, "CasADi": 1234.0}, {"ours": 16.0, "CasADi": 87.0}
    text = page("a machine", "a compiler", times, {"giaf": flops}, {"giaf": divisions}, {})
    assert "| GIAF and GIIF | 200 ns | 1.15 × |" in text
    assert "| safe speed | 5000 ns | 20 × |" in text
    assert "| GIAF and GIIF | 1174 | 1234 |" in text
    assert "| GIAF and GIIF | 16 | 87 |" in text
    assert "microcontroller" not in text


@pytest.mark.long
@pytest.mark.slow
def test_all_contenders_agree(tmp_path: Path) -> None:
    tool("g++")
    out = tmp_path / "page.md"
    run(sys.executable, COST / "run.py", "--quick", "--out", out)  # fails where values differ
    text = out.read_text()
    for name in ("M(q)", "m_c, k_r, m_a", "safe speed"):
        assert f"| {name} | " in text
