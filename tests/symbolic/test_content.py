# SPDX-License-Identifier: BSD-3-Clause
"""What was read or built twice is one and the same: equality by content, and caches keyed by it."""

from __future__ import annotations

import pickle
import sys
from collections.abc import Iterator
from dataclasses import fields, replace
from typing import Any

import casadi as ca
import numpy as np
import pytest

from softimpact.simulate import Approach, simulate_impact
from softimpact.symbolic import (
    Contact,
    Coupling,
    ImpactModel,
    Joint,
    JointKind,
    Motors,
    Robot,
    Tendon,
    analyse,
    body_region,
    drives,
    impact_model,
    load_robot,
    lock_joints,
    mass_matrix,
)
from softimpact.symbolic.content import ByContent
from softimpact.symbolic.robot.rigid import Inertia, Placement
from softimpact.symbolic.robot.robot import PointMass

ELSEWHERE = Placement(np.eye(3), np.array([0.0, 0.0, 1e-15]))
HEAVIER = Inertia(1.0, np.zeros(3), np.eye(3))
OTHER_ROBOT: dict[str, Any] = {
    "name": "other",
    "frames": {},
    "tip": "flange",
    "rotor_inertia_sets": {},
    "loops": (Coupling("c", (("joint1", 1.0),), (), ()),),
    "home": (0.0,) * 7,
    "independent": ("joint1",),
    "base_inertia": HEAVIER,
    "payload": PointMass("flange", 1.0, (0.0, 0.0, 0.0)),
    "tendons": (Tendon("t", ()),),
    "source": "elsewhere.urdf",
    "rotors_stated": True,
    "warnings": ("beware",),
    "joints": (),
}
OTHER_JOINT: dict[str, Any] = {
    "name": "other",
    "kind": JointKind.SLIDE,
    "parent": -1,
    "placement": ELSEWHERE,
    "inertia": HEAVIER,
    "actuated": False,
}
"""Of fields that are no numbers."""


@pytest.mark.parametrize("field", [field.name for field in fields(Robot)])
def test_a_robot_is_all_that_it_holds(panda: Robot, field: str) -> None:
    changed = replace(panda, **{field: OTHER_ROBOT[field]})
    assert changed != panda
    assert replace(changed, **{field: getattr(panda, field)}) == panda


@pytest.mark.parametrize("field", [field.name for field in fields(Joint)])
def test_a_joint_is_all_that_it_holds_to_the_last_bit(panda: Robot, field: str) -> None:
    joint = panda.joints[3]
    if field in OTHER_JOINT:
        other = OTHER_JOINT[field]
    else:
        before = getattr(joint, field)
        other = np.nextafter(before, 0.0) if np.isfinite(before) and before else 1e-300
    assert replace(joint, **{field: other}) != joint


def test_copies_are_one_key(panda: Robot) -> None:
    copy = load_robot("panda")
    assert copy is not panda
    assert {panda, copy, pickle.loads(pickle.dumps(panda))} == {panda}
    assert panda != "panda"
    assert drives(copy, 1e4) == drives(panda, 1e4)
    assert drives(copy, 1e4) != drives(panda, 2e4)


def test_a_symbol_is_itself_alone(panda: Robot) -> None:
    first, second = ca.SX.sym("m"), ca.SX.sym("m")
    assert panda.with_payload("flange", first) == panda.with_payload("flange", first)
    assert panda.with_payload("flange", first) != panda.with_payload("flange", second)
    springs = drives(panda, 1e4)
    for x, y in ((first, second), (ca.MX.sym("m"), ca.MX.sym("m"))):
        assert replace(springs, gains=x) == replace(springs, gains=x)
        assert replace(springs, gains=x) != replace(springs, gains=y)
    assert panda.with_payload("flange", first).digest() == (
        panda.with_payload("flange", second).digest()
    )


def test_what_has_no_content_is_refused(panda: Robot) -> None:
    odd: Any = {"a", "b"}
    with pytest.raises(TypeError, match="set has no content"):
        _ = replace(panda, warnings=odd).content


def caches() -> Iterator[Any]:
    """Yield every function of the project that keeps what it returned."""
    for name, module in list(sys.modules.items()):
        if name.startswith("softimpact."):
            for value in vars(module).values():
                if hasattr(value, "cache_info") and value.__module__ == name:
                    yield value


def misses() -> dict[str, int]:
    return {f"{c.__module__}.{c.__name__}": c.cache_info().misses for c in caches()}


def everything(robot: Robot) -> ImpactModel:
    """Ask a robot for what caches keep."""
    model = impact_model(robot, drives=drives(robot, 1e4, 0.1), gravity=(0, 0, -9.81))
    q, n = np.linspace(0.9, -1.5, robot.n), np.array([0.0, 1.0, 0.0])
    analyse(model, q, n)
    mass_matrix(robot, ca.MX.sym("q", robot.n))
    contact, approach = Contact(body_region("chest")), Approach(q, n, 0.3)
    for fidelity in ("linearised", "full"):
        simulate_impact(model, approach, contact, fidelity, motors=Motors("free"), horizon=0.01)
    return model


def test_a_copy_costs_no_second_derivation() -> None:
    wrist = {f"joint{i}": 0.3 for i in range(5, 8)}
    first, second = (lock_joints(load_robot("panda"), wrist) for _ in range(2))
    everything(first)
    before = misses()
    assert len(before) > 5
    assert everything(second).robot is second
    assert misses() == before


def test_what_is_cached_by_robot_is_compared_by_content() -> None:
    for kept in (Robot, Joint, Placement, Inertia, ImpactModel):
        assert issubclass(kept, ByContent)
        assert kept.__eq__ is ByContent.__eq__
        assert kept.__hash__ is ByContent.__hash__
