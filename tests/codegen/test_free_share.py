# SPDX-License-Identifier: BSD-3-Clause
"""How much of a limit safe speeds leave free: what texts say is what the constants of C make."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from softimpact.studio.program.run import AGREED

ROOT = Path(__file__).parents[2]

RUNTIME = ROOT / "codegen/runtime"

FREE = [
    "codegen/templates/header_impact.h.jinja",
    "docs/programs.md",
    "studio/program/engine.py",
    "studio/program/run.py",
]
"""Texts that say what is left free, in per cent."""


def constant(name: str, path: Path = RUNTIME / "robot_safe_speed.c") -> float:
    """Return a number that C defines."""
    found = re.search(rf"#define {name} (?:ROBOT_R\()?([0-9.]+)", path.read_text(encoding="utf-8"))
    assert found, name
    return float(found[1])


IMPACT = RUNTIME / "robot_impact.h"

KEPT, ELSEWHERE = constant("ROBOT_KEPT", IMPACT), constant("ROBOT_COUNTS_ELSEWHERE", IMPACT)
NEAR = constant("NEAR_ENOUGH")


def per_cent(share: float) -> str:
    """Return what is left free beside a share."""
    return f"{round(100 * (1 - share), 1):g} %"


@pytest.mark.parametrize("name", FREE)
def test_texts_say_what_is_left_free(name: str) -> None:
    text = (ROOT / name).read_text(encoding="utf-8")
    assert per_cent(NEAR) in text
    assert per_cent(ELSEWHERE * NEAR) in text
    assert f"{per_cent(KEPT)[:-2]} to {per_cent(NEAR)}" in text


def test_page_about_impacts_gives_the_constants() -> None:
    text = (ROOT / "docs/impacts-in-c.md").read_text(encoding="utf-8")
    assert f"at most {KEPT:g} of the limit; the search aims at {constant('AIM'):g}" in text
    assert f"{per_cent(ELSEWHERE)} more of the limit is left free" in text


def test_search_aims_between_what_is_near_and_what_is_kept() -> None:
    assert NEAR < constant("AIM") < KEPT < 1


def test_programs_by_c_and_python_may_differ_by_what_c_leaves_free() -> None:
    assert 1 - ELSEWHERE * NEAR <= AGREED < 1 - ELSEWHERE * NEAR + 0.005


def test_benchmarks_of_cost_leave_the_same_free() -> None:
    header = ROOT / "benchmarks/cost/rk4.h"
    assert constant("RK4_NEAR", header) == NEAR
    assert constant("RK4_KEPT", header) == KEPT
    page = (ROOT / "benchmarks/cost/page.py").read_text(encoding="utf-8")
    assert f"{per_cent(KEPT)[:-2]} to {per_cent(NEAR)}" in page
