# SPDX-License-Identifier: BSD-3-Clause
"""The exchange of scenarios: searches over the few that matter, until no other is worse."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from softimpact.symbolic.robot.rigid import Array

from ..posture.tip_pose import tip_poses
from ..running.workers import as_completed
from ..search.failure import SolverFailure
from ..search.ipopt import Begin, Found, Instance, Nlp
from ..search.minimax import GIVEN_UP, ROUGH, WHOLE, Effort, serves
from ..search.nlp import NlpShape, task_numbers
from ..search.solve import Outcome, search
from ..solver_options import FEASIBLE
from .certificate import Hardening, Setting, Worst
from .samples import elsewhere, promising
from .screening import Screened

ROUNDS = 40
"""Most exchanges."""

ADDED_IN_AN_EXCHANGE = 4
"""Scenarios added in an exchange: the worst, each of another pose, point or direction."""

HELD_AT_FIRST = 24
"""Poses whose bounds the first NLP holds where postures are held, the most bent: they cost next to
nothing there."""

SAMPLED, AT_ONCE = 6, 2
"""Searches that begin with what looks best, at most, and how many of them at once, so that the
answer does not hang on the number of cores. They end with one that finds what is known."""

ALIKE = 1e-3
"""Share of the cost within which optima over the first scenarios count as one."""


@dataclass(frozen=True, eq=False)
class ExchangeState:
    """Where an exchange stands."""

    best: Found
    instance: Instance
    at: Hardening
    worst: Worst
    active: tuple[int, ...]
    rounds: int
    unit: float

    @property
    def bound(self) -> float:
        """Share of the limit that the NLP says is the least."""
        return self.best.worst * self.unit


@dataclass(frozen=True, eq=False)
class _Optimum:
    """What a search found, over which scenarios, and the postures of all poses.

    Attributes:
        found: where it ended.
        instance: the NLP with these scenarios.
        postures: P×n [rad].
        rough: whether it can still be made better.
    """

    found: Found
    instance: Instance
    postures: Array
    rough: bool = False


def exchange(
    setting: Setting,
    first: Sequence[int],
    starts: Sequence[tuple[Array, Array | None]],
    postures: Array,
    unit: float,
    *,
    free: bool,
    thorough: bool = False,
) -> ExchangeState:
    """Add the worst scenarios to an NLP until it holds all that decide.

    Searches from several starts end in several optima. More scenarios only raise their costs, so
    the one of least cost goes on, and is the answer when no scenario is worse than it says.

    Args:
        setting: the problem.
        first: scenarios to begin with.
        starts: springs and other values from which the first NLP is solved.
        postures: of each pose, P×n [rad].
        unit: share of a limit that counts as one.
        free: whether the postures are sought as well.
        thorough: whether searches begin with hardware at random, too, where they are quick.
    """
    study, given, limits = setting.study, setting.given, setting.limits
    if study.objective.scales_speed:
        unit = 1.0  # the limits themselves
    everything, thorough = (
        study.objective.all_scenarios,
        thorough and serves(study.objective, free=free),
    )
    active = list(range(len(setting.scenarios))) if everything else list(first)
    bends = setting.shares_of_bounds(Hardening(limits.vector(study.nominal), given))
    most_bent = np.argsort(-bends)[: HELD_AT_FIRST if thorough else 1].tolist()
    poses = _poses(setting, most_bent, active)
    instance = _instance(setting, active, poses, unit)
    if thorough:
        known = [limits.vector(*each) for each in starts]
        starts = promising(_nlp(setting, instance), given[poses], known, SAMPLED)
        begun = [Begin(postures, *each) for each in starts]
        found = _until_known(setting, instance, poses, begun)
    else:
        begun = [Begin(postures, *each) for each in starts]
        found = _apart(_searched(setting, instance, poses, begun, free))
    hopped, effort = False, ROUGH if thorough else WHOLE
    for rounds in range(1, ROUNDS + 1):
        settled = _settled(setting, found, active, instance, poses, unit, free, effort)
        best, found, instance, poses = settled
        factors = _factors(setting, best.found)
        at = Hardening(limits.vector(best.found.springs, best.found.others), best.postures, factors)
        worst, screened = setting.worst(at)
        setting.say("exchange", rounds, ROUNDS)
        state = ExchangeState(best.found, instance, at, worst, tuple(active), rounds, unit)
        allowed = max(state.bound, 1.0) if factors is not None else state.bound
        worse = [s for s in screened if s.share > allowed * (1 + FEASIBLE)]
        fresh = [] if everything else worst_few(setting, worse, set(active))
        if fresh:
            active = [*active, *fresh]
            poses = _poses(setting, poses, active)
            instance = _instance(setting, active, poses, unit)
            continue
        if thorough and not hopped:  # once: a second look never gained more than 0.01 %
            found, hopped = [*found, *_hops(setting, instance, poses, best)], True
        least = min(found, key=lambda each: each.found.cost)
        if least.rough:
            more = _searched(setting, instance, poses, [_again(least)], free)
            found = [*more, *(each for each in found if each is not least)]
        elif least.found.cost >= best.found.cost * (1 - FEASIBLE):
            break
    return state


def _settled(
    setting: Setting,
    found: Sequence[_Optimum],
    active: list[int],
    instance: Instance,
    poses: list[int],
    unit: float,
    free: bool,
    effort: Effort,
) -> tuple[_Optimum, list[_Optimum], Instance, list[int]]:
    """Return the best, and all, over the scenarios that are active, bounds kept in every pose.

    Bounds are soon evaluated: poses that break them are added before anything is screened.
    """
    while True:
        best = min(found, key=lambda each: each.found.cost)
        if best.instance is instance:
            at = Hardening(
                setting.limits.vector(best.found.springs, best.found.others), best.postures
            )
            shares = setting.shares_of_bounds(at)
            far = [int(k) for k in np.argsort(-shares) if shares[k] > 1 + FEASIBLE]
            fresh = [k for k in far if k not in poses][:ADDED_IN_AN_EXCHANGE]
            if not fresh:
                return best, list(found), instance, poses
            poses = [*poses, *fresh]
            instance = _instance(setting, active, poses, unit)
        again = _searched(setting, instance, poses, [_again(best)], free, effort)
        found = [*again, *(each for each in found if each is not best)]


def _again(best: _Optimum) -> Begin:
    """Return where another search goes on: with postures of all poses."""
    return replace(best.found.end, postures=best.postures)


def _nlp(setting: Setting, instance: Instance) -> Nlp:
    return Nlp(setting.program, instance, setting.limits)


def _until_known(
    setting: Setting, instance: Instance, poses: list[int], starts: Sequence[Begin]
) -> list[_Optimum]:
    """Return optima, found roughly, until a search ends in one that is known; postures are held."""
    found: list[_Optimum] = []
    missed: list[Found] = []
    for begin in range(0, len(starts), AT_ONCE):
        some = starts[begin : begin + AT_ONCE]
        more, without = _feasible(setting, instance, poses, some, False, ROUGH)
        known, found = len(found) + len(more), _apart([*found, *more])
        missed += without
        if len(found) < known:
            break
    if not found:
        raise _failure(setting, instance, missed)
    return found


def _hops(setting: Setting, instance: Instance, poses: list[int], best: _Optimum) -> list[_Optimum]:
    """Return better optima from what differs from the best in one value alone, one by one.

    Postures are held. Values near the tip, which impacts feel least, come last.
    """
    better: list[_Optimum] = []
    nlp, V = _nlp(setting, instance), setting.limits.lower.size
    for begin in range(0, V, AT_ONCE):
        v = setting.limits.vector(best.found.springs, best.found.others)
        values = range(begin, min(begin + AT_ONCE, V))
        hardware = elsewhere(nlp, setting.given[poses], v, best.found.shares, values)
        starts = [Begin(setting.given, *each) for each in hardware]
        effort = replace(ROUGH, reach=best.found.cost * (1 - FEASIBLE))
        found = _feasible(setting, instance, poses, starts, False, effort)[0]
        better += [each for each in found if each.found.status != GIVEN_UP]
        best = min([best, *better], key=lambda each: each.found.cost)
    return better


def _apart(optima: Sequence[_Optimum]) -> list[_Optimum]:
    """Return the best of those whose costs are alike."""
    kept: list[_Optimum] = []
    for each in sorted(optima, key=lambda each: each.found.cost):
        if not kept or each.found.cost - kept[-1].found.cost > ALIKE * abs(each.found.cost):
            kept.append(each)
    return kept


def _poses(setting: Setting, poses: list[int], active: list[int]) -> list[int]:
    """Return the poses whose bounds the NLP holds: some, and those of its scenarios."""
    return list(dict.fromkeys([*poses, *(setting.scenarios[i].pose for i in active)]))


def _factors(setting: Setting, best: Found) -> Array | None:
    """Return the factors on the speed that a search ended with."""
    if not setting.study.objective.scales_speed:
        return None
    return np.asarray(10**best.own)


def worst_few(setting: Setting, screened: Sequence[Screened], known: set[int]) -> list[int]:
    """Return the worst few that are not known, each of another pose, point or direction."""
    kinds: set[tuple[int, ...]] = set()
    fresh: list[int] = []
    for each in screened:
        kind = setting.scenarios[each.index][:3]
        if each.index not in known and kind not in kinds and len(fresh) < ADDED_IN_AN_EXCHANGE:
            kinds.add(kind)
            fresh.append(each.index)
    return fresh


def _instance(setting: Setting, active: list[int], poses: list[int], unit: float) -> Instance:
    study, scenarios = setting.study, setting.scenarios
    places = [scenarios[i] for i in active]
    at = tip_poses(study.model, np.array([scenarios.poses[k].q for k in poses]))
    tasks = [task_numbers(study, *each) for each in zip(*at, strict=True)]
    shape = NlpShape.of(
        len(poses),
        [(poses.index(each.pose), each.point) for each in places],
        [i // len(scenarios.motors) for i in active],
        study.objective,
    )
    return Instance(
        shape,
        np.array(tasks),
        np.array([scenarios.numbers(each, setting.timing.step) for each in places]),
        unit * np.array([scenarios.limit(each) for each in places]),
    )


def _searched(
    setting: Setting,
    instance: Instance,
    poses: list[int],
    starts: Sequence[Begin],
    free: bool,
    effort: Effort = WHOLE,
) -> list[_Optimum]:
    """Return what searches from some starts found that keeps the bounds.

    Raises:
        SolverFailure: nothing.
    """
    optima, missed = _feasible(setting, instance, poses, starts, free, effort)
    if not optima:
        raise _failure(setting, instance, missed)
    return optima


def _failure(setting: Setting, instance: Instance, missed: Sequence[Found]) -> SolverFailure:
    nearest = min(missed, key=lambda each: each.violation)
    return SolverFailure([_as_outcome(nearest, instance, setting)], setting.study)


def _feasible(
    setting: Setting,
    instance: Instance,
    poses: list[int],
    starts: Sequence[Begin],
    free: bool,
    effort: Effort = WHOLE,
) -> tuple[list[_Optimum], list[Found]]:
    """Return what searches found that keeps the bounds, and what does not."""
    nlp = _nlp(setting, instance)
    begun = [replace(start, postures=start.postures[poses]) for start in starts]
    jobs = [setting.pool.submit(search, nlp, begin, free, effort) for begin in begun]
    optima, missed = [], []
    for job in as_completed(jobs):
        found = job.result()
        if found.violation > FEASIBLE:
            missed.append(found)
            continue
        postures = setting.given.copy()
        if free:
            postures[poses] = found.postures
        optima.append(_Optimum(found, instance, postures, rough=effort is not WHOLE))
    return optima, missed


def _as_outcome(found: Found, instance: Instance, setting: Setting) -> Outcome:
    name = setting.scenarios.poses[0].pose.name
    status, force = found.status, float((found.shares * instance.units).max())
    q, k = found.postures[0], found.springs
    return Outcome(
        name, "table", status, False, found.iterations, 1, 0.0, q, k, force, found.violation
    )
