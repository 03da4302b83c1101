# SPDX-License-Identifier: BSD-3-Clause
"""What an objective is: how far each impact's force may go, and what that is worth."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, ClassVar, Protocol

from softimpact.symbolic import Matrix
from softimpact.symbolic.robot.rigid import Array, Indices

if TYPE_CHECKING:
    from ..study.scenarios import Scenarios


@dataclass(frozen=True, eq=False)
class Own:
    """Variables that an objective adds to the search: their ends and where they start."""

    lower: Array
    upper: Array
    start: Array


class Objective(Protocol):
    """An objective, as a frozen dataclass that derives from this class.

    The search asks that each impact, as fast as ``speeds`` says, gives no more than ``levels`` of
    the force that counts as one there, and makes ``cost`` small.

    An impact is given by the number of its scenario: what motors may do gives a scenario several.

    Attributes:
        kind: its name in the table ``[objective]`` of a study file.
        unit: of ``value``.
        more_is_better: whether ``value`` is to be large.
        scales_speed: whether it changes how fast impacts are.
        all_scenarios: whether every scenario counts, and not the worst alone.
        span: values between which a front holds it unless it is told others; None where it can
            only be sought.
    """

    kind: ClassVar[str] = ""
    unit: ClassVar[str] = ""
    scales_speed: ClassVar[bool] = False
    more_is_better: ClassVar[bool] = False
    all_scenarios: ClassVar[bool] = False
    span: ClassVar[tuple[float, float] | None] = None

    def own(self, scenarios: Indices, shares: Array, speeds: Array) -> Own:
        """Return the objective's variables.

        Args:
            scenarios: number of each impact's, from zero on, length C.
            shares: of its force where the search starts, over what counts as one, C.
            speeds: of the impacts as the study has them, C [m/s].
        """
        ...

    def levels(self, own: Matrix, scenarios: Indices) -> Matrix:
        """Return the share that each impact may reach, C."""
        ...

    def speeds(self, own: Matrix, scenarios: Indices) -> Matrix:
        """Return log10 of the factor on each impact's speed, C; zero where it stays."""
        ...

    def value(self, own: Array, scenarios: Indices, speeds: Array) -> float:
        """Return what the objective is, in ``unit``, as people are told it."""
        ...

    def cost(self, own: Matrix, scenarios: Indices, speeds: Matrix) -> Matrix:
        """Return what is made small, in a unit in which one is much and 1e-4 is little."""
        ...

    def held(self, scenarios: Scenarios, value: float) -> Scenarios:
        """Return scenarios in which another objective is sought while this one has a value.

        Only asked of objectives with a ``span``.
        """
        raise NotImplementedError
