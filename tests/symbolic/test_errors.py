# SPDX-License-Identifier: BSD-3-Clause
"""Errors carry data, say what to do in one line, and share one base."""

import inspect

import pytest

from softimpact.symbolic import errors
from softimpact.symbolic.errors import (
    FrameNotFound,
    InvalidInertia,
    InvalidValue,
    LoopCannotClose,
    LoopError,
    MasslessBase,
    ModelFileError,
    NoEquilibrium,
    RedundantLoop,
    SingularDirection,
    SingularLoop,
    SoftImpactError,
    UnknownName,
    UnsupportedModel,
    WrongLength,
)

EXAMPLES = [
    (ModelFileError("a.urdf", "no such file"), {"path": "a.urdf", "reason": "no such file"}),
    (InvalidInertia("a.urdf", "arm", "mass is negative"), {"path": "a.urdf", "body": "arm"}),
    (UnsupportedModel("a.xml", "closed chains"), {"path": "a.xml", "reason": "closed chains"}),
    (UnknownName("region", "nose", ["head"]), {"name": "nose", "known": ("head",)}),
    (FrameNotFound("tool", ["hand"]), {"name": "tool", "known": ("hand",)}),
    (InvalidValue("speed", "must be positive"), {"field": "speed", "reason": "must be positive"}),
    (WrongLength("q", 3, 2, ["j1", "j2"]), {"field": "q", "found": 3, "expected": 2}),
    (SingularDirection([0, 0, 1], "choose another"), {"direction": (0.0, 0.0, 1.0)}),
    (MasslessBase("arm"), {"robot": "arm"}),
    (NoEquilibrium(0.5, "raise the stiffness"), {"residual": 0.5}),
    (LoopError("pin", "is not what it must be"), {"loop": "pin"}),
    (LoopCannotClose("pin", 0.05, "check its points"), {"loop": "pin", "gap": 0.05}),
    (RedundantLoop("pin", "is redundant"), {"loop": "pin"}),
    (SingularLoop("pin", "is at a dead point"), {"loop": "pin"}),
]


@pytest.mark.parametrize(("error", "data"), EXAMPLES, ids=lambda x: type(x).__name__)
def test_errors_carry_what_they_say(error: SoftImpactError, data: dict[str, object]) -> None:
    message = str(error)
    assert message
    assert "\n" not in message
    for name, value in data.items():
        assert getattr(error, name) == value
    shown = [value for value in data.values() if isinstance(value, str)]
    assert all(value in message for value in shown)


def test_every_error_has_an_example() -> None:
    classes = {cls for _, cls in inspect.getmembers(errors, inspect.isclass)}
    tested = {type(error) for error, _ in EXAMPLES} | {SoftImpactError}
    assert {cls for cls in classes if issubclass(cls, Exception)} == tested


def test_nothing_known_is_said_so() -> None:
    assert str(UnknownName("robot", "x", [])).endswith("known: (none)")


def test_a_vector_without_names_still_says_its_length() -> None:
    assert str(WrongLength("q", 1, 2)) == "q: has 1 values, but 2 are needed"
