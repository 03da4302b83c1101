# SPDX-License-Identifier: BSD-3-Clause
"""The form of fronts over objectives in ``results.json``: docs/objectives.schema.json."""

from __future__ import annotations

from typing import Any, Literal

from pydantic import Field

from .pareto_schema import Part, PriceRecord


class ObjectiveRecord(Part):
    """One of the quantities that the front trades."""

    kind: str = Field(description="name of an objective or a bound in study files")
    unit: str = Field(description="of its values")
    better: Literal["less", "more"]
    sought: bool = Field(description="made best at each level of the others")
    levels: list[float] | None = Field(description="at which it was held; null if it was sought")


class KeptRecord(Part):
    """How well a bound is kept, in the pose where it is kept worst."""

    name: str
    unit: str
    sense: Literal["most", "least"]
    figure: float
    limit: float
    share: float = Field(description="of the limit that is used; above 1 it is broken")


class ScenarioRecord(Part):
    """An impact."""

    pose: str
    point: str
    direction: list[float]
    region: str
    clamped: bool
    payload: float = Field(description="[kg]")
    speed: float = Field(description="[m/s]")
    motors: str
    limit: float = Field(description="largest force that it allows [N]")


class CheckRecord(Part):
    """The worst scenario's peak [N] as the optimiser has it and by independent simulation."""

    nlp: float
    linearised: float
    full: float = Field(description="of the nonlinear robot")


class CatalogueRecord(Part):
    """What springs that can be bought cost."""

    ideal_springs: list[float] = Field(description="of any stiffness [N·m/rad]")
    loss: float = Field(description="share of what was sought that the catalogue costs")
    tried: int = Field(description="combinations")


class TradePointRecord(Part):
    """A design that no other beats in all objectives."""

    values: dict[str, float] = Field(description="of the objectives, by kind, in their units")
    knee: bool = Field(description="whether the front bends there")
    springs: list[float] = Field(description="joint stiffness [N·m/rad]")
    others: dict[str, float] = Field(description="values of the other variables of the hardware")
    postures: dict[str, list[float]] = Field(description="of each pose [rad]")
    worst_force: float = Field(description="over all scenarios [N]")
    worst_share: float = Field(description="of the region's limit")
    worst_scenario: ScenarioRecord
    meets_limit: bool
    check: CheckRecord
    bounds: list[KeptRecord]
    indifferent: dict[str, list[float]] = Field(
        description="range of each value that costs less than 0.5 %, the others held"
    )
    prices: list[PriceRecord]
    catalogue: CatalogueRecord | None
    bound: float = Field(description="share of the limit that the scenarios that decide allow")
    status: str = Field(description="Ipopt's")


class BeforeRecord(Part):
    """The machine as it is."""

    values: dict[str, float]
    springs: list[float]
    worst_force: float
    worst_share: float
    keeps_bounds: bool = Field(description="those that no objective moves")
    breaks: list[str]


class TradeSolverRecord(Part):
    """How the impacts were integrated."""

    compiled: bool
    impact_duration: float = Field(description="[s]")
    impact_steps: int


class ObjectivesResults(Part):
    """What ``softimpact pareto`` found of a machine for scenarios."""

    generator: str
    form: Literal["objectives"]
    versions: dict[str, str]
    study: dict[str, Any] = Field(description="what was asked")
    peak_definition: str
    warnings: list[str] = Field(description="what was ignored, and what limits are worth")
    objectives: list[ObjectiveRecord] = Field(description="in the order they were asked for")
    scenarios: int
    points: list[TradePointRecord] = Field(description="best in the first objective first")
    before: BeforeRecord
    levels_searched: int
    levels_out_of_reach: int
    levels_not_sold: int = Field(description="that no springs of the catalogue keep")
    levels_unsolved: list[str] = Field(description="Ipopt's statuses where it failed")
    solver: TradeSolverRecord
