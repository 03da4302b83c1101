# SPDX-License-Identifier: BSD-3-Clause
"""Run an impact up to a horizon, and find its peaks and the end of its first contact.

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

from softimpact.symbolic import Contact
from softimpact.symbolic.robot.rigid import Array

from .scene import Leg, Run, Scene
from .simulator import NODES

SPAN, LATER_SPAN = 0.02, 0.05
"""Longest single run [s]: while most contacts have their peaks, and later; a run to the end of the
first contact goes on in short ones, as a robot may not get far beyond it."""

EARLY = 0.1
"""Until when runs are short [s]."""

LONGEST = 2.0
"""When a contact that does not end is given up [s]."""


@dataclass(frozen=True)
class Event:
    """Time [s] of an event and contact force [N] at it."""

    time: float
    force: float


@dataclass(frozen=True, eq=False)
class Piece:
    """A run on one leg, of ``NODES`` intervals."""

    leg: Leg
    begin: float
    run: Run


@dataclass(frozen=True, eq=False)
class Course:
    """An impact from first touch on.

    Attributes:
        scene: robot and body.
        pieces: one after the other.
        run: all of them; its states are left out, as they differ in length.
    """

    scene: Scene
    pieces: tuple[Piece, ...]
    run: Run

    def peaks(self) -> list[int]:
        """Return the nodes after which the force has a local maximum."""
        return [int(i) for i in downward(self.run.closing) if self.run.force[i] > 0]

    def peak_near(self, index: int) -> Event:
        """Return the peak after a node, to event accuracy."""
        near = self._bracket(index)
        return vertex(near, _first(downward(near.closing)), self.scene.contact)

    def end_near(self, index: int) -> float:
        """Return when robot and body part after a node [s]."""
        near = self._bracket(index)
        i = _first(downward(near.depth))
        share = near.depth[i] / (near.depth[i] - near.depth[i + 1])
        return float(near.time[i] + share * (near.time[i + 1] - near.time[i]))

    def _bracket(self, index: int) -> Run:
        piece = self.pieces[min(index // NODES, len(self.pieces) - 1)]
        local = index - NODES * self.pieces.index(piece)
        start, end = (float(t) for t in piece.run.time[local : local + 2])
        return self.scene.run(piece.leg, piece.run.state[:, local], end - start, start)


@dataclass(frozen=True, eq=False)
class Peaks:
    """What happened in an impact.

    Attributes:
        first_peak: first local maximum of the force; None if there was none.
        first_contact: largest force until separation.
        peak: largest force of all, up to the horizon.
        separation: end of the first contact [s], None if it is beyond what was simulated.
    """

    first_peak: Event | None
    first_contact: Event
    peak: Event
    separation: float | None


def course_of(scene: Scene, until: float | None) -> Course:
    """Simulate an impact from first touch.

    Args:
        scene: robot and body, about to touch.
        until: how long [s]; None: until the first contact has ended.

    Raises:
        SimulationFailed: the integrator gave up.
    """
    pieces: list[Piece] = []
    stages = [*scene.stages, None]
    motion = scene.still
    for stage, following in pairwise(stages):
        assert stage is not None
        end = until or LONGEST
        end = end if following is None else min(end, following.begin)
        if end <= stage.begin:
            continue
        leg = stage.enter(motion)
        body = scene.body_of(pieces[-1].leg, pieces[-1].run.state[:, -1]) if pieces else None
        state = scene.state_of(leg, scene.at_rest(leg) if body is None else body)
        for start, stop in pairwise(_starts(stage.begin, end, LATER_SPAN if until else SPAN)):
            run = scene.run(leg, state, stop - start, start)
            pieces.append(Piece(leg, stage.begin, run))
            state = run.state[:, -1]
            if until is None and downward(run.depth).size:
                return _joined(scene, pieces)
        own = scene.own_motion(leg, state[:, None])
        motion = leg.motion(own, np.array([end - stage.begin]))
        motion = type(motion)(motion.position.reshape(-1), motion.velocity.reshape(-1))
    return _joined(scene, pieces)


def _starts(begin: float, end: float, later: float) -> Array:
    """Return when runs start and the last one ends."""
    marks = [begin, *([EARLY] if begin < EARLY < end else []), end]
    spans = [SPAN if a < EARLY else later for a in marks[:-1]]
    parts = [
        np.linspace(a, b, math.ceil((b - a) / span), endpoint=False)
        for (a, b), span in zip(pairwise(marks), spans, strict=True)
    ]
    return np.append(np.concatenate(parts), end)


def _joined(scene: Scene, pieces: list[Piece]) -> Course:
    runs = [piece.run for piece in pieces]

    def joined(name: str) -> Array:
        first, *later = (getattr(run, name) for run in runs)
        return np.concatenate([first, *(values[1:] for values in later)])

    names = ("time", "depth", "closing", "force", "reading")
    run = Run(state=np.zeros((0, 0)), **{name: joined(name) for name in names})
    return Course(scene, tuple(pieces), run)


def peaks_of(course: Course, horizon: float | None) -> Peaks:
    """Return what happened; the largest force of all is that up to a horizon [s], or the end."""
    run = course.run
    ends = downward(run.depth)
    last = int(ends[0]) if ends.size else len(run.time) - 1
    end = float(run.time[-1]) if horizon is None else min(horizon, float(run.time[-1]))
    until = int(np.searchsorted(run.time, end, "right"))
    found = course.peaks()
    first = [i for i in found if i <= last]
    return Peaks(
        first_peak=course.peak_near(first[0]) if first else None,
        first_contact=_largest(course, first, float(run.time[last])),
        peak=_largest(course, [i for i in found if i < until - 1], end),
        separation=course.end_near(last) if ends.size else None,
    )


def _largest(course: Course, peaks: list[int], until: float) -> Event:
    """Return the largest force up to a time: at a peak, or where it was cut short in a rise."""
    run = course.run
    cut = Event(until, float(np.interp(until, run.time, run.force)))
    if not peaks:
        return cut
    heights = [vertex(run, i, course.scene.contact).force for i in peaks]
    top = course.peak_near(peaks[int(np.argmax(heights))])
    return max(top, cut, key=lambda event: event.force)


def downward(values: Array) -> NDArray[np.intp]:
    """Indices of the nodes after which values go from above zero to zero or below."""
    return np.flatnonzero((values[:-1] > 0) & (values[1:] <= 0))


def _first(found: NDArray[np.intp]) -> int:
    """First index found; the last interval if rounding has moved the event just past its end."""
    return int(found[0]) if found.size else NODES - 1


def vertex(run: Run, index: int, contact: Contact) -> Event:
    """Peak after a node: where δ̇, taken as linear between nodes, is zero."""
    before, after = run.closing[index], run.closing[index + 1]
    step = before / (before - after) * (run.time[index + 1] - run.time[index])
    depth = run.depth[index] + before * step / 2
    return Event(float(run.time[index] + step), float(contact.force(ca.DM(depth))))
