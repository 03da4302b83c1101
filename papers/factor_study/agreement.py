# SPDX-License-Identifier: BSD-3-Clause
"""Where the papers meet: how well impact factors foretell which pose hurts least."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from softimpact.optimize import Study
from softimpact.simulate import Approach, simulate_impact
from softimpact.symbolic import Contact, body_region, impact_model
from softimpact.symbolic.robot.rigid import Array

from .functions import FactorFunctions

STIFFNESSES = (*(float(k) for k in np.logspace(2, 6, 13)), np.inf)
"""Joint stiffness of the sweep, all joints alike [N·m/rad]; the last is rigid."""

REGIONS = ("chest", "head")
"""A soft and a hard part of the body."""

AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
"""Directions of impact."""

PREDICTORS = ("giaf", "directional_giaf", "mass_ratio", "mass_free", "mass_rigid")
"""What is to foretell the order of forces; of the first three, less means more force."""


@dataclass(frozen=True, eq=False)
class Agreement:
    """Peak forces over joint stiffness for one region and direction, and who foretells them.

    Attributes:
        region: of the body.
        axis: direction of impact.
        peak_force: P×K [N], poses by stiffnesses.
        predictors: length P each.
        correlation: Spearman's ρ of each predictor with the force, length K each; 1 if it puts
            the poses in the order of their forces.
        spread: largest force over smallest, less one, length K.
    """

    region: str
    axis: str
    peak_force: Array
    predictors: Mapping[str, Array]
    correlation: Mapping[str, Array]
    spread: Array


def agreements(
    study: Study, functions: FactorFunctions, poses: Sequence[Array], rotors: Array
) -> list[Agreement]:
    """Return the agreement for every region and direction.

    Args:
        study: robot, tip and speed.
        functions: of the robot and tip.
        poses: link angles, each of length n.
        rotors: reflected inertias, length n [kg m²].
    """
    return [
        _agreement(study, functions, poses, rotors, region, axis)
        for region in REGIONS
        for axis in AXES
    ]


def _agreement(
    study: Study,
    functions: FactorFunctions,
    poses: Sequence[Array],
    rotors: Array,
    region: str,
    axis: str,
) -> Agreement:
    n = np.array(AXES[axis])
    factors = [functions.at(q, rotors, n) for q in poses]
    predictors = {name: np.array([getattr(f, name) for f in factors]) for name in PREDICTORS}
    forces = np.array(
        [[_force(study, rotors, q, n, region, k) for k in STIFFNESSES] for q in poses]
    )
    correlation = {
        name: np.array([_sign(name) * spearman(values, column) for column in forces.T])
        for name, values in predictors.items()
    }
    spread = forces.max(axis=0) / forces.min(axis=0) - 1
    return Agreement(region, axis, forces, predictors, correlation, spread)


def _sign(predictor: str) -> int:
    return 1 if predictor.startswith("mass_") and predictor != "mass_ratio" else -1


def _force(study: Study, rotors: Array, q: Array, n: Array, region: str, stiffness: float) -> float:
    if np.isinf(stiffness):
        model = impact_model(study.robot.with_armature(rotors), study.model.tip)
    else:
        model = study.model.with_springs(ca.DM(np.full(study.robot.n, stiffness)))
        model = replace(model, drives=replace(model.drives, rotors=ca.DM(rotors)))
    contact = Contact(body_region(region), study.contact.clamped)
    approach = Approach(q, n, study.speed)
    return simulate_impact(model, approach, contact, "linearised", horizon=None).first_contact


def spearman(first: Array, second: Array) -> float:
    """Return Spearman's rank correlation; NaN where one does not vary."""
    a, b = _ranks(first), _ranks(second)
    if np.ptp(a) == 0 or np.ptp(b) == 0:
        return float("nan")
    return float(np.corrcoef(a, b)[0, 1])


def _ranks(values: Array) -> Array:
    """Ranks from 1; equal values share their mean rank."""
    _, place, count = np.unique(values, return_inverse=True, return_counts=True)
    last = np.cumsum(count)
    return np.asarray((last - (count - 1) / 2)[place])
