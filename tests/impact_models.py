# SPDX-License-Identifier: BSD-3-Clause
"""Python's models of what a compiled package was asked for."""

from __future__ import annotations

import casadi as ca
from compiled_impacts import Impacts

from softimpact.codegen.inputs.samples import Sample
from softimpact.symbolic import Drives, ImpactModel, impact_model


def model_of(compiled: Impacts, sample: Sample) -> ImpactModel:
    """Return the robot with a sample's drives."""
    named = dict(zip((p.name for p in compiled.package.parameters), sample.parameters, strict=True))
    robot = compiled.package.robot
    known = Drives(
        ca.DM(named["rotor_inertia"]),
        ca.DM(named["joint_stiffness"]),
        (True,) * robot.n,
        ca.DM(named["position_gain"]),
        damping_gains=ca.DM(named["damping_gain"]),
    )
    return impact_model(robot, compiled.package.tip, drives=known)
