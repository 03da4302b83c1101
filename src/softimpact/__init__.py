# SPDX-License-Identifier: BSD-3-Clause
"""Design compliant robots whose impacts do not hurt.

The names that most people need are here; each is of one of the packages ``symbolic``, ``simulate``,
``optimize`` and ``codegen``, which have the rest. They are imported when they are first used.
"""

from __future__ import annotations

from importlib.metadata import version
from typing import TYPE_CHECKING

from .lazy import lazily

if TYPE_CHECKING:
    from .codegen import generate_package
    from .batch import compiled
    from .optimize import design, load_study, pareto_fronts, robust_design
    from .plots import plot
    from .simulate import (
        Approach,
        assess_impact,
        assess_impacts,
        largest_safe_speed,
        simulate_impact,
    )
    from .symbolic import (
        Contact,
        Motors,
        analyse,
        arm_of,
        body_region,
        drives,
        impact_factors,
        impact_model,
        load_robot,
        with_load,
    )

__version__ = version("softimpact")

_HOMES = {
    "symbolic": (
        "Contact",
        "Motors",
        "analyse",
        "arm_of",
        "body_region",
        "drives",
        "impact_factors",
        "impact_model",
        "load_robot",
        "with_load",
    ),
    "simulate": (
        "Approach",
        "assess_impact",
        "assess_impacts",
        "largest_safe_speed",
        "simulate_impact",
    ),
    "optimize": ("design", "load_study", "pareto_fronts", "robust_design"),
    "batch": ("compiled",),
    "plots": ("plot",),
    "codegen": ("generate_package",),
}

__all__ = [
    "Approach",
    "Contact",
    "Motors",
    "analyse",
    "arm_of",
    "assess_impact",
    "assess_impacts",
    "body_region",
    "compiled",
    "design",
    "drives",
    "generate_package",
    "impact_factors",
    "impact_model",
    "largest_safe_speed",
    "load_robot",
    "load_study",
    "pareto_fronts",
    "plot",
    "robust_design",
    "simulate_impact",
    "with_load",
]


__getattr__ = lazily(__name__, _HOMES)


def __dir__() -> list[str]:
    return [*globals(), *__all__]
