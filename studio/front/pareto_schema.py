# SPDX-License-Identifier: BSD-3-Clause
"""The form of the Pareto command's ``results.json``, published as docs/pareto.schema.json."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel, ConfigDict, Field


class Part(BaseModel):
    """Of a record, with no fields but its own."""

    model_config = ConfigDict(extra="forbid")


class PointRecord(Part):
    """A design on a front."""

    bound: float = Field(description="on the deflection, with which it was sought [m]")
    deflection: float = Field(description="largest of the tip by the springs [m]")
    force: float = Field(description="largest peak [N]")
    start: str = Field(description="pose that the search began with")
    mode: str = Field(description="table: posture held; free: sought")
    status: str = Field(description="Ipopt's")
    iterations: int
    attempts: int
    violation: float = Field(description="largest of a constraint, in the NLP's units")
    q: list[float] = Field(description="posture [rad]")
    springs: list[float] = Field(description="joint stiffness [N·m/rad]")


class CheckedRecord(Part):
    """A force by independent simulation [N]."""

    nlp: float
    linearised: float
    full: float


class PriceRecord(Part):
    """What a bound costs: how much a little more room buys, to first order."""

    bound: str
    newtons: float | None = Field(description="force saved [N]")
    room: str = Field(description="how much more")
    gain: float
    unit: str = Field(description="of gain")


class CheckedPointRecord(PointRecord):
    """A design on a front, simulated."""

    meets_limit: bool
    safe_speed: float = Field(description="at which the force is the limit [m/s]")
    check: CheckedRecord
    prices: list[PriceRecord] = Field(
        description="what each bound that binds costs, the dearest first"
    )
    indifferent: dict[str, list[float]] = Field(
        description="range of each value that costs less than 0.5 %, the others held"
    )
    knee: bool = Field(description="whether the front bends there")


class Unsolved(Part):
    """A level at which Ipopt failed."""

    bound: float
    status: str
    force: float
    violation: float


class ReferenceRecord(Part):
    """The design to improve on."""

    name: str
    q: list[float]
    springs: list[float]
    deflection: float
    force: float
    safe_speed: float


class Fronts(Part):
    """Fronts, the most accurate design first; none of a front beats another in both."""

    free: list[CheckedPointRecord]
    given: list[CheckedPointRecord]
    task: list[CheckedPointRecord]


class Solver(Part):
    """How the impacts were integrated, and how many searches there were."""

    compiled: bool
    searches: int
    impact_duration: float = Field(description="[s]")
    impact_steps: int


class ParetoResults(Part):
    """Everything that ``softimpact pareto`` found."""

    generator: str
    versions: dict[str, str]
    study: dict[str, Any] = Field(description="what was asked")
    region: str
    limit: float = Field(description="force that reaches a limit of the region [N]")
    limit_kind: str
    peak_definition: str
    warnings: list[str] = Field(description="what was ignored, and what limits are worth")
    accuracy: str
    solver: Solver
    levels: list[float] = Field(description="bounds on the deflection [m]")
    reference: ReferenceRecord
    fronts: Fronts
    held: dict[str, list[PointRecord]] = Field(description="front of each given pose")
    unsolved: dict[str, list[Unsolved]]
