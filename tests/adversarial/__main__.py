# SPDX-License-Identifier: BSD-3-Clause
"""Look for safe speeds that are none: random and hill-climbed inputs against the tests' integrator.

Usage: PYTHONPATH=tests python -m adversarial [--inputs N] [--questions NAME ...] [--workers N]
           [--journal FILE] [--record] [ROBOT ...]

Each round puts one question (``questions.py``) to one robot and build, of ``COUNT`` random inputs,
and climbs ``TURNS`` times from the ``CLIMBS`` worst of them; drives and bodies are those there are,
or (wide) of many decades. The speed answered and slower ones of each input are integrated
(``oracle/``), those that come near the limit once more in finer steps. Rounds that are done stand
in the journal, with a digest of what they looked at: started again, the search goes on.
``--record`` writes all of those that looked at packages as they are, with ``--inputs 0`` without
more. Ends with 1 if a force exceeds its limit.
"""

from __future__ import annotations

import argparse
import hashlib
import json
import sys
import tempfile
import time
from collections.abc import Mapping
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict
from functools import cache
from pathlib import Path
from random import Random
from typing import Any

from compiled_packages import KINDS, Generated

from .impacts import Robot
from .questions import QUESTIONS
from .record import Rows, summed, write
from .robots import CLOSED, ROBOTS, package_of
from .search import TURNS, Found, look

COUNT, CLIMBS = 2000, 50
"""Of a round: random inputs, and climbs."""

WIDTHS = ("plain", "wide")
"""Of what is drawn: what arms and bodies have, or many decades."""

KEYS = ("question", "robot", "real", "wide", "seed", "of")
"""What tells a round from others."""

HERE = Path(__file__).parent


@cache
def packages(root: Path) -> dict[str, Generated]:
    """Return the packages of a search, which its processes share."""
    return {}


@cache
def robot_of(root: Path, name: str) -> Robot:
    """Return a robot of this process."""
    made = packages(root)
    return Robot(made[name], root / "oracle")


def prepare(root: Path, made: Mapping[str, Generated]) -> None:
    """Tell a process the packages."""
    packages(root).update(made)


def digest(package: Generated) -> str:
    """Return what changes with the package or with the search."""
    files = [
        *package.folder.glob("src/*"),
        *package.folder.glob("include/*"),
        *HERE.glob("*.py"),
        *HERE.glob("oracle/*"),
    ]
    texts = (path.read_bytes() for path in sorted(files) if path.is_file())
    return hashlib.sha256(b"\0".join(texts)).hexdigest()[:16]


def round_of(root: Path, job: Mapping[str, Any]) -> Found:
    """Do one round."""
    question = QUESTIONS[job["question"]]
    count, climbs = (int(number * question.share) for number in (COUNT, CLIMBS))
    asked = {"wide": job["wide"], "question": question}
    return look(robot_of(root, job["robot"]), job["real"], job["seed"], count, climbs, **asked)


def size(question: str) -> int:
    """Return the number of inputs of a round."""
    share = QUESTIONS[question].share
    return int(COUNT * share) + int(CLIMBS * share) * TURNS


def main() -> int:
    """Search, and say what was found."""
    parser = argparse.ArgumentParser(description=str(__doc__).split("\n", maxsplit=1)[0])
    parser.add_argument("robots", nargs="*", default=[*ROBOTS], metavar="ROBOT")
    parser.add_argument("--inputs", type=int, default=1_000_000)
    parser.add_argument("--widths", nargs="+", choices=WIDTHS, default=WIDTHS)
    parser.add_argument("--questions", nargs="+", choices=QUESTIONS, default=[*QUESTIONS])
    parser.add_argument("--seed", type=int, default=1, help="of the first round")
    parser.add_argument("--workers", type=int, default=2)
    parser.add_argument("--journal", type=Path, default=Path("results/adversarial.jsonl"))
    parser.add_argument("--record", action="store_true", help="what was found in packages and docs")
    told = parser.parse_args()
    widths = [width == "wide" for width in told.widths]
    kinds = [
        (question, name, real, wide)
        for question in told.questions
        for name in told.robots
        for real in KINDS
        for wide in widths
        if not (QUESTIONS[question].elsewhere and name in CLOSED)
    ]
    rounds = -(-told.inputs // sum(size(question) for question, *_ in kinds))
    told.journal.parent.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder)
        (root / "oracle").mkdir()
        made = {name: package_of(name, root / name) for name in told.robots}
        for package in made.values():
            for real in KINDS:
                package.load(real)
        digests = {name: digest(package) for name, package in made.items()}
        asked = [
            {"question": question, "robot": name, "real": real, "wide": wide,
             "seed": told.seed + k, "of": digests[name]}
            for k in range(rounds)
            for question, name, real, wide in kinds
        ]  # fmt: skip
        Random(told.seed).shuffle(asked)  # so that a search that is ended has looked at all
        done = read(told.journal)
        left = [job for job in asked if key(job) not in done]
        print(f"{len(asked)} rounds, {len(asked) - len(left)} done before", flush=True)
        start, found = time.monotonic(), dict(done)
        with (
            ProcessPoolExecutor(told.workers, initializer=prepare, initargs=(root, made)) as pool,
            told.journal.open("a", encoding="utf-8") as journal,
        ):
            futures = {pool.submit(round_of, root, job): job for job in left}
            for n, future in enumerate(as_completed(futures), 1):
                job, result = futures[future], asdict(future.result())
                journal.write(json.dumps({**job, "found": result}) + "\n")
                journal.flush()
                found[key(job)] = result
                rest = (time.monotonic() - start) / n * (len(left) - n)
                say(job, result, f"{n}/{len(left)}, {rest / 60:.0f} min left")
    if told.record:
        rounds = of_now(found, digests)
        if not rounds:
            parser.error(f"{told.journal} holds no round of these packages and this search")
        write(rounds)
    return conclude([(job, found[key(job)]) for job in asked])


def key(job: Mapping[str, Any]) -> str:
    """Return what tells a round from others."""
    return json.dumps([job[name] for name in KEYS])


def of_now(found: Mapping[str, Mapping[str, Any]], digests: Mapping[str, str]) -> Rows:
    """Return all rounds of a journal that looked at packages as they are."""
    rounds = [(dict(zip(KEYS, json.loads(key), strict=True)), what) for key, what in found.items()]
    return [(job, what) for job, what in rounds if digests.get(job["robot"]) == job["of"]]


def read(journal: Path) -> dict[str, dict[str, Any]]:
    """Return the rounds that are done."""
    lines = journal.read_text(encoding="utf-8").splitlines() if journal.exists() else []
    rows = [json.loads(line) for line in lines if line.endswith("}")]
    return {key(row): row["found"] for row in rows}


def say(job: Mapping[str, Any], found: Mapping[str, Any], progress: str) -> None:
    """Print a line about a round, and what exceeds its limit."""
    width = "wide" if job["wide"] else "plain"
    print(
        f"{progress}: {job['question']}, {job['robot']}, {job['real']}, {width}, "
        f"seed {job['seed']}: "
        f"{found['inputs']} inputs, {found['answered']} answered ({found['bounded']} by a bound), "
        f"worst {found['worst']:.5f} of the limit, slower {found['below']:.5f}, "
        f"{found['slower']:.5f} of the force at the safe speed",
        flush=True,
    )
    if found["above"]:
        print(f"  {found['above']} ABOVE, such as {found['hardest'][0]}", flush=True)


def conclude(rows: Rows) -> int:
    """Print the sums of questions; return 1 if a force exceeds its limit."""
    sums = summed(rows)
    for (question, width), total in sums.items():
        print(
            f"{question}, {width}: {total.inputs} inputs, {total.answered} answered "
            f"({total.bounded} by a bound), {total.integrated} impacts, {total.above} above; "
            f"worst {total.worst:.5f}, slower {total.below:.5f}, {total.slower:.5f} of the force "
            "at the answer"
        )
    return int(any(total.above for total in sums.values()))


if __name__ == "__main__":
    sys.exit(main())
