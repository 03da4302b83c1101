# SPDX-License-Identifier: BSD-3-Clause
"""A dash in a table never stands without a line that says why."""

from __future__ import annotations

import re

import pytest
from command_line import run

PLANAR = ("rr", "--q", "0.3,0.2,0.1,0.2", "--direction", "1,0,0")
ARM = ("panda", "--q", "0,-0.4,0,-2,0,1.6,0.8", "--direction", "1,0,0")
HIT = ("--region", "hand", "--speed", "0.1")


@pytest.mark.parametrize(
    ("typed", "kinds"),
    [
        (("analyze", *PLANAR), ["k_c", "GIAF and its kin"]),
        (("analyze", *ARM), ["k_c", "k_r, m_a"]),
        (("analyze", *ARM, "--joint-stiffness", "5e3", "--position-gain", "3e3"), []),
        (("analyze", *ARM, "--direction", "0,1,0"), ["k_r, m_a"]),
        (("factors", *PLANAR), ["GIAF and its kin, measures", "IMF"]),
        (("factors", *ARM), ["IMF"]),
        (("simulate", *ARM, *HIT), []),
        (("simulate", *ARM, *HIT, "--free", "--motors", "driven"), []),
        (("inspect", "mini_cheetah"), []),
        (("robots",), []),
        (("select", "rmin_springs"), ["GIAF and its kin"]),
    ],
)
def test_dashes_are_explained(typed: tuple[str, ...], kinds: list[str]) -> None:
    outcome = run(*typed)
    assert outcome.code == 0, outcome
    lines = outcome.out.splitlines()
    said = [line.split(":")[0][2:] for line in lines if line.startswith("– ")]
    assert said == kinds
    dashes = [line for line in lines if re.search(r"\S +–( |$)", line)]
    assert bool(dashes) == bool(kinds), dashes
    assert not re.search(r"\bnan\b", outcome.out)


def test_csv_has_numbers_alone() -> None:
    outcome = run("analyze", *PLANAR, "--csv")
    assert "–" not in outcome.out + outcome.err
    assert '"impact absorption factor, GIAF",,' in outcome.out
