# SPDX-License-Identifier: BSD-3-Clause
"""What a design study found, checked by simulation and put in figures a designer asks for."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass, field
from importlib.metadata import version
from typing import Any, Literal

import casadi as ca
import mujoco
import numpy as np

from softimpact.optimize import Design, Gains, Outcome, PoseResult, Study
from softimpact.optimize.answers import by_name
from softimpact.optimize.evaluation import kept
from softimpact.optimize.running.workers import as_completed
from softimpact.optimize.search.solve import preference
from softimpact.simulate import ImpactHistory
from softimpact.simulate.band import Band
from softimpact.simulate.bracket import unknown_rotors
from softimpact.symbolic import Analysis, analyse
from softimpact.symbolic.robot.rigid import Array

from ..output.cautions import design_warnings
from .checks import Check, doubts, peak_band, peaks_by_reaction, safe_speed, simulated

Limited = Literal["transient", "quasi_static"]


@dataclass(frozen=True, eq=False)
class RankedPose:
    """A pose with what was found for it.

    Attributes:
        rank: 1 for the least force.
        result: of the design.
        figures: m_c, k_r, m_a, impact factors at the posture that serves the task, nominal k_s.
    """

    rank: int
    result: PoseResult
    figures: Analysis

    @property
    def best(self) -> Outcome:
        """The better of the outcomes in both modes."""
        return best_outcome(self.result)


@dataclass(frozen=True, eq=False)
class DesignReport:
    """Results of a study.

    Attributes:
        design: what the optimiser found.
        poses: by rank.
        worst: the pose of the largest force with the nominal stiffness.
        check: of the winner.
        winner_history: force over time of the winner, linearised.
        worst_history: the same of the worst pose with the nominal stiffness.
        speed_before: at which the task's pose with the reference's springs meets the limit [m/s].
        speed_after: at which the winner meets it [m/s].
        reactions_before: largest force [N] of the task's pose with the reference's springs, by the
            time [s] for which motors drive on; empty without rotor inertias.
        reactions_after: the same of the winner.
        band: where the winner's largest force lies in 95 of 100 cases [N]; None if not computed.
    """

    design: Design
    poses: tuple[RankedPose, ...]
    worst: PoseResult
    check: Check
    winner_history: ImpactHistory
    worst_history: ImpactHistory
    speed_before: float
    speed_after: float
    reactions_before: Mapping[float, float] = field(default_factory=dict)
    reactions_after: Mapping[float, float] = field(default_factory=dict)
    band: Band | None = None

    @property
    def study(self) -> Study:
        """The problem."""
        return self.design.study

    @property
    def limit(self) -> float:
        """Force that reaches a limit of the body region, of force or energy [N]."""
        return self.study.limit


def best_outcome(result: PoseResult) -> Outcome:
    """Return the better of a pose's outcomes; solved ones come first, then feasible ones."""
    found = [outcome for outcome in (result.table, result.free) if outcome is not None]
    return min(found, key=preference)


def design_report(design: Design, executor: Executor | None = None) -> DesignReport:
    """Rank the poses, simulate the winner and find the speeds that meet the limit.

    Args:
        design: what was found.
        executor: where speeds are sought, while the rest is done here; default here, too.
    """
    study, winner = design.study, design.winner
    task, before = task_result(design), design.answers.reference.springs
    sought = (study, task.candidate.q, before), (study, winner.q, winner.springs)
    jobs = [executor.submit(safe_speed, *each) for each in sought] if executor else []
    ordered = sorted(design.poses, key=lambda pose: preference(best_outcome(pose)))
    poses = tuple(
        RankedPose(i + 1, pose, analyse(study.model, pose.candidate.q, study.direction))
        for i, pose in enumerate(ordered)
    )
    worst = max(design.poses, key=lambda pose: pose.force_before)
    history = simulated(study, winner.q, winner.springs)
    full = simulated(study, winner.q, winner.springs, "full")
    reactions = [_reactions(*each) for each in sought]
    band = peak_band(study, winner.q, winner.springs)
    worst_history = simulated(study, worst.candidate.q, study.nominal)
    for _ in as_completed(jobs):
        continue
    speeds = [job.result() for job in jobs] or [safe_speed(*each) for each in sought]
    return DesignReport(
        design=design,
        poses=poses,
        worst=worst,
        check=Check(winner.force, history.peak, full.peak),
        winner_history=history,
        worst_history=worst_history,
        speed_before=speeds[0],
        speed_after=speeds[1],
        reactions_before=reactions[0],
        reactions_after=reactions[1],
        band=band,
    )


def task_result(design: Design) -> PoseResult:
    """Return what was found for the task's pose."""
    name = design.study.task_pose.name
    return next(pose for pose in design.poses if pose.candidate.pose.name == name)


def nominal_in_words(design: Design) -> str | None:
    """Return what is compared with instead of nominal springs that break a bound, if they do."""
    task, reference, study = task_result(design), design.answers.reference, design.study
    if task.keeps_before:
        return None
    broken = [b.name for b in kept(study, task.candidate.q, study.nominal) if b.broken]
    return (
        f"nominal springs break {' and '.join(broken)} in {study.task_pose.name} "
        f"({task.force_before:.1f} N, {1e3 * task.deflection_before:.3g} mm); before means springs "
        f"in their proportions that are just stiff enough: {reference.force:.1f} N"
    )


def _reactions(study: Study, q: Array, springs: Array) -> dict[float, float]:
    return {} if unknown_rotors(study.model) else peaks_by_reaction(study, q, springs)


def design_record(report: DesignReport) -> dict[str, Any]:
    """Return a report as plain data, for ``results.json``."""
    study, design = report.study, report.design
    region = study.contact.region
    check = report.check
    return {
        "generator": GENERATOR,
        "versions": versions(),
        "study": inputs(study),
        "region": region.name,
        "limit": report.limit,
        "limit_kind": limit_kind(study),
        "solver": {
            "compiled": design.compiled,
            "impact_duration": design.timing.duration,
            "impact_steps": design.timing.steps,
        },
        "winner": {
            **vars(design.winner),
            "deflection": design.answers.deflection,
            "meets_limit": design.winner.force <= report.limit,
        },
        "worst_force": design.winner.force,
        "worst_scenario": {
            "pose": design.winner.name,
            "direction": study.direction,
            "point": study.model.tip,
            "region": region.name,
            "speed": study.speed,
            "motors": design.answers.worst_motors.kind,
        },
        "indifferent": by_name(study, design.answers.indifferent),
        "prices": design.answers.prices,
        "conflicts": [],
        "self_motion_branches": design.branches,
        "optima": [
            {"force": o.best.force, "q": o.best.q, "springs": o.best.springs, "starts": o.starts}
            for o in design.optima
        ],
        "reference": design.answers.reference,
        "check": vars(check),
        "gains": None if design.gains is None else vars(design.gains),
        "safe_speed": {"before": report.speed_before, "after": report.speed_after},
        "band": report.band,
        "reactions": {"before": report.reactions_before, "after": report.reactions_after},
        "peak_definition": "peak",
        "warnings": [*design_warnings(study), *doubts(check.nlp, check.linearised, check.full)],
        "poses": [_pose(pose) for pose in report.poses],
    }


GENERATOR = "softimpact design"
"""Marks a folder of results as one that may be replaced."""


def versions() -> dict[str, str]:
    """Return the versions that the numbers depend on."""
    return {
        "softimpact": version("softimpact"),
        "casadi": ca.CasadiMeta.version(),
        "mujoco": mujoco.__version__,
        "numpy": np.__version__,
    }


def limit_kind(study: Study) -> Limited:
    """Return which of ISO/TS 15066's limits counts."""
    return "quasi_static" if study.contact.region.transient_limit is None else "transient"


def inputs(study: Study) -> dict[str, Any]:
    """Return what a study asks, as plain data."""
    return {
        "title": study.title,
        "source": study.source,
        "robot": study.robot.name,
        "robot_digest": study.robot.digest(),
        "joints": study.robot.joint_names,
        "joints_with_springs": study.spring_names,
        "tip": study.model.tip,
        "rotor_inertia": np.array(study.model.drives.rotors).ravel(),
        "direction": study.direction,
        "speed": study.speed,
        "clamped": study.contact.clamped,
        "stiffness_lower": study.lower,
        "stiffness_upper": study.upper,
        "stiffness_nominal": study.nominal,
        "forces": study.forces,
        "max_deflection": study.max_deflection,
        "motors": study.motors,
        "horizon": study.horizon,
        "task_pose": study.task_pose.name,
        "exact": study.exact,
    }


def peak_in_words(study: Study) -> str:
    """Return which peak counts, and under what motors."""
    until = "no reaction"
    kinds = " or ".join(motors.kind for motors in study.motors)
    reaction = study.motors[0].reaction_time
    if reaction < np.inf:
        until = f"reaction after {1e3 * reaction:g} ms"
    worse = ", the worse counts" if len(study.motors) > 1 else ""
    return f"largest force within {study.horizon:g} s; motors {kinds}{worse}; {until}"


def _pose(pose: RankedPose) -> dict[str, Any]:
    result, candidate = pose.result, pose.result.candidate
    figures = pose.figures
    return {
        "rank": pose.rank,
        "name": candidate.pose.name,
        "recovered": candidate.pose.recovered,
        "turned": candidate.turned,
        "moved": candidate.moved,
        "q_given": candidate.pose.q,
        "q": candidate.q,
        "tip_offset": candidate.offset,
        "m_c": figures.m_c,
        "k_r": figures.k_r,
        "m_a": figures.m_a,
        "chain": figures.chain,
        "osim": figures.osim,
        "giaf": figures.giaf,
        "directional_giaf": figures.directional_giaf,
        "force_before": result.force_before,
        "deflection_before": result.deflection_before,
        "keeps_bounds_before": result.keeps_before,
        "force_compared": result.compared,
        "table": result.table,
        "free": result.free,
    }


def has_other_postures(report: DesignReport) -> bool:
    """Whether posture was part of the design: other poses, or one that was sought."""
    return len(report.poses) > 1 or any(pose.result.free for pose in report.poses)


def gains_in_words(gains: Gains, report: DesignReport) -> Sequence[str]:
    """Return what springs, posture and speed buy, a sentence each."""

    def share(force: float) -> str:
        saved = 100 * (gains.before - force) / gains.before
        return f"{abs(saved):.1f} % {'less' if saved > -0.05 else 'more'}"

    limit = report.limit
    posture = (
        f"Posture alone, with the stiffness as before: {gains.before:.1f} → {gains.posture:.1f} N "
        f"({share(gains.posture)}).",
    )
    both = "Both" if has_other_postures(report) else "All, as there is no other posture"
    verdict = "meets" if gains.both <= limit else f"is {gains.both / limit:.1f} times"
    return (
        f"Springs alone, in the task's pose: {gains.before:.1f} → {gains.springs:.1f} N "
        f"({share(gains.springs)}).",
        *(posture if len(report.poses) > 1 else ()),
        f"{both}: {gains.before:.1f} → {gains.both:.1f} N ({share(gains.both)}), which "
        f"{verdict} the limit of {limit:g} N.",
        f"Speed: the limit is met at {report.speed_after:.3f} m/s "
        f"({report.speed_before:.3f} m/s before the design).",
    )


def reactions_in_words(report: DesignReport) -> Iterator[str]:
    """Yield what the time buys until motors are released, a line each."""
    if not report.reactions_before:
        return
    yield "Largest force before and after the design, by what the motors do:"
    for time, before in report.reactions_before.items():
        words = f"drive on for {1e3 * time:g} ms" if time else "free from first touch on"
        after = report.reactions_after[time]
        yield f"  {words:<26}{before:7.1f} → {after:7.1f} N"


def band_in_words(report: DesignReport) -> Iterator[str]:
    """Yield how sure the winner's force is, and whether the design's gain is more than that."""
    band, gains = report.band, report.design.gains
    if band is None:
        return
    ends = f"{band.low:.0f} to {band.high:.0f} N"
    words = f"For what is not known exactly, 95 of 100 cases lie within {ends}"
    if gains is None:
        yield f"{words}."
        return
    gain, width = gains.before - gains.both, band.high - band.low
    less = "less" if gain < width else "more"
    yield f"{words}: the design's gain of {gain:.1f} N is {less} than that band is wide."
