# SPDX-License-Identifier: BSD-3-Clause
"""The joint stiffness that decouples links from motors."""

from __future__ import annotations

from dataclasses import replace
from functools import partial

import numpy as np
import pytest
from impact_cases import ALONG_Y, HEAD, POSE

from softimpact.simulate import (
    Approach,
    Controller,
    Fidelity,
    decoupling_stiffness,
    is_isolated,
    scaled_springs,
    simulate_impact,
)
from softimpact.symbolic import (
    ImpactModel,
    InvalidValue,
    Robot,
    drives,
    impact_model,
    load_robot,
)

NOMINAL = 1e4
CONTROLLER = Controller(6050.0, 121.0, 1.25e5)
STRAIGHT = Approach(np.zeros(4), np.array([0.0, 1.0, 0.0]), 1.0, np.array([1.0, 0.0, 0.0, 0.0]))


@pytest.fixture(scope="module")
def rr() -> ImpactModel:
    robot = load_robot("rr")
    return impact_model(robot, "P", drives=drives(robot, computed_torque_gain=6050.0))


@pytest.mark.parametrize("fidelity", ["two_mass", "linearised"])
def test_peaks_part_and_merge_at_the_stiffness_found(rr: ImpactModel, fidelity: Fidelity) -> None:
    def case(stiffness: float) -> tuple[ImpactModel, Approach]:
        return scaled_springs(rr, stiffness / NOMINAL), STRAIGHT

    found = decoupling_stiffness(case, HEAD, (500.0, 5e4), fidelity, accuracy=1e-3)
    assert found.isolated is not None
    assert found.distinct is not None

    def valley(stiffness: float) -> float:
        """Least force between the first two peaks over the first one."""
        history = simulate_impact(*case(stiffness), HEAD, fidelity, horizon=0.05)
        assert history.time_of_first_peak is not None
        first = int(np.argmin(abs(history.time - history.time_of_first_peak)))
        rising = np.flatnonzero(np.diff(history.force[first + 5 :]) > 0)
        return float(history.force[first : first + 6 + rising[0]].min() / history.first_peak)

    assert valley(0.97 * found.isolated) == 0
    assert 0 < valley(1.03 * found.isolated) < 0.1
    below, above = (
        simulate_impact(*case(share * found.distinct), HEAD, fidelity) for share in (0.995, 1.005)
    )
    assert valley(0.995 * found.distinct) > 0.95  # a dent is left
    assert below.force_of("first_peak") < below.first_contact
    assert above.first_peak == above.first_contact > 1.2 * below.force_of("first_peak")


def test_the_paper_stops_a_step_of_its_grid_below(rr: ImpactModel) -> None:
    """MSM: peaks on the head in (a) are isolated up to 4056 N·m/rad; the next step is 6164."""
    isolated = [
        is_isolated(
            simulate_impact(
                scaled_springs(rr, k / NOMINAL), STRAIGHT, HEAD, "full", motors=CONTROLLER
            )
        )
        for k in np.geomspace(5e2, 5e4, 12)[:7]
    ]
    assert isolated == [True] * 6 + [False]
    assert np.geomspace(5e2, 5e4, 12)[5:7] == pytest.approx([4056, 6164], abs=0.5)


def test_the_unit_of_stiffness_does_not_matter(rr: ImpactModel) -> None:
    def case(unit: float, k: float) -> tuple[ImpactModel, Approach]:
        return scaled_springs(rr, k * unit / NOMINAL), STRAIGHT

    found = [
        decoupling_stiffness(partial(case, unit), HEAD, (2e3 / unit, 1e4 / unit), "two_mass")
        for unit in (1.0, 1e3)
    ]
    assert found[0].isolated is not None
    assert found[1].isolated == pytest.approx(found[0].isolated / 1e3, rel=2e-4)
    assert found[0].distinct is None


def test_springs_soft_enough_decouple_everywhere(panda: Robot) -> None:
    model = impact_model(panda, drives=drives(panda, 1.0))
    approach = Approach(POSE, ALONG_Y, 1.0)

    def case(stiffness: float) -> tuple[ImpactModel, Approach]:
        return scaled_springs(model, stiffness), approach

    found = decoupling_stiffness(case, HEAD, (1.0, 20.0), "chain", order=3)
    assert (found.isolated, found.distinct) == (None, None)


def test_all_springs_are_scaled(panda: Robot) -> None:
    both = replace(panda, joints=tuple(replace(joint, stiffness=7.0) for joint in panda.joints))
    model = scaled_springs(impact_model(both, drives=drives(both, 1e3)), 2.5)
    assert np.array(model.drives.springs).ravel() == pytest.approx([2500.0] * panda.n)
    assert [joint.stiffness for joint in model.robot.joints] == [17.5] * panda.n


@pytest.mark.parametrize("between", [(0.0, 1e4), (1e4, 1e3), (1e3, np.inf), (np.nan, 1e4)])
def test_a_range_is_needed(rr: ImpactModel, between: tuple[float, float]) -> None:
    with pytest.raises(InvalidValue, match="between"):
        decoupling_stiffness(lambda _: (rr, STRAIGHT), HEAD, between)


@pytest.mark.parametrize("accuracy", [0.0, 1e-20, 2.0, np.nan])
def test_an_accuracy_that_cannot_be_met_is_refused(rr: ImpactModel, accuracy: float) -> None:
    with pytest.raises(InvalidValue, match="accuracy"):
        decoupling_stiffness(lambda _: (rr, STRAIGHT), HEAD, (1e3, 2e3), accuracy=accuracy)


def test_a_range_that_starts_too_stiff_is_refused(rr: ImpactModel) -> None:
    with pytest.raises(InvalidValue, match="softer"):
        decoupling_stiffness(lambda _: (rr, STRAIGHT), HEAD, (1e4, 2e4), "two_mass")


@pytest.mark.parametrize("factor", [0.0, -1.0, np.inf, np.nan])
def test_impossible_factors_are_refused(rr: ImpactModel, factor: float) -> None:
    with pytest.raises(InvalidValue, match="factor"):
        scaled_springs(rr, factor)
