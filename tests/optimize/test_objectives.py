# SPDX-License-Identifier: BSD-3-Clause
"""Each objective is no worse than a grid, and what it says is what evaluation says."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from small_arm import small_study
from studies import InProcess

from softimpact.optimize import Infeasible, Study, design
from softimpact.optimize import objectives as package
from softimpact.optimize.members import kinds_in
from softimpact.optimize.objectives import Objective
from softimpact.optimize.robust import certificate
from softimpact.optimize.robust.certificate import Hardening
from softimpact.optimize.robust.robust import RobustDesign, robust_design
from softimpact.optimize.robust.setting import setting_of
from softimpact.optimize.study.study_scenarios import scenarios_of
from softimpact.simulate import Approach, largest_safe_speed, simulate_impact
from softimpact.simulate.safe_speed import ForceLimits
from softimpact.symbolic import InvalidValue

TWO = '[hardware]\njoint_stiffness = [["turn"], ["lift", "bend"]]\n'


def study_of(folder: Path, objective: str) -> Study:
    return small_study(folder, f"{TWO}[objective]\nkind = '{objective}'")


@pytest.fixture(scope="module", params=["mean_force", "safe_speed", "task_time"])
def found(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> RobustDesign:
    study = study_of(tmp_path_factory.mktemp("objective"), request.param)
    return robust_design(study, scenarios_of(study), InProcess())


def by_sundials(design: RobustDesign, springs: np.ndarray) -> float:
    """The objective by simulations of every scenario."""
    study, scenarios = design.study, design.scenarios
    shares, speeds = [], []
    for i in range(len(scenarios)):
        one = scenarios[i]
        model = study.model.with_springs(springs)
        approach = Approach(
            scenarios.poses[one.pose].q, scenarios.directions[one.direction], study.speed
        )
        motors, contact = scenarios.motors[one.motors], scenarios.contacts[one.contact]
        if study.objective.scales_speed:
            limit = ForceLimits(scenarios.limit(one), np.inf)
            speeds.append(
                largest_safe_speed(
                    model, approach, contact, limit, motors=motors, horizon=study.horizon
                )
            )
        else:
            force = simulate_impact(
                model, approach, contact, motors=motors, horizon=study.horizon
            ).peak
            shares.append(force / scenarios.limit(one))
    if study.objective.kind == "mean_force":
        return float(np.mean(shares))
    allowed = np.minimum(speeds, 2.0)
    if study.objective.more_is_better:
        return float(allowed.min() / study.speed)
    return float((1 / allowed).sum())


@pytest.mark.slow
def test_the_value_is_what_simulations_say(found: RobustDesign) -> None:
    assert by_sundials(found, found.springs) == pytest.approx(found.worst.value, rel=2e-3)


@pytest.mark.slow
def test_no_worse_than_a_grid(found: RobustDesign) -> None:
    study, scenarios = found.study, found.scenarios
    best = found.worst.value
    for large in np.geomspace(500.0, 3e4, 4):
        for small in np.geomspace(500.0, 3e4, 4):
            springs = np.array([large, small, small])
            fixed = replace(study, lower=springs, upper=springs, nominal=springs)
            value = best
            with suppress(Infeasible):
                value = robust_design(fixed, scenarios, InProcess()).worst.value
            sign = -1 if study.objective.more_is_better else 1
            assert sign * value >= sign * best - 1e-3 * best, springs


def test_every_objective_says_what_it_is() -> None:
    for kind, objective in kinds_in(package, Objective).items():
        assert objective.__doc__, kind
        assert getattr(objective, "unit", ""), kind


@pytest.mark.parametrize(
    ("table", "reason"),
    [
        ("kind = 'beauty'", "unknown objective 'beauty'"),
        ("kind = 3", "must be a name"),
        ("kind = 'safe_speed'\nslowest = 1", r"safe_speed\.slowest: unknown"),
    ],
)
def test_objectives_that_cannot_be(tmp_path: Path, table: str, reason: str) -> None:
    with pytest.raises(InvalidValue, match=reason):
        small_study(tmp_path, f"[objective]\n{table}")


def test_lengths_must_fit_the_scenarios(tmp_path: Path) -> None:
    study = small_study(tmp_path, "[objective]\nkind = 'task_time'\nlengths = [1.0, 2.0]")
    with pytest.raises(InvalidValue, match=r"objective\.lengths: needs 4 numbers"):
        robust_design(study, scenarios_of(study), InProcess())


def test_more_than_can_be_looked_at_at_once_is_refused(tmp_path: Path) -> None:
    many = ", ".join("[0.0, 1.0, %g]" % (0.01 * i) for i in range(160))
    study = small_study(
        tmp_path, "[objective]\nkind = 'mean_force'", scenarios=f"directions = [{many}]"
    )
    with pytest.raises(InvalidValue, match="looks at every impact at once, and 320 are more"):
        robust_design(study, scenarios_of(study), InProcess())


@pytest.mark.parametrize(
    ("tables", "field"),
    [
        ("[objective]\nkind = 'safe_speed'", "objective"),
        ("[hardware]\ncatalogue = [2000.0]", "hardware.catalogue"),
        ("[hardware.cover]\nlower = 1e6\nupper = 1e7", "hardware.cover"),
    ],
)
def test_poses_by_themselves_refuse_what_they_cannot_do(
    tmp_path: Path, tables: str, field: str
) -> None:
    study = replace(small_study(tmp_path, tables), scenarios=None)
    with pytest.raises(InvalidValue, match=rf"{field}: needs 'softimpact design' and a table"):
        design(study, executor=InProcess())


@pytest.mark.parametrize("objective", ["safe_speed", "task_time"])
def test_what_is_told_was_looked_at(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, objective: str
) -> None:
    """Also where the search for a speed ends before it is found."""
    monkeypatch.setattr(certificate, "SECANTS", 1)
    study = study_of(tmp_path, objective)
    setting = setting_of(study, scenarios_of(study), InProcess(), elsewhere=False)
    at = Hardening(setting.limits.vector(study.nominal), setting.given)
    worst, _ = setting.worst(at)
    again, _ = setting.worst(replace(at, factors=worst.factors))
    assert (worst.value, worst.share) == pytest.approx((again.value, again.share))
