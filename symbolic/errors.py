# SPDX-License-Identifier: BSD-3-Clause
"""What can go wrong with input, as classes that carry data and say what to do."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from difflib import get_close_matches


class SoftImpactError(Exception):
    """Base of every error that a user can cause and mend (exit code 2)."""


class ModelFileError(SoftImpactError):
    """A robot description cannot be read."""

    def __init__(self, path: str, reason: str) -> None:
        super().__init__(f"{path}: {reason}")
        self.path, self.reason = path, reason


class InvalidInertia(ModelFileError):
    """A body's mass or inertia is missing or physically impossible."""

    def __init__(self, path: str, body: str, reason: str) -> None:
        super().__init__(path, f"body '{body}': {reason}")
        self.body = body


class UnsupportedModel(ModelFileError):
    """The description holds something that this version cannot model."""


def did_you_mean(name: str, known: Iterable[str]) -> str:
    """Return the end of a message that names what was probably meant; empty where nothing was."""
    plain = {other.casefold().replace("-", "_"): other for other in known}
    near = get_close_matches(name.casefold().replace("-", "_"), plain, n=1)
    return f"; did you mean '{plain[near[0]]}'?" if near else ""


class UnknownName(SoftImpactError):
    """A name that does not exist, with those that do, the nearest one last."""

    def __init__(self, what: str, name: str, known: Iterable[str]) -> None:
        self.name, self.known = name, tuple(known)
        others = ", ".join(self.known) or "(none)"
        meant = did_you_mean(name, self.known)
        super().__init__(f"unknown {what} '{name}'; known: {others}{meant}")


class FrameNotFound(UnknownName):
    """A frame that the robot does not have; lists the frames that exist."""

    def __init__(self, name: str, known: Iterable[str]) -> None:
        super().__init__("frame", name, known)


class InvalidValue(SoftImpactError):
    """A number, vector or option outside what its meaning allows."""

    def __init__(self, field: str, reason: str) -> None:
        super().__init__(f"{field}: {reason}")
        self.field, self.reason = field, reason


class WrongLength(InvalidValue):
    """A vector whose length does not fit the robot."""

    def __init__(self, field: str, found: int, expected: int, names: Sequence[str] = ()) -> None:
        order = f" (in the order {', '.join(names)})" if names else ""
        super().__init__(field, f"has {found} values, but {expected} are needed{order}")
        self.found, self.expected = found, expected


class SingularDirection(SoftImpactError):
    """The contact point cannot move along the direction of impact."""

    def __init__(self, direction: Sequence[float], hint: str) -> None:
        self.direction = tuple(float(d) for d in direction)
        shown = ", ".join(f"{d:g}" for d in self.direction)
        super().__init__(f"the contact point cannot move along direction [{shown}]: {hint}")


class NoEquilibrium(SoftImpactError):
    """No static equilibrium under gravity was found."""

    def __init__(self, residual: float, hint: str) -> None:
        self.residual = residual
        super().__init__(
            f"no static equilibrium under gravity (residual torque {residual:.3g} N·m): {hint}"
        )


class LoopError(SoftImpactError):
    """A loop of a closed chain is not what it must be; ``loop`` is its name."""

    def __init__(self, loop: str, reason: str) -> None:
        self.loop = loop
        super().__init__(f"loop '{loop}' {reason}")


class LoopCannotClose(LoopError):
    """The two ends of a loop do not meet."""

    def __init__(self, loop: str, gap: float, hint: str) -> None:
        self.gap = gap
        super().__init__(loop, f"does not close: its ends stay {gap:.3g} m apart; {hint}")


class RedundantLoop(LoopError):
    """A loop asks for what other loops, or the joints alone, already see to."""


class SingularLoop(LoopError):
    """The dependent joints of a closed chain do not follow from the independent ones."""


class MasslessBase(SoftImpactError):
    """A base that is to float has no mass."""

    def __init__(self, robot: str) -> None:
        self.robot = robot
        super().__init__(
            f"robot '{robot}': its base has no mass, so it cannot float; "
            "give the root link an <inertial> element"
        )
