# SPDX-License-Identifier: BSD-3-Clause
"""The record of one impact, for JSON, and its table for people."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np

from softimpact.simulate import Assessment
from softimpact.simulate.tolerances import Tolerances
from softimpact.symbolic.body.regions import NEWTON_PER_CM2
from softimpact.symbolic.body.shapes import shape_from

from ..output.cautions import not_permitted
from ..output.printed import print_table, tables_are_csv
from .impact import Answer, controller_of


def record_of(answer: Answer) -> dict[str, Any]:
    """Return everything that an answer depends on, and the answer."""
    scene, contact, how, found = answer.scene, answer.contact, answer.how, answer.found
    history, limits, model = found.history, found.limits, scene.model
    peaks = {kind: end.peak for kind, end in found.ends.items()}
    known = [*found.ends] in (["free"], ["servo"], ["held"], ["controller"])
    pressing = limits.quasi_static
    return {
        "robot": model.robot.name,
        "joints": model.robot.joint_names,
        "tip": model.tip,
        "q": scene.q,
        "direction": scene.direction,
        "model": how.fidelity,
        "joint_stiffness": _springs(model.drives.springs, model.drives.elastic),
        "rotor_inertia": model.drives.rotors,
        "position_gain": model.drives.gains,
        "computed_torque_gain": model.drives.computed_torque_gain,
        "damping_gain": model.drives.damping_gains,
        "torque_limit": model.drives.torque_limits,
        "gravity": model.gravity,
        "payload": scene.payload,
        "motors": found.worst,
        "reaction": history.motors,
        "controller": controller_of(how),
        "horizon": answer.horizon,
        "region": contact.region.name,
        "body": contact.region,
        "cover": contact.cover,
        "clamped": contact.clamped,
        "speed": answer.speed,
        "joint_velocity": found.joint_velocity,
        "bracket": None if known else {k: peaks.get(k) for k in ("free", "driven")},
        "peak": history.peak,
        "time_of_peak": history.time_of_peak,
        "peak_force": history.force_of(answer.definition),
        "peak_definition": answer.definition,
        "first_contact": history.first_contact,
        "time_of_first_contact_peak": history.time_of_first_contact_peak,
        "first_peak": history.first_peak,
        "time_of_first_peak": history.time_of_first_peak,
        "separation": history.separation,
        "pressing": history.pressing,
        "reading": _reading(answer),
        "energy": found.energy,
        "shape": how.body.shape,
        "pressure": _pressure(answer),
        "limits": {
            "transient": contact.region.force_limit,
            "quasi_static": contact.region.quasi_static_limit if contact.clamped else None,
            "energy": contact.region.energy_limit,
            "transient_pressure": contact.region.transient_pressure,
            "quasi_static_pressure": contact.region.quasi_static_pressure,
            "permitted": limits.permitted,
            "least_transient_force": limits.transient.force,
            "least_quasi_static_force": None if pressing is None else pressing.force,
        },
        "limit": contact.region.force_limit,
        "within_limit": found.verdict.ruling == "kept",
        "verdict": found.verdict.ruling,
        "binding": found.verdict.binding,
        "share_of_limit": found.verdict.share,
        "iso": found.two_body,
        "joint_speed_limit_exceeded": found.joint_speed_limit_exceeded,
        "torque_limit_exceeded": found.torque_limit_exceeded,
        "band": None if found.band is None else found.band.peak,
        "bands": found.band,
        "tolerances": Tolerances() if found.band else None,
        "linear_error": found.linear_error,
        "safe_speed": found.safe_speed,
        "safe_speeds": found.safe_speeds,
        "warnings": warnings_of(answer),
        "time": history.time,
        "force": history.force,
    }


def _springs(springs: Any, elastic: tuple[bool, ...]) -> list[float | None]:
    """Stiffness of each joint; None where it is rigid."""
    numbers = np.array(springs, dtype=float).ravel()
    return [float(k) if gives else None for k, gives in zip(numbers, elastic, strict=True)]


def _pressure(answer: Answer) -> float | None:
    """Return a bound on the pressure at the peak [Pa]; None where no shape was given."""
    shape = answer.how.body.shape
    return None if shape is None else shape_from(shape).pressure(answer.found.history.peak)


def _reading(answer: Answer) -> float | None:
    """Return what a device with a plate shows at most [N]; without one it is the force."""
    history = answer.found.history
    if not answer.contact.region.plate_mass:
        return None
    return float(history.reading[history.time <= answer.horizon].max())


def _per_cm2(pressure: float | None) -> float | None:
    return None if pressure is None else pressure / NEWTON_PER_CM2


def warnings_of(answer: Answer) -> list[str]:
    """Return what was ignored or assumed, and what to know before using the numbers."""
    found = answer.found
    reach, peak = answer.contact.law.reach, found.history.peak
    beyond = [
        f"the force exceeds what is known of cover and skin ({reach:g} N); beyond it they are "
        "taken as solid"
    ]
    return [
        *answer.scene.warnings,
        *found.warnings,
        *not_permitted([answer.contact.region]),
        *_cautions(found),
        *(beyond if peak > reach else []),
    ]


def _cautions(found: Assessment) -> Iterator[str]:
    """Yield what a reader must know before using the numbers."""
    for names, words in (
        (found.joint_speed_limit_exceeded, "faster than their speed limits"),
        (found.torque_limit_exceeded, "asked for more torque than they have (the model gives it)"),
    ):
        if names:
            yield f"joints {', '.join(names)} are {words}"


_WITHOUT = {
    "separation after": "not while it is looked at",
    "largest safe speed (--safe-speed)": "not asked for",
}
"""What stands in the place of a number that there is not."""


def print_impact(result: Mapping[str, Any]) -> None:
    """Print a record as a table."""
    separation, bracket = result["separation"], result["bracket"]
    held = "held" if result["clamped"] else "free to give way"
    first, limits = result["time_of_first_peak"], result["limits"]
    rows: list[tuple[str, float | str | None, str]] = [
        ("largest force", result["peak"], "N"),
        ("  after", 1e3 * result["time_of_peak"], "ms"),
        ("  if motors are free from first touch on", (bracket or {}).get("free"), "N"),
        ("  if they keep their speed until the reaction", (bracket or {}).get("driven"), "N"),
        ("largest force until separation", result["first_contact"], "N"),
        ("first local maximum", result["first_peak"], "N"),
        ("  after", None if first is None else 1e3 * first, "ms"),
        ("separation after", None if separation is None else 1e3 * separation, "ms"),
        ("pressing after 0.5 s", result["pressing"], "N"),
        ("largest reading of the device", result["reading"], "N"),
        ("energy in the body's spring", result["energy"], "J"),
        ("pressure, at most", _per_cm2(result["pressure"]), "N/cm²"),
        ("limit, transient force", limits["transient"], "N"),
        ("limit, quasi-static force", limits["quasi_static"], "N"),
        ("limit, transient energy", limits["energy"], "J"),
        (f"verdict, by {result['binding']}", result["verdict"], ""),
        ("two-body formula of the standard", result["iso"]["force"], "N"),
        ("  its speed for the transient limit", result["iso"]["safe_speed"], "m/s"),
        ("largest safe speed (--safe-speed)", result["safe_speed"], "m/s"),
    ]
    if result["band"] is not None:
        low, high = (f"{getattr(result['band'], end):.4g}" for end in ("low", "high"))
        rows.insert(2, ("  95 of 100 cases lie within", f"{low} to {high}", "N"))
    absent = {
        "pressure, at most": result["pressure"],
        "limit, transient energy": limits["energy"],
        "largest reading of the device": result["reading"],
    }
    rows = [row for row in rows if absent.get(row[0], 0.0) is not None]
    if bracket is None or None in (bracket.get("free"), bracket.get("driven")):
        rows = [row for row in rows if "if " not in row[0][:5]]
    if not tables_are_csv():
        rows = [(name, _WITHOUT.get(name, "none") if x is None else x, u) for name, x, u in rows]
    print_table(
        f"{result['robot']} on {result['region']} ({held}) at {result['speed']:g} m/s, "
        f"model {result['model']}, motors {result['motors']}",
        ("quantity", "value", "unit"),
        rows,
    )
