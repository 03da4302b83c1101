# SPDX-License-Identifier: BSD-3-Clause
"""The controller that drives a robot before an impact, and goes on until it reacts."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, get_args

import numpy as np

from softimpact.symbolic import InvalidValue, UnknownName
from softimpact.symbolic.impact.motors import REACTION_TIME

ControllerReference = Literal["moving", "held"]
"""Motors' wanted motion after first touch: on with the speed of arrival, or none."""


@dataclass(frozen=True)
class Controller:
    """Computed torque with PID over the motors, until the robot reacts (MSM §3.1.3).

    τ = M_θθ(q) (k_p e + k_d ė + k_i ∫e dt) + what gravity, springs and Coriolis forces need; e is
    how far the motors are behind their reference, and ∫e starts from zero at first touch. From the
    reaction on τ holds potential forces only. The paper leaves open which inertia multiplies the
    PID (M_θθ makes K_p the one in its K0) and what the reference does after first touch.

    Attributes:
        proportional: k_p [rad/s²].
        derivative: k_d, per unit of inertia as k_p is [rad/s].
        integral: k_i [rad/s³].
        reference: of the motors after first touch.
        reaction_time: from first touch [s]; infinite without a reaction.
    """

    proportional: float
    derivative: float
    integral: float
    reference: ControllerReference = "moving"
    reaction_time: float = REACTION_TIME


def check_controller(controller: Controller) -> None:
    """Raise InvalidValue or UnknownName if a field of the controller cannot be."""
    for gain in ("proportional", "derivative", "integral"):
        value = getattr(controller, gain)
        if not 0 <= value < np.inf:
            raise InvalidValue(f"controller.{gain}", f"must be finite and ≥ 0, not {value}")
    if controller.reference not in get_args(ControllerReference):
        raise UnknownName(
            "reference of the motors", controller.reference, get_args(ControllerReference)
        )
    if not controller.reaction_time > 0:
        raise InvalidValue(
            "controller.reaction_time", f"must be greater than 0 s, not {controller.reaction_time}"
        )
