# SPDX-License-Identifier: BSD-3-Clause
"""Body regions of ISO/TS 15066."""

import pytest

from softimpact.symbolic import REGIONS, UnknownName, body_region


def test_the_papers_regions() -> None:
    """Stiffnesses as MSM prints them (§3.1.1)."""
    assert body_region("head").stiffness == 150e3
    assert body_region("chest").stiffness == 25e3
    assert body_region("head").damping == 10.0


def test_limits_for_the_first_milliseconds() -> None:
    """Twice the quasi-static limit, except on the head, where no transient limit is given."""
    assert body_region("chest").force_limit == 280
    assert body_region("hand").force_limit == 280
    assert body_region("head").force_limit == 130
    assert body_region("face").force_limit == 65
    for region in REGIONS.values():
        assert (region.transient_limit is None) == (region.name in {"head", "face"})


def test_regions_are_physical() -> None:
    for name, region in REGIONS.items():
        assert region.name == name
        assert 10e3 <= region.stiffness <= 150e3
        assert 0.5 < region.effective_mass <= 75
        assert 65 <= region.quasi_static_limit <= 220


def test_unknown_region_lists_the_known_ones() -> None:
    with pytest.raises(UnknownName, match=r"unknown body region 'nose'; known: head, face") as e:
        body_region("nose")
    assert e.value.known == tuple(REGIONS)
