# SPDX-License-Identifier: BSD-3-Clause
"""The physics as CasADi expressions.

- ``robot``: what a robot is, reading files, welding, payload
- ``dynamics``: kinematics, mass matrix, bias, potential energy, rest
- ``loops``: closed chains and couplings
- ``impact``: motors, springs, the linear model, its reductions
- ``body``: what is hit, and what it may bear
- ``factors``: GIAF and its family

``docs/python.md`` lists the names so grouped, each with a line.
"""

from .body.bodies import body_region
from .body.contact import Contact
from .body.laws import Curve, Law, PowerLaw, in_series
from .body.regions import AREAS, REGIONS, BodyRegion
from .body.shapes import Edge, Flat, Sphere
from .body.verdict import Limits, Verdict, judge, limits_of
from .dynamics.equations_of_motion import (
    STANDARD_GRAVITY,
    bias_acceleration,
    bias_torques,
    gravity_torques,
    mass_matrix,
    potential_energy,
    stiffness_of_potential,
)
from .dynamics.equilibrium import link_angles_at_rest, motor_angles_at_rest
from .dynamics.kinematics import (
    contact_point_jacobian,
    direction_jacobian,
    frame_jacobian,
    frame_pose,
)
from .eigen import Eigen, symmetric_eigen
from .errors import (
    FrameNotFound,
    InvalidInertia,
    InvalidValue,
    LoopCannotClose,
    LoopError,
    MasslessBase,
    ModelFileError,
    NoEquilibrium,
    RedundantLoop,
    SingularDirection,
    SingularLoop,
    SoftImpactError,
    UnknownName,
    UnsupportedModel,
    WrongLength,
)
from .factors.contact_mobility import (
    ContactMobility,
    contact_mobility,
    directional_giaf,
    giaf,
    giif,
)
from .factors.ellipsoids import (
    Ellipsoid,
    dynamic_impact_ellipsoid,
    dynamic_impact_measure,
    force_measure,
    generalised_inertia_ellipsoid,
    longest_manipulability,
    manipulability,
    manipulability_ellipsoid,
)
from .factors.extreme_directions import Extremes, extreme_directional_giaf, extreme_mass_ratio
from .factors.impact_factors import ImpactFactors, impact_factors
from .factors.impact_mitigation import ImpactMitigation, impact_mitigation
from .factors.joint_impulse import JointImpulse, joint_impulse
from .factors.rotor_influence import giaf_by_gear, giaf_by_rotor, single_joint_giaf
from .impact.analysis import Analysis, ChainNumbers, analyse
from .impact.approach import approach_velocity, generalised_velocity, least_velocity, unit_direction
from .impact.chain import Chain, chain, free_end
from .impact.drives import Drives, drives
from .impact.elastic import LinearModel
from .impact.floating import FloatingRobot, floating_model, floating_robot
from .impact.impact_model import ImpactModel, impact_model
from .impact.linearisation_error import linearisation_error
from .impact.motors import MotorKind, Motors
from .impact.reduction import ReducedModel, reduce_to_two_masses, reflected_mass, static_stiffness
from .impact.two_body import TwoBody, moving_mass, two_body
from .loops.closure import (
    close_loops,
    closed_near,
    configuration_at_rest,
    require_closed_at,
)
from .loops.couplings import own_joints, whole_configuration
from .loops.loop_equations import ClosedChain
from .loops.loops import (
    closed_chain,
    constrained_stiffness,
    loop_acceleration,
    loop_gaps,
    loop_jacobian,
    loop_tangent,
)
from .matrices import Matrix, count_flops
from .robot.arm import Arm, arm_of, with_load
from .robot.constraints import Coupling, Loop, Tendon
from .robot.loading import load_robot
from .robot.robot import Frame, Joint, JointKind, Robot
from .robot.welding import chain_to, lock_joints

__all__ = [
    "AREAS",
    "REGIONS",
    "STANDARD_GRAVITY",
    "Analysis",
    "Arm",
    "BodyRegion",
    "Chain",
    "ChainNumbers",
    "ClosedChain",
    "Contact",
    "ContactMobility",
    "Coupling",
    "Curve",
    "Drives",
    "Edge",
    "Eigen",
    "Ellipsoid",
    "Extremes",
    "Flat",
    "FloatingRobot",
    "Frame",
    "FrameNotFound",
    "ImpactFactors",
    "ImpactMitigation",
    "ImpactModel",
    "InvalidInertia",
    "InvalidValue",
    "Joint",
    "JointImpulse",
    "JointKind",
    "Law",
    "Limits",
    "LinearModel",
    "Loop",
    "LoopCannotClose",
    "LoopError",
    "MasslessBase",
    "Matrix",
    "ModelFileError",
    "MotorKind",
    "Motors",
    "NoEquilibrium",
    "PowerLaw",
    "ReducedModel",
    "RedundantLoop",
    "Robot",
    "SingularDirection",
    "SingularLoop",
    "SoftImpactError",
    "Sphere",
    "Tendon",
    "TwoBody",
    "UnknownName",
    "UnsupportedModel",
    "Verdict",
    "WrongLength",
    "analyse",
    "approach_velocity",
    "arm_of",
    "bias_acceleration",
    "bias_torques",
    "body_region",
    "chain",
    "chain_to",
    "close_loops",
    "closed_chain",
    "closed_near",
    "configuration_at_rest",
    "constrained_stiffness",
    "contact_mobility",
    "contact_point_jacobian",
    "count_flops",
    "direction_jacobian",
    "directional_giaf",
    "drives",
    "dynamic_impact_ellipsoid",
    "dynamic_impact_measure",
    "extreme_directional_giaf",
    "extreme_mass_ratio",
    "floating_model",
    "floating_robot",
    "force_measure",
    "frame_jacobian",
    "frame_pose",
    "free_end",
    "generalised_inertia_ellipsoid",
    "generalised_velocity",
    "giaf",
    "giaf_by_gear",
    "giaf_by_rotor",
    "giif",
    "gravity_torques",
    "impact_factors",
    "impact_mitigation",
    "impact_model",
    "in_series",
    "joint_impulse",
    "judge",
    "least_velocity",
    "limits_of",
    "linearisation_error",
    "link_angles_at_rest",
    "load_robot",
    "lock_joints",
    "longest_manipulability",
    "loop_acceleration",
    "loop_gaps",
    "loop_jacobian",
    "loop_tangent",
    "manipulability",
    "manipulability_ellipsoid",
    "mass_matrix",
    "motor_angles_at_rest",
    "moving_mass",
    "own_joints",
    "potential_energy",
    "reduce_to_two_masses",
    "reflected_mass",
    "require_closed_at",
    "single_joint_giaf",
    "static_stiffness",
    "stiffness_of_potential",
    "symmetric_eigen",
    "two_body",
    "unit_direction",
    "whole_configuration",
    "with_load",
]
