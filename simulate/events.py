# SPDX-License-Identifier: BSD-3-Clause
"""Run an impact until it is over, and find its peaks and its end to event accuracy.

The nodes of a run bracket each event; the bracket is simulated once more from its first node, with
as many nodes, and what is left is interpolated.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from softimpact.symbolic import InvalidValue, Law
from softimpact.symbolic.robot.rigid import Array

from .simulator import NODES, Run, Scene

SPAN = 0.02
"""Longest single run [s]."""

LONGEST = 2.0
"""When a contact that does not end is given up [s]."""


@dataclass(frozen=True)
class Event:
    """Time [s] of an event and contact force [N] at it."""

    time: float
    force: float


@dataclass(frozen=True, eq=False)
class FirstContact:
    """A run from first touch on, and what happened in it.

    Attributes:
        run: at least until the first contact ends, unless it was cut short.
        first_peak: first local maximum of the force.
        highest: largest force until separation.
        separation: end of the first contact [s], None if it is beyond the run.
    """

    run: Run
    first_peak: Event
    highest: Event
    separation: float | None


def first_contact(scene: Scene, duration: float | None = None) -> FirstContact:
    """Simulate an impact from first touch.

    Args:
        scene: robot and body, about to touch.
        duration: how long [s]; None: until shortly after separation.

    Raises:
        InvalidValue: the duration is not positive, or ends before the first peak.
        SimulationFailed: the integrator gave up.
    """
    if duration is not None and not 0 < duration < np.inf:
        raise InvalidValue("duration", f"must be finite and greater than 0 s, not {duration}")
    run = _whole_run(scene, duration)
    ends = _downward(run.depth)
    last = int(ends[0]) if ends.size else len(run.time) - 1
    peaks = [int(i) for i in _downward(run.closing) if i <= last]
    if not peaks:
        over = f"{duration or LONGEST:g} s end before the force has reached its first peak"
        raise InvalidValue("duration", over)
    top = max(peaks, key=lambda i: _vertex(run, i, scene.contact.law).force)
    first_peak = _refined_peak(scene, run, peaks[0])
    highest = first_peak if top == peaks[0] else _refined_peak(scene, run, top)
    if not ends.size and run.force[-1] > highest.force:  # cut short while it rises again
        highest = Event(float(run.time[-1]), float(run.force[-1]))
    separation = _refined_end(scene, run, last) if ends.size else None
    return FirstContact(run, first_peak, highest, separation)


def _whole_run(scene: Scene, duration: float | None) -> Run:
    starts = _starts(scene, duration or LONGEST)
    runs: list[Run] = []
    for start, end in pairwise(starts):
        state = runs[-1].state[:, -1] if runs else scene.touch
        run = scene.run(state, end - start, start)
        runs.append(_later(run, start) if runs else run)
        if duration is None and _downward(run.depth).size:
            break
    return _joined(runs)


def _starts(scene: Scene, duration: float) -> Array:
    """Return when runs start and the last one ends: at most SPAN apart, and at the switch."""
    marks = [0.0, duration]
    if scene.switch is not None and scene.switch.time < duration:
        marks.insert(1, scene.switch.time)
    pieces = [
        np.linspace(a, b, math.ceil((b - a) / SPAN), endpoint=False) for a, b in pairwise(marks)
    ]
    return np.append(np.concatenate(pieces), duration)


def _joined(runs: list[Run]) -> Run:
    names = vars(runs[0])
    return Run(**{n: np.concatenate([getattr(run, n) for run in runs], axis=-1) for n in names})


def _later(run: Run, start: float) -> Run:
    """Return a run without its first node, which the run before it holds, and shifted in time."""
    tail = {name: values[..., 1:] for name, values in vars(run).items()}
    return Run(**(tail | {"time": tail["time"] + start}))


def _downward(values: Array) -> NDArray[np.intp]:
    """Indices of the nodes after which values go from above zero to zero or below."""
    return np.flatnonzero((values[:-1] > 0) & (values[1:] <= 0))


def _refined_peak(scene: Scene, run: Run, index: int) -> Event:
    near = _bracket(scene, run, index)
    event = _vertex(near, _first(_downward(near.closing)), scene.contact.law)
    return Event(float(run.time[index]) + event.time, event.force)


def _refined_end(scene: Scene, run: Run, index: int) -> float:
    near = _bracket(scene, run, index)
    i = _first(_downward(near.depth))
    share = near.depth[i] / (near.depth[i] - near.depth[i + 1])
    return float(run.time[index] + near.time[i] + share * (near.time[i + 1] - near.time[i]))


def _bracket(scene: Scene, run: Run, index: int) -> Run:
    start, end = (float(t) for t in run.time[index : index + 2])
    return scene.run(run.state[:, index], end - start, start)


def _first(found: NDArray[np.intp]) -> int:
    """First index found; the last interval if rounding has moved the event just past its end."""
    return int(found[0]) if found.size else NODES - 1


def _vertex(run: Run, index: int, law: Law) -> Event:
    """Peak after a node: where δ̇, taken as linear between nodes, is zero."""
    before, after = run.closing[index], run.closing[index + 1]
    step = before / (before - after) * (run.time[index + 1] - run.time[index])
    depth = run.depth[index] + before * step / 2
    return Event(float(run.time[index] + step), float(law.force(ca.DM(depth))))
