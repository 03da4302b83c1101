# SPDX-License-Identifier: BSD-3-Clause
"""A robot and a body about to touch, and the stages that the robot's motors go through."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import dataclass

import casadi as ca
import numpy as np

from softimpact.symbolic import Contact
from softimpact.symbolic.robot.rigid import Array

from .mechanism import body_parameters
from .simulator import NODES, UNIT_TIME, SimulationFailed, Simulator


@dataclass(frozen=True, eq=False)
class Motion:
    """How a robot's coordinates move, for an approach of 1 m/s; what they are, its model says.

    Attributes:
        position: length N, or N×K at K times.
        velocity: likewise.
    """

    position: Array
    velocity: Array


@dataclass(frozen=True, eq=False)
class Leg:
    """A robot from the moment on at which its motors began to follow a law.

    Attributes:
        simulator: of its equations.
        parameters: their numbers.
        start: its own coordinates at the beginning.
        memory: what its controller knows then, for an approach of 1 m/s.
        motion: from its own coordinates and the time since the beginning [s] to the robot's.
        torque: that a servo adds [N·m for 1 m/s], n×K, from the same; None without one.
    """

    simulator: Simulator
    parameters: Array
    start: Motion
    memory: Array
    motion: Callable[[Motion, Array], Motion]
    torque: Callable[[Motion, Array], Array] | None = None


@dataclass(frozen=True, eq=False)
class Stage:
    """What the motors do from a time on.

    Attributes:
        begin: since first touch [s].
        enter: from the robot's motion then to the leg that follows.
    """

    begin: float
    enter: Callable[[Motion], Leg]


@dataclass(frozen=True, eq=False)
class Run:
    """What happened at the nodes of a run.

    Attributes:
        time: since first touch [s], length K.
        state: scaled, one column a node: the robot's positions and velocities, its controller's
            memory, then the body's.
        depth: δ = x_c − x_0 [m], negative when apart.
        closing: dδ/dt [m/s].
        force: f_c [N].
        reading: force in the body's spring and damper [N], which is what a measuring device shows;
            it differs from f_c where a plate has a mass.
    """

    time: Array
    state: Array
    depth: Array
    closing: Array
    force: Array
    reading: Array


@dataclass(frozen=True, eq=False)
class Scene:
    """A robot and a body about to touch.

    Attributes:
        stages: of the robot's motors; the first begins at first touch.
        still: the robot's motion at first touch.
        speed: of the approach [m/s].
        contact: with the body.
    """

    stages: tuple[Stage, ...]
    still: Motion
    speed: float
    contact: Contact

    def state_of(self, leg: Leg, body: Array) -> Array:
        """Return the scaled state at the beginning of a leg, from that of the body."""
        robot = [leg.start.position / UNIT_TIME, leg.start.velocity, leg.memory / UNIT_TIME]
        return np.concatenate([*robot, body])

    def body_of(self, leg: Leg, state: Array) -> Array:
        """Return the body's part of a scaled state."""
        return state[2 * len(leg.start.position) + len(leg.memory) :]

    def at_rest(self, leg: Leg) -> Array:
        """Return the body's part of the state at first touch."""
        return np.zeros(leg.simulator.body_states)

    def own_motion(self, leg: Leg, state: Array) -> Motion:
        """Return the motion of a leg's own coordinates in scaled states, N×K."""
        n = len(leg.start.position)
        return Motion(state[:n] * UNIT_TIME, state[n : 2 * n])

    def run(self, leg: Leg, state: Array, span: float, start: float = 0.0) -> Run:
        """Simulate from a state over a span [s]; raises SimulationFailed.

        Args:
            leg: that the robot is on all the while.
            state: scaled, at the start.
            span: how long.
            start: time since first touch [s].
        """
        simulator = leg.simulator
        p = [*leg.parameters, *body_parameters(self.contact), self.speed, span]
        differential = simulator.differential
        initial = {"x0": state[:differential]}
        if differential < len(state):
            initial["z0"] = state[differential:]
        try:
            end = simulator.integrate(**initial, p=p)
        except RuntimeError as error:
            flags = re.findall(r'returned "(\w+)"', str(error))
            raise SimulationFailed(flags[0] if flags else str(error)) from None
        states = np.array(ca.vertcat(end["xf"], end["zf"]))
        seen = [np.array(row).ravel() for row in simulator.observe(states, p)]
        return Run(start + np.linspace(0, span, NODES + 1), states, *seen)


def one_stage(
    simulator: Simulator, parameters: Array, velocity: Array, memory: int = 0
) -> tuple[tuple[Stage, ...], Motion]:
    """Return the only stage of a robot whose motors never change what they do, and its start."""
    still = Motion(np.zeros_like(velocity), velocity)

    def enter(motion: Motion) -> Leg:
        return Leg(simulator, parameters, motion, np.zeros(memory), unchanged)

    return (Stage(0.0, enter),), still


def unchanged(motion: Motion, elapsed: Array) -> Motion:
    """Return a motion whose coordinates are the robot's own."""
    return motion
