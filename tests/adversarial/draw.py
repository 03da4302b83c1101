# SPDX-License-Identifier: BSD-3-Clause
"""Random inputs of safe speeds, and neighbours of inputs for hill climbing."""

from __future__ import annotations

import math
import random as plain_random
from collections.abc import Callable
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

from softimpact.codegen.inputs.closed_samples import closed_configurations
from softimpact.symbolic import REGIONS
from softimpact.symbolic.body.contact import HERTZ_STIFFNESS
from softimpact.symbolic.robot.rigid import Array

from .cases import Cases
from .impacts import Robot
from .laws import laws
from .questions import AT_REST, QUESTIONS, Question

POOL = 400
"""Configurations of a closed chain from which one is chosen."""

SPRINGS, ROTORS, GAINS = (300.0, 1e5), (0.05, 2.0), (10.0, 1e5)
"""What arms have: springs and gains [N·m/rad], reflected inertias [kg·m²]."""

WIDE_SPRINGS, WIDE_ROTORS, WIDE_GAINS = (10.0, 1e8), (1e-4, 100.0), (1.0, 1e7)
"""The same, far beyond what arms have."""


class Draw:
    """Draws inputs of a robot's safe speeds.

    Args:
        robot: the package.
        random: source of all that is drawn.
        wide: numbers of drives and bodies over many decades, not those that there are.
        question: what is asked.
    """

    def __init__(
        self,
        robot: Robot,
        random: np.random.Generator,
        *,
        wide: bool,
        question: Question = QUESTIONS["limit"],
    ) -> None:
        self.robot, self.random, self.wide, self.question = robot, random, wide, question

    @cached_property
    def plane(self) -> Array:
        """Projector on the directions in which motors move the contact point."""
        robot, count = self.robot, 8
        J = robot.jacobians(self.poses(count))
        moved = np.hstack(list(J * robot.actuated))
        U, sizes, _ = np.linalg.svd(moved)
        basis = U[:, : int((sizes > 1e-9 * sizes[0]).sum())]
        return np.asarray(basis @ basis.T)

    @property
    def reach(self) -> int:
        """In how many directions that is."""
        return round(float(np.trace(self.plane)))

    @cached_property
    def pool(self) -> Array:
        """Configurations of a closed chain."""
        return np.array(
            closed_configurations(self.robot.package.robot, plain_random.Random(5), POOL)
        )

    def uniform(self, low: Any, high: Any, count: int) -> Array:
        """Return numbers between two."""
        return np.asarray(self.random.uniform(low, high, count))

    def decades(self, low: float, high: float, count: int) -> Array:
        """Return numbers between two whose logarithms are uniform."""
        return np.asarray(np.exp(self.uniform(math.log(low), math.log(high), count)))

    def one_of(self, *choices: tuple[float, Callable[[], Array] | Array | float]) -> Array:
        """Return rows of alternatives, each chosen with its probability."""
        chances = np.cumsum([chance for chance, _ in choices])
        pick = np.searchsorted(chances, self.random.random(self.count) * chances[-1])
        made = [x() if callable(x) else x for _, x in choices]
        return np.choose(np.minimum(pick, len(made) - 1), made)  # type: ignore[no-any-return,arg-type]

    def spread(self, low: float, high: float) -> Array:
        """Return numbers a joint: all alike, each its own, or at the ends."""
        shape = (self.count, self.robot.joints)
        how = self.random.random((self.count, 1))
        alike, own = self.random.random((self.count, 1)), self.random.random(shape)
        share = np.where(how < 0.4, alike, np.where(how < 0.8, own, np.round(own)))
        return np.asarray(low * (high / low) ** share)

    def poses(self, count: int) -> Array:
        """Return configurations: anywhere, at limits, or near those where axes align."""
        robot, random = self.robot, self.random
        if robot.package.robot.loops:
            return np.asarray(self.pool[random.integers(0, len(self.pool), count)])
        shape = (count, robot.joints)
        span = robot.upper - robot.lower
        q = robot.lower + span * random.random(shape)
        how = random.random((count, 1))
        ends = np.where(random.random(shape) < 0.5, robot.lower, robot.upper)
        some = random.random(shape) < 0.5
        quarter = np.round(q / (math.pi / 2)) * (math.pi / 2)
        near = quarter + random.normal(size=shape) * 10 ** random.uniform(-5, -1, (count, 1))
        q = np.where((how < 0.2) & some, ends, q)
        q = np.where((how > 0.7) & some, np.clip(near, robot.lower, robot.upper), q)
        return np.asarray(q)

    def directions(self, J: Array) -> Array:
        """Return directions: any, along axes, or where the contact point hardly moves.

        Args:
            J: Jacobians of contact points.
        """
        random, count = self.random, len(J)
        n = random.normal(size=(count, 3))
        how = random.random((count, 1))
        axes = np.eye(3)[random.integers(0, 3, count)]
        moved = self.plane @ (J * self.robot.actuated)
        weakest = np.linalg.svd(moved)[0][:, :, self.reach - 1]
        tilted = weakest + n * 10 ** random.uniform(-4, 0, (count, 1))
        n = np.where(how < 0.2, axes, np.where(how > 0.85, tilted, n)) @ self.plane
        lost = np.linalg.norm(n, axis=1) < 1e-6
        n[lost] = weakest[lost]
        return np.asarray(n)

    def bodies(self) -> dict[str, Array]:
        """Return parts of the body, clamped or free, and limits of force."""
        one_of, decades, count = self.one_of, self.decades, self.count
        regions = list(REGIONS.values())
        which = self.random.integers(0, len(regions), count)
        of = {
            name: np.array([getattr(r, name) for r in regions])[which]
            for name in ("stiffness", "effective_mass", "force_limit")
        }
        if not self.wide:
            return {
                "stiffness": of["stiffness"],
                "damping": one_of((0.7, 10.0), (0.3, lambda: decades(10, 1000, count))),
                "mass": one_of((1, 0.0), (1, of["effective_mass"])),
                "skin": np.full(count, HERTZ_STIFFNESS),
                "limit": of["force_limit"],
            }
        return {
            "stiffness": one_of((1, of["stiffness"]), (2, lambda: decades(100, 1e7, count))),
            "damping": one_of((1, 0.0), (1, 10.0), (3, lambda: decades(0.01, 1e4, count))),
            "mass": one_of((1, 0.0), (1, lambda: decades(0.01, 1000, count))),
            "skin": one_of((1, HERTZ_STIFFNESS), (1, lambda: decades(1e5, 1e9, count))),
            "limit": one_of((1, of["force_limit"]), (2, lambda: decades(1, 1e4, count))),
        }

    def cases(self, count: int) -> Cases:
        """Return random inputs."""
        self.count = count
        random, one_of, decades, wide = self.random, self.one_of, self.decades, self.wide
        rotors = self.spread(*(WIDE_ROTORS if wide else ROTORS))
        gains = self.spread(*(WIDE_GAINS if wide else GAINS))
        gains *= random.random((count, 1)) < 0.9
        ratio = 10 ** random.uniform(-1, 1, (count, 1)) if wide else random.random((count, 1))
        horizon = one_of((0.75, 0.1), (0.05, 0.5), (0.2, lambda: decades(1e-3, 0.2, count)))
        times = np.array([0.0, 0.005, 0.02, 0.05, 10.0])[random.integers(0, 5, count)]
        q, asked = self.poses(count), self.question
        frame, place = np.full(count, -1, np.int32), np.zeros((count, 3))
        if asked.elsewhere:
            frame = random.integers(0, len(self.robot.frames), count).astype(np.int32)
            place = random.normal(size=(count, 3)) * one_of((1, 0.0), (3, 0.15))[:, None]
        J = self.robot.jacobians(q, frame, place)
        dq = np.zeros(q.shape)
        if asked.moves:
            dq = random.normal(size=q.shape) * decades(0.1, 10, count)[:, None]
            dq[:] *= random.random(q.shape) < random.random((count, 1)) + 0.2
        bodies = self.bodies()
        numbers = random.integers(1, len(laws()) + 1, count) * (random.random(count) < asked.laws)
        return self.consistent(Cases(
            q=q,
            n=self.directions(J),
            dq=dq,
            springs=self.spread(*(WIDE_SPRINGS if wide else SPRINGS)),
            rotors=rotors,
            gains=gains,
            damping_gains=2 * ratio * np.sqrt(gains * rotors),
            motors=random.integers(0, 4, count).astype(np.int32),
            steps=one_of((5, 800.0), (2, 8000.0), (1.5, 250.0), (
                1.5, lambda: np.floor(decades(1, 100, count)))).astype(np.int32),
            reaction=one_of((6, times), (3, horizon * random.random(count)), (0.5, horizon),
                            (0.5, 1e-5)),
            horizon=horizon,
            law=numbers.astype(np.int32),
            pressing=bodies["limit"] * one_of((2, 0.5), (1, lambda: decades(0.01, 2, count))),
            speed=decades(0.02, 4, count),
            frame=frame,
            place=place,
            **bodies,
        ))  # fmt: skip

    def consistent(self, cases: Cases) -> Cases:
        """Return inputs exact in float, and whose directions are those of their velocities."""
        cases = cases.rounded()
        if not self.question.moves:
            return cases
        moved = self.robot.moved(cases)
        still = np.linalg.norm(moved, axis=1) < AT_REST
        dq = np.where(still[:, None], 0.0, cases.dq)
        return replace(cases, n=np.where(still[:, None], cases.n, moved), dq=dq)

    def changed(self, cases: Cases) -> Cases:
        """Return a neighbour of each input."""
        random, robot, count = self.random, self.robot, len(cases)
        scale = 10 ** random.uniform(-2.5, -0.3, (count, 1))

        def some(shape: tuple[int, ...]) -> Array:
            return np.asarray(random.normal(size=shape) * (random.random(shape) < 0.4))

        def turned(x: Array, low: float, high: float) -> Array:
            return np.clip(x * np.exp(scale * some(x.shape)), low, high)

        def turned_one(x: Array) -> Array:
            return np.asarray(x * np.exp(scale[:, 0] * some(x.shape)))

        q = cases.q + scale * some(cases.q.shape)
        q = self.poses(count) if robot.package.robot.loops else np.clip(q, robot.lower, robot.upper)
        length = np.linalg.norm(cases.n, axis=1, keepdims=True)
        n = (cases.n / length + 0.5 * scale * random.normal(size=(count, 3))) @ self.plane
        wide = self.wide
        body: dict[str, Any] = {
            name: turned_one(getattr(cases, name)) for name in ("stiffness", "mass", "skin")
        }
        return self.consistent(replace(
            cases,
            q=q,
            n=n,
            springs=turned(cases.springs, *(WIDE_SPRINGS if wide else SPRINGS)),
            rotors=turned(cases.rotors, *(WIDE_ROTORS if wide else ROTORS)),
            gains=turned(cases.gains, 0, (WIDE_GAINS if wide else GAINS)[1]),
            damping_gains=turned(cases.damping_gains, 0, 1e9),
            reaction=turned_one(cases.reaction),
            limit=turned_one(cases.limit),
            pressing=turned_one(cases.pressing),
            speed=turned_one(cases.speed),
            dq=cases.dq * np.exp(scale) + scale * some(cases.dq.shape) * (cases.dq != 0),
            place=cases.place + 0.1 * scale * some(cases.place.shape),
            damping=turned_one(cases.damping),
            **(body if wide else {}),
        ))  # fmt: skip
