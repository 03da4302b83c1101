# SPDX-License-Identifier: BSD-3-Clause
"""The numbers that MSM prints (only numbers; by scenario a to f)."""

from __future__ import annotations

M_C = {"a": 0.73, "b": 6.46, "c": 1.12, "d": 9.13, "e": 1.17, "f": 0.44}
"""[kg] (§3.2.3, §3.3.3)."""

K_R = {"a": 5.1, "b": 23.5, "c": 5.4, "d": 10.8}
"""[10⁴ N/m] at k_s = 10⁴ N·m/rad (§3.2.4)."""

M_A = {"a": 3.49, "b": 12.8, "c": 3.88, "d": 7.43}
"""[kg] at k_s = 10⁴ N·m/rad (§3.2.4)."""

ONE_MASS = {
    "head": {"a": 291, "b": 903, "c": 363, "d": 1079, "e": 372, "f": 222},
    "chest": {"a": 152, "b": 387, "c": 156, "d": 462, "e": 160, "f": 95},
}
"""Peak force of the single mass m_c at 1 m/s [N] (§3.2.4, §3.3.4)."""

MISPRINTED_FORCES = {
    ("chest", "a"): "two digits are swapped; 125 N is what its mean error and the others fit"
}
"""Which of these cannot be, by region and scenario, and why."""

ONE_MASS_ERROR = {
    "head": {"a": 11.0, "b": 23.5, "c": 9.6, "d": 14.3, "e": 4.6, "f": 29.3},
    "chest": {"a": 30.9, "b": 32.1, "c": 28.8, "d": 21.8, "e": 10.3, "f": 51.2},
}
"""Mean error of that force over k_s [%]."""

TWO_MASS_ERROR = {
    "head": {"a": 1.8, "b": 8.7, "c": 1.9, "d": 6.2, "e": 3.6, "f": 4.2},
    "chest": {"a": 2.8, "b": 6.8, "c": 2.8, "d": 7.7, "e": 8.8, "f": 13.8},
}
"""Mean error of the two-mass model's first peak over k_s [%] (Fig. 8, 15)."""

SPEED_ERROR = {"a": 0.55, "b": 4.8, "c": 0.3, "d": 8.2}
"""Largest error of the two-mass model's first peak over speed [%] (Fig. 9)."""

MOTOR_RATES = {"e": (-2.80, -2.74), "f": (-2.80, -5.00)}
"""Actuator speeds at 1 m/s [rad/s] (§3.3.2)."""

DECOUPLING = {"a": 4056.0, "f": 351.0}
"""Largest k_s with isolated peaks on the head [N·m/rad] (§3.2.4, §3.3.4)."""

SECONDS = (0.31, 44.2)
"""Mean time to simulate an impact of R-Min, reduced and full (§3.3.4)."""

LINKS = {
    "rr": {
        "q1": (0.0, 1.5, 4.71, 0.0),
        "q2": (0.5, 17.4, 0.539, 0.068),
        "q3": (0.0, 1.5, 0.83, 0.0),
        "q4": (0.5, 6.04, 0.086, 0.143),
    },
    "rmin": {
        f"q{arm}{link}": values
        for arm in (1, 2)
        for link, values in {
            1: (0.28, 6.92, 0.033, 0.015),
            2: (0.2, 0.26, 0.0021, 0.120),
            3: (0.2, 0.20, 0.0016, 0.100),
        }.items()
    },
}
"""Length [m], mass [kg], inertia about the centre of mass [kg m²], its place [m] by the joint that
moves the link (Tables 1 and 2)."""
