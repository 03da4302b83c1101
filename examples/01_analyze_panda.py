# SPDX-License-Identifier: BSD-3-Clause
"""What the Panda's hand weighs in an impact, and how fast it may be with softer joints."""

from softimpact.simulate import Approach, assess_impact
from softimpact.symbolic import Contact, analyse, body_region, drives, impact_model, load_robot

panda = load_robot("panda")
q, direction = [0.2, 0.3, -0.4, -1.8, 0.1, 2.0, 0.5], [0.0, 1.0, 0.0]
chest = Contact(body_region("chest"))

for joint_stiffness in (3e4, 1e4, 3e3):
    model = impact_model(panda, drives=drives(panda, joint_stiffness))
    found = analyse(model, q, direction)
    impact = assess_impact(model, Approach(q, direction, 1.0), chest, safe_speed=True)
    speed = impact.safe_speed
    print(
        f"k_s {joint_stiffness:6.0f} N·m/rad: the body meets {found.m_c:.2f} kg first, not "
        f"{found.reflected_mass_rigid:.2f} kg as with rigid joints; safe up to {speed:.2f} m/s"
    )
