# SPDX-License-Identifier: BSD-3-Clause
"""Look for safe speeds that are none: random and hill-climbed inputs against the tests' integrator.

Usage: python tests/adversarial.py [--count N] [--climbs N] [--seed N] [--out FILE] [ROBOT ...]

For each robot, in float and in double, ``count`` random cases and ``climbs`` climbs of 40 turns
from the worst of them. The safe speed and two lower speeds of each case are integrated by Runge and
Kutta's method (``codegen/impact_oracle.c``), those that come near the limit once more in finer
steps. Ends with 1 if a force exceeds its limit.
"""

from __future__ import annotations

import argparse
import json
import os
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import asdict, dataclass, replace
from functools import cache
from pathlib import Path

import numpy as np
from compiled_packages import KINDS, Generated
from impact_search import BOUNDED, BRACKET, OK, Case, Robot, changed, draw
from oracles import example_urdf

from softimpact.codegen import generate_package
from softimpact.symbolic import Robot as RobotModel
from softimpact.symbolic import arm_of, drives, load_robot

ROBOTS = ("panda", "ur5e", "solo12", "rr", "iiwa14")

ROUND = 250
"""Cases that a process looks at in one go."""

TURNS = 40
"""Of a climb."""

LOWER = (0.5, 1.0)
"""Shares of a safe speed between which two lower speeds are drawn."""

NEAR = 0.9985
"""Share of a limit from which on a force is integrated in finer steps."""


@dataclass(frozen=True)
class Found:
    """What a search found.

    Attributes:
        cases: inputs looked at.
        answered: of these, how many had a safe speed.
        bounded: of these, how many one from a bound.
        integrated: impacts integrated.
        worst: largest force over its limit.
        below: the same at speeds below the safe one.
        slower: largest force at a speed below the safe one, over that at the safe one.
        median: force over limit at the safe speed.
        worst_case: inputs of the worst.
    """

    cases: int = 0
    answered: int = 0
    bounded: int = 0
    integrated: int = 0
    worst: float = 0.0
    below: float = 0.0
    slower: float = 0.0
    median: float = 0.0
    worst_case: str = ""

    def joined(self, other: Found) -> Found:
        """Return both together; medians are of the larger search."""
        worse = self if self.worst >= other.worst else other
        larger = self if self.answered >= other.answered else other
        return Found(
            self.cases + other.cases,
            self.answered + other.answered,
            self.bounded + other.bounded,
            self.integrated + other.integrated,
            worse.worst,
            max(self.below, other.below),
            max(self.slower, other.slower),
            larger.median,
            worse.worst_case,
        )


def generated(name: str, folder: Path) -> Generated:
    """Return the package of a robot by name."""
    if name == "solo12":
        robot = arm_of(load_robot(example_urdf("solo12.urdf")), "FL_FOOT").robot
        known = drives(robot, rotor_inertia=0.1)
        manifest = generate_package(robot, folder, name="solo12", drives=known)
        return Generated(robot, "FL_FOOT", folder, manifest)
    robot = two_links() if name == "rr" else load_robot(name)  # whose springs are no inputs
    tip = str(robot.tip)
    return Generated(robot, tip, folder, generate_package(robot, folder, name=name))


def two_links() -> RobotModel:
    """Return RR's links, turned by motors through springs."""
    xml = """<mujoco><worldbody>
      <body name="upper"><joint name="q1" axis="0 0 1" range="-3 3" armature=".3"/>
        <inertial mass="10" pos=".5 0 0" diaginertia=".01 .8333 .8333"/>
        <body name="lower" pos="1 0 0"><joint name="q2" axis="0 0 1" range="-3 3" armature=".3"/>
          <inertial mass="10" pos=".5 0 0" diaginertia=".01 .8333 .8333"/>
          <site name="tip" pos="1 0 0"/>
        </body></body></worldbody></mujoco>"""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder, "rr.xml")
        path.write_text(xml, encoding="utf-8")
        return replace(load_robot(path), tip="tip")


@cache
def robot_of(name: str, root: str) -> Robot:
    """Return a robot of this process; its package is shared by all."""
    folder = Path(root, name, str(os.getpid()))
    folder.mkdir(parents=True, exist_ok=True)
    return Robot(generated(name, folder / "package"), folder)


def cases_of(robot: Robot, random: np.random.Generator) -> Iterator[Case]:
    """Yield random cases in directions in which the robot moves."""
    plane = robot.n == 2
    while True:
        case = draw(robot, random)
        if random.random() < 0.3:
            case = replace(case, motors=BRACKET)
        if random.random() < 0.05:  # the default, which takes five times as long
            case = replace(case, horizon=0.5)
        yield replace(case, n=case.n * [1, 1, 0]) if plane else case


class Search:
    """Looks at cases one after the other."""

    def __init__(self, robot: Robot, real: str, random: np.random.Generator) -> None:
        self.robot, self.real, self.random = robot, real, random
        self.found, self.shares = Found(), list[float]()

    def score(self, case: Case) -> float:
        """Return the largest force over its limit up to the safe speed of a case."""
        status, (speed, _) = self.robot.call("safe_speed", case, case.limit, self.real, 8000)
        one = Found(cases=1)
        if status not in (OK, BOUNDED):
            self.found = self.found.joined(one)
            return 0.0
        shares = [1.0, *self.random.uniform(*LOWER, 2)]
        forces = [self._share(case, speed * share) for share in shares]
        self.shares.append(forces[0])
        worst, below = max(forces), max(forces[1:])
        said = "" if worst < NEAR else repr({**vars(case), "speed": speed})
        slower = below / forces[0]
        one = Found(1, 1, int(status == BOUNDED), len(forces), worst, below, slower, 0.0, said)
        self.found = self.found.joined(one)
        return worst

    def _share(self, case: Case, speed: float) -> float:
        share = self.robot.right_force(case, speed, 2.0) / case.limit
        return share if share < NEAR else self.robot.right_force(case, speed) / case.limit

    def random_cases(self, count: int) -> list[tuple[float, Case]]:
        """Look at random cases; return them, the worst first."""
        drawn = cases_of(self.robot, self.random)
        seen = [(self.score(case), case) for case, _ in zip(drawn, range(count), strict=False)]
        return sorted(seen, key=lambda pair: -pair[0])

    def climb(self, best: float, case: Case) -> None:
        """Climb from a case."""
        for _ in range(TURNS):
            other = changed(case, self.random, self.robot)
            found = self.score(other)
            if found > best:
                best, case = found, other


def round_of(name: str, root: str, real: str, seed: int, count: int, climbs: int) -> Found:
    """Look at some random cases and climb from the worst of them, in a process of its own."""
    search = Search(robot_of(name, root), real, np.random.default_rng(seed))
    for best, case in search.random_cases(count)[:climbs]:
        search.climb(best, case)
    median = float(np.median(search.shares)) if search.shares else 0.0
    return replace(search.found, median=median)


def main() -> int:
    """Search, and say what was found."""
    parser = argparse.ArgumentParser(description=str(__doc__).split("\n", maxsplit=1)[0])
    parser.add_argument("robots", nargs="*", default=ROBOTS)
    parser.add_argument("--count", type=int, default=1000, help="random cases of each build")
    parser.add_argument("--climbs", type=int, default=2, help=f"for every {ROUND} of them")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--out", type=Path)
    told = parser.parse_args()
    everything = {}
    with (
        tempfile.TemporaryDirectory() as root,
        ProcessPoolExecutor(told.workers) as pool,
    ):
        for name in told.robots:
            for real in KINDS:
                rounds = -(-told.count // ROUND)
                jobs = [
                    pool.submit(round_of, name, root, real, told.seed + k, ROUND, told.climbs)
                    for k in range(rounds)
                ]
                found = Found()
                for job in jobs:
                    found = found.joined(job.result())
                everything[f"{name}, {real}"] = asdict(found)
                print(
                    f"{name}, {real}: {found.cases} cases, {found.integrated} impacts, "
                    f"worst {found.worst:.5f} of the limit, below the safe speed {found.below:.5f} "
                    f"({found.slower:.5f} of the force there), "
                    f"{found.bounded} from a bound, median {found.median:.4f}",
                    flush=True,
                )
                if found.worst > 1:
                    print(f"  {found.worst_case}", flush=True)
    if told.out:
        told.out.write_text(json.dumps(everything, indent=2) + "\n", encoding="utf-8")
    return int(any(found["worst"] > 1 for found in everything.values()))


if __name__ == "__main__":
    sys.exit(main())
