# SPDX-License-Identifier: BSD-3-Clause
"""The report of one impact."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from softimpact.simulate import Approach, simulate_impact

from ..design.report import versions
from ..figures.style import BLUE, FAINT, LIMIT, ORANGE, TEXT, legend_below, new_figure, tidy
from ..impact.impact import Answer
from ..output.printed import shown
from .arms import ORIGIN, arm_picture
from .page import ArmPicture, Hit, Page, Section, TableOfNumbers, write_page
from .provenance import command

KIND_WORDS = {
    "free": "motors free from first touch on",
    "servo": "motors follow their servo",
    "driven": "motors keep their speed until the reaction",
    "held": "motors held (papers only)",
    "controller": "motors follow MSM's controller",
}
KIND_COLOURS = {"free": ORANGE, "servo": BLUE, "driven": BLUE, "held": BLUE, "controller": BLUE}

NOTHING = 1e-9
"""Joint speeds that rounding leaves of none [rad/s, m/s]."""

QUIET = 1.15
"""How much of the time after the last force a figure shows."""


def write_impact_report(answer: Answer, record: Mapping[str, Any], path: Path) -> Path:
    """Write the report of an impact."""
    found = answer.found
    page = Page(
        question=_question(answer),
        answer=_answer(answer),
        is_good=found.verdict.ruling == "kept",
        sections=[
            Section(
                "Force over time",
                figure=figure_of_impact(answer),
                caption="Contact force over time for what the motors may do, and the limits.",
                tables=[_forces(record), _limits(record)],
            ),
            Section("Where it is hit", arms=[_arm(answer)]),
            _trust(answer, record),
            Section("What it rests on", tables=[_joints(record), _numbers(record)]),
            Section(
                "What to know",
                words=[] if record["warnings"] else ["Nothing was ignored or assumed."],
                lines=record["warnings"],
            ),
        ],
        command=command(),
        versions=versions(),
        digests={"robot": answer.scene.model.robot.digest()},
    )
    return write_page(page, path)


def figure_of_impact(answer: Answer) -> Figure:
    """Draw the force over time at each end of what the motors may do, and the limits."""
    figure = new_figure(8.0, 4.4)
    axes = figure.add_subplot()
    found = answer.found
    last = 0.0
    handles: list[Any] = []
    for kind, history in found.ends.items():
        times = 1e3 * history.time
        look: dict[str, Any] = {"color": KIND_COLOURS[kind], "label": KIND_WORDS[kind]}
        handles += axes.plot(times, history.force, linewidth=2, **look)
        pressed = np.flatnonzero(history.force > 0.01 * history.peak)
        last = max(last, float(times[pressed[-1]]))
    if found.band is not None:
        axes.axhspan(found.band.peak.low, found.band.peak.high, color=FAINT, zorder=0)
    limit = answer.contact.region.force_limit
    if np.isfinite(limit):
        words = f"transient limit {limit:g} N"
        line = axes.axhline(limit, color=LIMIT, linestyle="--", linewidth=1.5, label=words)
        handles.append(line)
    legend_below(figure, handles, columns=len(handles))
    axes.set_xlim(0, QUIET * last)
    axes.set_ylim(bottom=0)
    axes.set_xlabel("time since first touch [ms]", fontsize=TEXT)
    axes.set_ylabel("contact force [N]", fontsize=TEXT)
    worst = f"{found.history.peak:.0f} N at most, {KIND_WORDS[found.worst]}"
    axes.set_title(worst, fontsize=TEXT + 1, loc="left")
    tidy(axes)
    return figure


def _question(answer: Answer) -> str:
    region = answer.contact.region
    held = "held" if answer.contact.clamped else "free to give way"
    name = answer.scene.model.robot.name
    return f"May {name} hit the {region.title.lower()} ({held}) at {answer.speed:g} m/s?"


def _answer(answer: Answer) -> str:
    found = answer.found
    verdict, peak = found.verdict, found.history.peak
    share = f"{100 * verdict.share:.0f} % of the limit for {verdict.binding} is used"
    words = {
        "kept": f"Yes: at most {peak:.0f} N; {share}.",
        "exceeded": f"No: up to {peak:.0f} N; {share}.",
        "not permitted": f"No, whatever the force; it would be {peak:.0f} N.",
        "no limit": f"There is no limit to hold it against: at most {peak:.0f} N.",
    }[verdict.ruling]
    if found.safe_speed is None:
        return words
    reference = " (for reference)" if verdict.ruling == "not permitted" else ""
    return f"{words} Every limit{reference} is kept up to {found.safe_speed:.3g} m/s."


def _arm(answer: Answer) -> ArmPicture:
    model, scene = answer.scene.model, answer.scene
    hit = Hit(ORIGIN, scene.direction, answer.found.verdict.share)
    words = f"The arm as a stick figure, hit at {model.tip}; the arrow is the way it moves."
    return arm_picture(model.robot, scene.q, {model.tip: hit}, words)


def _forces(record: Mapping[str, Any]) -> TableOfNumbers:
    rows = [
        ("largest force over all contacts", record["peak"], "N"),
        ("after", 1e3 * record["time_of_peak"], "ms"),
        ("largest force until separation", record["first_contact"], "N"),
        ("first local maximum", record["first_peak"], "N"),
        ("pressing after 0.5 s", record["pressing"], "N"),
        ("energy in the body's spring", record["energy"], "J"),
        ("two-body formula of the standard", record["iso"]["force"], "N"),
        ("ours over the formula", record["peak"] / record["iso"]["force"], ""),
    ]
    return TableOfNumbers("Forces", ("quantity", "value", "unit"), rows)


def _limits(record: Mapping[str, Any]) -> TableOfNumbers:
    limits = record["limits"]
    rows = [
        ("transient force", limits["transient"], record["peak"], "N"),
        ("quasi-static force", limits["quasi_static"], record["pressing"], "N"),
        ("energy", limits["energy"], record["energy"], "J"),
    ]
    return TableOfNumbers("Limits", ("of", "limit", "reached", "unit"), rows)


def _trust(answer: Answer, record: Mapping[str, Any]) -> Section:
    rows = [_rung(answer, rung) for rung in ("linearised", "full")]
    words = [
        "Each rung of the ladder of models checks the one below it; full is the nonlinear robot."
    ]
    band = answer.found.band
    if band is not None:
        words.append(
            f"For what is not known exactly, 95 of 100 cases lie between {band.peak.low:.0f} and "
            f"{band.peak.high:.0f} N ({band.samples} impacts)."
        )
    return Section(
        "How far to trust it",
        words=words,
        tables=[TableOfNumbers("Largest force by model", ("model", "N"), rows)],
    )


def _rung(answer: Answer, rung: str) -> tuple[str, float]:
    """Return the largest force of the worst end by a model."""
    found, scene = answer.found, answer.scene
    if rung == answer.how.fidelity:
        return rung, found.history.peak
    velocity = found.joint_velocity / answer.speed
    history = simulate_impact(
        scene.model,
        Approach(scene.q, scene.direction, answer.speed, velocity),
        answer.contact,
        "full" if rung == "full" else "linearised",
        motors=found.history.motors,
        horizon=answer.horizon,
    )
    return rung, history.peak


def _joints(record: Mapping[str, Any]) -> TableOfNumbers:
    robot = record["joints"]
    columns = (
        record["q"],
        np.where(abs(record["joint_velocity"]) < NOTHING, 0.0, record["joint_velocity"]),
        record["joint_stiffness"],
        np.array(record["rotor_inertia"]).ravel(),
        np.array(record["position_gain"]).ravel(),
    )
    rows = [(name, *values) for name, *values in zip(robot, *columns, strict=False)]
    heads = ("joint", "angle", "speed", "k_s N·m/rad", "rotor kg m²", "K_p N·m/rad")
    return TableOfNumbers("Joints (stiffness – is rigid)", heads, rows)


def _numbers(record: Mapping[str, Any]) -> TableOfNumbers:
    body, reaction = record["body"], record["reaction"]
    rows: list[tuple[str, float | str | None, str]] = [
        ("motors", KIND_WORDS[record["motors"]], ""),
        ("reaction time", "none" if reaction is None else shown(reaction.reaction_time), "s"),
        ("horizon", record["horizon"], "s"),
        ("payload", float(record["payload"]), "kg"),
        ("stiffness of the body", body.stiffness, "N/m"),
        ("its damping", body.damping, "N s/m"),
        ("its effective mass", body.effective_mass, "kg"),
        ("model", record["model"], ""),
    ]
    return TableOfNumbers("Numbers", ("what", "value", "unit"), rows)
