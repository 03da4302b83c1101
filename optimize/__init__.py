# SPDX-License-Identifier: BSD-3-Clause
"""Design problems: which joint stiffness and which posture hurt least."""

from .co_design import Design, Gains, PoseResult, design
from .front.front import Front, ParetoPoint
from .front.pareto import Pareto, pareto_fronts
from .front.trade_off import TradeOff, TradePoint, trade_off_front
from .search.failure import Infeasible, SolverFailure, Unavailable
from .search.solve import Mode, Outcome
from .study.poses import Candidate, candidates
from .study.study import Pose, Study, load_study

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
    "SolverFailure",
    "Study",
    "TradeOff",
    "TradePoint",
    "Unavailable",
    "candidates",
    "design",
    "load_study",
    "pareto_fronts",
    "trade_off_front",
]
