# SPDX-License-Identifier: BSD-3-Clause
"""Time reduced impacts, compiled from the generated C, against full simulation in the same run.

Usage: python benchmarks/impact/run.py [--json]

Reduced: from joint angles to the peak force, chain of three masses by the generated package and a
leapfrog in chain.c. Full: ``simulate_impact(..., "full")`` by SUNDIALS, with its model and
integrator built beforehand, from first touch to separation. Also timed: the same full simulation
with a loose tolerance. Needs a C compiler. Exits with 1 if the chain's peak is off its own
integration by SUNDIALS, or a ratio misses the target.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from softimpact.simulate import Approach, Fidelity, simulate_impact
from softimpact.symbolic import (
    Contact,
    ImpactModel,
    body_region,
    drives,
    impact_model,
    load_robot,
)

HERE = Path(__file__).parent
GENERATED = HERE.parents[1] / "generated"
STEPS = 30
REPEATS = 1_000
LOOSE = 1e-6
ACCURACY = 1e-3
TARGET = 1000.0


@dataclass(frozen=True)
class Case:
    """A robot about to hit a head."""

    name: str
    model: ImpactModel
    approach: Approach


@dataclass(frozen=True)
class Measured:
    """Times [s] and peak forces [N] of a case."""

    robot: str
    full_seconds: float
    full_loose_seconds: float
    reduction_seconds: float
    reduced_seconds: float
    ratio: float
    ratio_loose: float
    full_peak: float
    full_loose_peak: float
    chain_peak: float
    reduced_peak: float
    error_of_integration: float
    error_of_reduction: float


def cases() -> list[Case]:
    rr, panda = load_robot("rr"), load_robot("panda")
    straight = Approach(np.zeros(4), np.array([0.0, 1.0, 0.0]), 1.0, np.array([1.0, 0.0, 0.0, 0.0]))
    pose = np.array([0.1, -0.3, 0.2, -2.0, 0.3, 2.0, 0.5])
    return [
        Case("rr", impact_model(rr), straight),
        Case(
            "panda",
            impact_model(panda, drives=drives(panda, 1e4)),
            Approach(pose, np.array([0.0, 1.0, 0.0]), 1.0),
        ),
    ]


def build(case: Case, folder: Path) -> Path:
    name, upper = case.name, case.name.upper()
    package, program = GENERATED / name, folder / name
    defines = {
        "PACKAGE": f'"{name}.h"',
        "CHAIN": f"{name}_chain_t",
        "PARAMS": f"{name}_params",
        "DEFAULT_PARAMS": f"{name}_default_params",
        "REDUCE": f"{name}_chain",
        "JOINTS": f"{upper}_JOINTS",
    }
    if any(case.model.drives.elastic):
        defines["ELASTIC"] = "1"
    flags = ["-std=gnu99", "-O3", *(f"-D{key}={value}" for key, value in defines.items())]
    sources = [HERE / "chain.c", *sorted((package / "src").glob("*.c"))]
    compiler = os.environ.get("CC", "cc")
    command = [compiler, *flags, f"-I{package / 'include'}", *sources, "-o", program, "-lm"]
    subprocess.run([str(part) for part in command], check=True)
    return program


def reduced(case: Case, program: Path, contact: Contact) -> tuple[float, float, float]:
    """Return the peak [N], seconds to reduce the robot, and to reduce it and simulate."""
    region, approach = contact.region, case.approach
    numbers = [
        STEPS,
        REPEATS,
        region.stiffness,
        region.damping,
        contact.hertz_stiffness,
        approach.speed,
        *approach.direction,
        *approach.q,
        *np.array(case.model.drives.springs).ravel(),
        *np.array(case.model.drives.rotors).ravel(),
    ]
    done = subprocess.run(
        [str(program), *map(repr, map(float, numbers))], text=True, capture_output=True, check=True
    )
    peak, reduce, both, _ = map(float, done.stdout.split())
    return peak, 1e-9 * reduce, 1e-9 * both


def least_seconds(run: Callable[[], object], repeats: int = 15) -> float:
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        run()
        times.append(time.perf_counter() - start)
    return min(times)


def measure(case: Case, folder: Path) -> Measured:
    contact = Contact(body_region("head"))
    program = build(case, folder)

    def impact(fidelity: Fidelity, tolerance: float = 1e-10) -> float:
        history = simulate_impact(
            case.model, case.approach, contact, fidelity, order=3, tolerance=tolerance
        )
        return history.first_contact

    full, chain = impact("full"), impact("chain")
    loose_peak = impact("full", LOOSE)
    seconds = least_seconds(lambda: impact("full"))
    loose = least_seconds(lambda: impact("full", LOOSE))
    peak, reduce, both = reduced(case, program, contact)
    return Measured(
        robot=case.name,
        full_seconds=seconds,
        full_loose_seconds=loose,
        reduction_seconds=reduce,
        reduced_seconds=both,
        ratio=seconds / both,
        ratio_loose=loose / both,
        full_peak=full,
        full_loose_peak=loose_peak,
        chain_peak=chain,
        reduced_peak=peak,
        error_of_integration=peak / chain - 1,
        error_of_reduction=chain / full - 1,
    )


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--json", action="store_true", help="print one JSON object")
    as_json = parser.parse_args().json
    with tempfile.TemporaryDirectory() as folder:
        results = [measure(case, Path(folder)) for case in cases()]
    if as_json:
        print(json.dumps({"target": TARGET, "robots": [asdict(r) for r in results]}))
    else:
        for r in results:
            print(
                f"{r.robot}: full {1e3 * r.full_seconds:.2f} ms "
                f"(loose {1e3 * r.full_loose_seconds:.2f} ms), "
                f"reduced {1e6 * r.reduced_seconds:.2f} µs "
                f"(of which reduction {1e6 * r.reduction_seconds:.2f} µs): "
                f"ratio {r.ratio:.0f} (loose {r.ratio_loose:.0f}, target {TARGET:.0f}); "
                f"peaks {r.full_peak:.1f} full, {r.chain_peak:.1f} chain, "
                f"{r.reduced_peak:.1f} N reduced"
            )
    accurate = all(abs(r.error_of_integration) < ACCURACY for r in results)
    return 0 if accurate and all(r.ratio >= TARGET for r in results) else 1


if __name__ == "__main__":
    sys.exit(main())
