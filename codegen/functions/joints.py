# SPDX-License-Identifier: BSD-3-Clause
"""Functions with a result for each joint: its impulse, and what its rotor does to GIAF."""

from __future__ import annotations

from softimpact.symbolic import giaf_by_rotor, single_joint_giaf
from softimpact.symbolic.factors.joint_impulse import impulse_along

from .description import CFunction, Guard, Output
from .guards import movable, movable_in_space
from .symbols import Symbols, function_over


def joint_impulse(s: Symbols) -> CFunction:
    """Return what an impact does to the joints."""
    push = s.model.contact_jacobian(s.q, s.n)[:, : s.robot.n].T
    speed, restitution, other = (
        s.values[name] for name in ("speed", "restitution", "other_mobility")
    )
    M, rotors = s.mass_matrix, s.values["rotor_inertia"]
    found = impulse_along(M, rotors, push, speed, restitution, other)
    mass = impulse_along(M, rotors, push).contact
    outputs = (
        Output("contact", found.contact, "N s", "between the bodies"),
        Output("joints", found.joints, "N m s", "-J'n contact, on each joint's axis"),
        Output("gears", found.gears, "N m s", "from each link to its rotor"),
        Output("velocity_change", found.velocity_change, "rad/s", "of each joint"),
    )
    summary = "Impulses of an impact on the robot with rigid joints (GIAF Eq. 14, derived anew)."
    return function_over(s, "joint_impulse", summary, outputs, (movable(s.robot, mass),))


def rotor_influence(s: Symbols) -> CFunction:
    """Return the derivatives of GIAF by each rotor's inertia and gear ratio."""
    M, rotors, J = s.mass_matrix, s.values["rotor_inertia"], s.jacobian
    slope = giaf_by_rotor(M, rotors, J)
    by_gear = "for a change of the gear ratio by its own size: 2 b dGIAF/db"
    outputs = (
        Output("by_rotor", slope, "1/(kg m^2)", "dGIAF/db of each rotor inertia b"),
        Output("by_gear", 2 * rotors * slope, "dimensionless", by_gear, scale=1.0),
    )
    summary = "What each rotor and gear does to the absorption factor (GIAF III)."
    return function_over(s, "rotor_influence", summary, outputs, _in_space(s))


def single_joint(s: Symbols) -> CFunction:
    """Return GIAF with one rotor at a time."""
    M, rotors, J = s.mass_matrix, s.values["rotor_inertia"], s.jacobian
    meaning = "with the rotor of each joint alone"
    output = Output("giaf", single_joint_giaf(M, rotors, J), "dimensionless", meaning, scale=1.0)
    summary = "Absorption factor of each joint alone (GIAF III.B)."
    return function_over(s, "single_joint_giaf", summary, (output,), _in_space(s))


def _in_space(s: Symbols) -> tuple[Guard, ...]:
    mobilities = (s.mobility, s.free_mobility)
    return tuple(movable_in_space(s.robot, mobility.inertia) for mobility in mobilities)
