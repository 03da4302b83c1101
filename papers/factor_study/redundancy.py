# SPDX-License-Identifier: BSD-3-Clause
"""GIAF, masses and peak force along the whole self-motion, and the best point of each."""

from __future__ import annotations

from dataclasses import dataclass, replace

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from softimpact.optimize import Study
from softimpact.optimize.posture.self_motion import SelfMotion
from softimpact.optimize.search.best_posture import (
    BestPosture,
    best_posture,
    posture_of_least_force,
)
from softimpact.simulate import Approach, simulate_impact
from softimpact.symbolic import ImpactModel, Matrix, Motors, giaf
from softimpact.symbolic.robot.rigid import Array

from .functions import FactorFunctions

FORCES_EVERY = 4
"""Postures of the curve between simulated impacts."""


@dataclass(frozen=True, eq=False)
class AlongSelfMotion:
    """Figures along a self-motion for one tip and one set of rotors.

    Attributes:
        giaf: ζ, length K.
        mass_free: m_c of the elastic robot, length K [kg].
        mass_rigid: reflected mass of the rigid robot, length K [kg].
        simulated: indices of the postures whose impact was simulated.
        peak_force: of the first contact there, nominal stiffness [N].
        most_giaf: posture of largest ζ.
        least_mass: posture of least m_c.
        least_force: posture of least peak force.
    """

    giaf: Array
    mass_free: Array
    mass_rigid: Array
    simulated: NDArray[np.int_]
    peak_force: Array
    most_giaf: BestPosture
    least_mass: BestPosture
    least_force: BestPosture


def along_self_motion(
    study: Study, model: ImpactModel, functions: FactorFunctions, curve: SelfMotion
) -> AlongSelfMotion:
    """Return the figures along a curve; Ipopt starts from its best posture.

    Args:
        study: impact and joint stiffness.
        model: the robot at the tip in question with the rotors in question, joints elastic.
        functions: of the robot and tip.
        curve: of the study's task.
    """
    rotors = np.array(model.drives.rotors).ravel()
    found = [functions.at(q, rotors, study.direction) for q in curve.q]
    zeta, mass = np.array([f.giaf for f in found]), np.array([f.mass_free for f in found])
    simulated = np.arange(0, len(curve.q), FORCES_EVERY)
    forces = np.array([peak_force(study, model, curve.q[i]) for i in simulated])
    n = ca.DM(study.direction)

    def absorbed(q: Matrix) -> Matrix:
        return -giaf(model.free_mobility(q), model.mobility(q))

    def felt(q: Matrix) -> Matrix:
        return model.reflected_mass(q, n)

    most = best_posture(model, curve.q[np.argmax(zeta)], absorbed)
    best_start = curve.q[simulated[np.argmin(forces)]]
    return AlongSelfMotion(
        giaf=zeta,
        mass_free=mass,
        mass_rigid=np.array([f.mass_rigid for f in found]),
        simulated=simulated,
        peak_force=forces,
        most_giaf=replace(most, value=-most.value),
        least_mass=best_posture(model, curve.q[np.argmin(mass)], felt),
        least_force=posture_of_least_force(_as_published(study, model), best_start),
    )


def _as_published(study: Study, model: ImpactModel) -> Study:
    """Return the study with motors that are free from first touch on, and its first contact."""
    free = (Motors("free"),)
    return replace(study, model=model, motors=free, horizon=FIRST_CONTACT)


FIRST_CONTACT = 0.1
"""Time [s] in which the tip leaves the body once."""


def peak_force(study: Study, model: ImpactModel, q: Array) -> float:
    """Return the peak of the first contact with the linearised robot [N]."""
    approach = Approach(q, study.direction, study.speed)
    return simulate_impact(model, approach, study.contact, "linearised", horizon=None).first_contact
