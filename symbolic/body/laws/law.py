# SPDX-License-Identifier: BSD-3-Clause
"""What a law of contact is: the force over how deep the robot presses."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any, ClassVar, Protocol, TypeVar

from ...matrices import Matrix


class Law(Protocol):
    """A law f(δ) of skin, pad or cover, as a frozen dataclass that derives from this class.

    f is zero for δ ≤ 0, rises with δ > 0, and has a slope that CasADi can form. It is stated once,
    in ``force``; simulation, design and figures read it there.

    Attributes:
        parameters: names of the fields that may vary from one impact to the next without another
            integrator being built; the expression must accept symbols for them.
        kind: what files call the law; empty where they cannot.
    """

    kind: ClassVar[str] = ""
    parameters: ClassVar[tuple[str, ...]] = ()

    @property
    def reach(self) -> float:
        """Force up to which the law is known [N]; beyond it, the worse case is assumed."""
        return float("inf")

    def force(self, depth: Matrix) -> Matrix:
        """Return f [N] for depths δ [m] of any shape (SX, MX or DM)."""
        ...

    def check(self) -> None:
        """Raise InvalidValue if a number of the law cannot be."""
        return


AnyLaw = TypeVar("AnyLaw", bound=Law)


def numbers_of(law: Law) -> list[float]:
    """Return the values of a law's parameters."""
    return [getattr(law, name) for name in law.parameters]


def with_numbers(law: AnyLaw, values: Sequence[Matrix]) -> AnyLaw:
    """Return a law with other parameters, numbers or symbols, in the order of ``numbers_of``."""
    named: dict[str, Any] = dict(zip(law.parameters, values, strict=True))
    return replace(law, **named)  # type: ignore[type-var]


def form_of(law: AnyLaw) -> AnyLaw:
    """Return a law with 1 for each parameter, equal for all laws of one form."""
    return with_numbers(law, [1.0] * len(law.parameters))
