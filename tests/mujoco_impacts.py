# SPDX-License-Identifier: BSD-3-Clause
"""The body's side of an impact, for robots that MuJoCo steps."""

from __future__ import annotations

from softimpact.symbolic import Contact


def node_after(step: float, x_0: float, x_c: float, contact: Contact) -> float:
    """Implicit Euler step of c_h ẋ_0 = f_c − k_h x_0."""
    k_f, k_h, c_h = contact.hertz_stiffness, contact.region.stiffness, contact.region.damping
    x = x_0
    for _ in range(8):
        depth = max(x_c - x, 0.0)
        residual = c_h * (x - x_0) / step - k_f * depth**1.5 + k_h * x
        x -= residual / (c_h / step + 1.5 * k_f * depth**0.5 + k_h)
    return x
