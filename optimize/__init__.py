# SPDX-License-Identifier: BSD-3-Clause
"""Design problems: which joint stiffness and which posture hurt least.

Names are imported when they are first used: who reads a study need not wait for the searches.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from softimpact.lazy import lazily

if TYPE_CHECKING:
    from .co_design import Design, Gains, PoseResult, design
    from .front.front import Front, ParetoPoint
    from .front.pareto import Pareto, pareto_fronts
    from .front.trade_off import TradeOff, TradePoint, trade_off_front
    from .robust.robust import RobustDesign, robust_design
    from .search.failure import Infeasible, SolverFailure, Unavailable
    from .search.solve import Mode, Outcome
    from .study.poses import Candidate, candidates
    from .study.scenarios import Scenarios
    from .study.study import Pose, Study, load_study
    from .study.study_scenarios import scenarios_of

_HOMES = {
    "co_design": ("Design", "Gains", "PoseResult", "design"),
    "front.front": ("Front", "ParetoPoint"),
    "front.pareto": ("Pareto", "pareto_fronts"),
    "front.trade_off": ("TradeOff", "TradePoint", "trade_off_front"),
    "robust.robust": ("RobustDesign", "robust_design"),
    "search.failure": ("Infeasible", "SolverFailure", "Unavailable"),
    "search.solve": ("Mode", "Outcome"),
    "study.poses": ("Candidate", "candidates"),
    "study.scenarios": ("Scenarios",),
    "study.study": ("Pose", "Study", "load_study"),
    "study.study_scenarios": ("scenarios_of",),
}

__all__ = [
    "Candidate",
    "Design",
    "Front",
    "Gains",
    "Infeasible",
    "Mode",
    "Outcome",
    "Pareto",
    "ParetoPoint",
    "Pose",
    "PoseResult",
    "RobustDesign",
    "Scenarios",
    "SolverFailure",
    "Study",
    "TradeOff",
    "TradePoint",
    "Unavailable",
    "candidates",
    "design",
    "load_study",
    "pareto_fronts",
    "robust_design",
    "scenarios_of",
    "trade_off_front",
]


__getattr__ = lazily(__name__, _HOMES)


def __dir__() -> list[str]:
    return [*globals(), *__all__]
