# SPDX-License-Identifier: BSD-3-Clause
"""A bound on a function's instructions that holds for every input, by its longest path.

Blocks and jumps are read from the disassembly of an image, loops are found in them, and each loop's
number of rounds is what its line of C says. A function that steps through time has a budget of
steps for all its runs together: what a step costs is counted apart.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

import numpy as np
from compiled_packages import run
from scipy.sparse import coo_array
from scipy.sparse.csgraph import connected_components

LINE = re.compile(r"^ *([0-9a-f]+):\t(\S+)(?:\t(.*))?$")
NAME = re.compile(r"^([0-9a-f]+) <(.+)>:$")
LOOP = re.compile(r" *(for|while|do|} while)\b")
CONDITIONS = "eq|ne|cs|cc|mi|pl|vs|vc|hi|ls|ge|lt|gt|le"
JUMP = re.compile(rf"^b({CONDITIONS})?(\.[nw])?$")
LEADS_BACK = re.compile(r"^pc\b|\{.*\bpc\b.*\}")
"""Operands that hold the program counter as what is loaded; a constant is loaded from beside it."""
BACK = re.compile(rf"^(bx|pop|ldmia|ldr)({CONDITIONS})?(\.[nw])?$")


@dataclass(frozen=True)
class Budget:
    """Rounds of a loop that all its runs share; each takes some steps of the budget."""

    steps: int = 1


Line = tuple[str, int, str]
"""Source, number and text of a line of C."""

Rounds = float | Budget
"""Rounds of a loop, on average over the times that it is begun."""


@dataclass(frozen=True)
class Cost:
    """Instructions on the longest path, and those of a step of the budget."""

    once: float = 0
    step: float = 0

    def __add__(self, other: Cost) -> Cost:
        return Cost(self.once + other.once, max(self.step, other.step))

    def worse(self, other: Cost) -> Cost:
        """Return what is an upper bound of both."""
        return Cost(max(self.once, other.once), max(self.step, other.step))

    def times(self, rounds: Rounds) -> Cost:
        """Return the cost of some rounds; a budget is for all of them."""
        if isinstance(rounds, Budget):
            return Cost(0, max(self.step, self.once / rounds.steps))
        return Cost(self.once * rounds, self.step)


@dataclass(frozen=True)
class Instruction:
    """One line of a disassembly."""

    address: int
    word: str
    rest: str

    @property
    def target(self) -> int:
        """Address that a jump or call names."""
        found = re.search(r"\b([0-9a-f]+) <", self.rest)
        assert found, self
        return int(found[1], 16)

    @property
    def returns(self) -> bool:
        """Whether it may leave the function for good."""
        found = BACK.match(self.word)
        if not found:
            return False
        return self.rest == "lr" if found[1] == "bx" else bool(LEADS_BACK.search(self.rest))

    @property
    def conditional(self) -> bool:
        """Whether it may do nothing."""
        return bool(re.search(rf"^(b|bx|pop|ldmia|ldr)({CONDITIONS})(\.[nw])?$", self.word))


class LongestPath:
    """Bounds of an image's functions.

    Args:
        image: ELF file with lines (``-g``).
        rounds: of a loop by its line of C, a ``Budget`` for the one that steps through time.
        once: functions that run but once whatever calls them: counted by the caller, not here.
        known: costs of functions without lines.
    """

    def __init__(
        self,
        image: Path,
        rounds: Callable[[str, str], Rounds],
        once: Iterable[str] = (),
        known: Mapping[str, int] | None = None,
    ) -> None:
        self.image, self.rounds = image, rounds
        self.once, self.known = frozenset(once), dict(known or {})
        self.done: dict[str, Cost] = {}

    @cached_property
    def functions(self) -> dict[str, list[Instruction]]:
        """Instructions of each function, without constants."""
        found: dict[str, list[Instruction]] = {}
        here: list[Instruction] = []
        said = run("arm-none-eabi-objdump", "-d", "--no-show-raw-insn", self.image)
        for line in said.splitlines():
            if name := NAME.match(line):
                here = found.setdefault(name[2], [])
            elif (at := LINE.match(line)) and not at[2].startswith("."):
                here.append(Instruction(int(at[1], 16), at[2], (at[3] or "").split(" @")[0]))
        return found

    @cached_property
    def names(self) -> dict[int, str]:
        """Names of functions by their addresses."""
        return {body[0].address: name for name, body in self.functions.items() if body}

    def line_of(self, address: int, inside: Collection[Line]) -> Line:
        """Return source, number and text of the line that begins the loop an address belongs to.

        It may be in a function without a loop that was inlined into one with it. A jump back to
        the start of a loop may be told to be of another one inside it, which is passed over.
        """
        said = run("arm-none-eabi-addr2line", "-i", "-e", self.image, hex(address))
        for frame in said.splitlines():
            file, _, number = frame.split(" ")[0].rpartition(":")
            assert number.isdigit(), (hex(address), said)
            lines = Path(file).read_text().splitlines()
            at = int(number) - 1
            indent = len(lines[at]) - len(lines[at].lstrip()) + 1
            while not lines[at].startswith("{"):
                here = len(lines[at]) - len(lines[at].lstrip())
                if LOOP.match(lines[at]) and here < indent:
                    line = Path(file).name, at + 1, lines[at].strip()
                    if line not in inside:
                        return line
                    indent = here
                at -= 1
        assert inside, (hex(address), said)
        return self.line_of(address, ())  # one loop of C that has become two

    def of(self, name: str) -> Cost:
        """Return the bound of a function, what it calls included."""
        if name in self.known:
            return Cost(self.known[name])
        if name not in self.done:
            self.done[name] = self._longest(name)
        return self.done[name]

    def _called(self, target: int) -> Cost:
        name = self.names[target & ~1]
        return Cost() if name in self.once else self.of(name)

    def _longest(self, name: str) -> Cost:
        body = self.functions[name]
        inside = {i.address for i in body}
        cost: dict[int, Cost] = {}
        after: dict[int, set[int]] = defaultdict(set)
        for i, following in zip(body, [*body[1:], None], strict=True):
            own, goes_on = Cost(1), True
            if i.word in ("bl", "blx"):
                own += self._called(i.target)
            elif JUMP.match(i.word) or i.word in ("cbz", "cbnz"):
                goes_on = i.conditional or i.word in ("cbz", "cbnz")
                if i.target in inside:
                    after[i.address].add(i.target)
                else:
                    own += self._called(i.target)
            elif i.returns:
                goes_on = i.conditional
            else:
                assert not i.word.startswith(("tbb", "tbh", "bx")), (name, i)
            cost[i.address] = own
            if goes_on and following:
                after[i.address].add(following.address)
        try:
            return _Graph(cost, after, self._rounds_of).longest(body[0].address)
        except AssertionError as e:
            raise AssertionError(name, *e.args) from e

    def _rounds_of(
        self, latches: Iterable[int], inside: Collection[Line]
    ) -> tuple[Rounds, set[Line]]:
        """Return the rounds of a loop by the jumps back to its start, and its lines.

        Of two with one start it is both's.
        """
        product, lines = 1.0, {self.line_of(latch, inside) for latch in latches}
        for file, _, line in sorted(lines):
            found = self.rounds(file, line)
            if isinstance(found, Budget):
                return found, lines
            product *= found
        return product, lines


class _Graph:
    """Instructions, what each costs and which may follow; loops become single ones."""

    def __init__(
        self,
        cost: dict[int, Cost],
        after: dict[int, set[int]],
        rounds: Callable[[Iterable[int], Collection[Line]], tuple[Rounds, set[Line]]],
    ) -> None:
        self.cost, self.after, self.rounds = cost, after, rounds
        self.lines: dict[int, set[Line]] = defaultdict(set)  # of loops that became an instruction

        self.home: dict[int, int] = {}  # what has become of an instruction

    def longest(self, start: int) -> Cost:
        """Return the longest path, loops taken as often as they may."""
        self._straighten(set(self.cost), {start})
        return self._paths(set(self.cost))[self.home.get(start, start)]

    def _straighten(self, nodes: set[int], entries: set[int]) -> None:
        """Collapse all loops among some nodes."""
        for loop in _circles(nodes, self.after):
            before = {a for a in self.cost if a not in loop and self.after[a] & loop}
            doors = {to for a in before for to in self.after[a] & loop} | (entries & loop)
            header = min(doors, key=lambda door: (self._left(loop, door), door))
            latches = {a for a in loop if header in self.after[a]}
            for a in latches:
                self.after[a].discard(header)
            self._straighten(set(loop), doors)
            doors = {self.home.get(door, door) for door in doors}
            inside = {a for a in loop if a in self.cost}
            leaving = {to for a in inside for to in self.after[a]} - inside
            paths, once, last = self._paths(inside), Cost(), Cost()
            for door in doors:
                once, last = once.worse(paths[door]), last.worse(self._test(door, inside))
            if all(self.after[self.home.get(a, a)] - inside for a in latches):
                last = Cost()  # it is asked at the end whether there is another round
            within = set[Line]().union(*(self.lines[a] for a in inside))
            rounds, lines = self.rounds(latches, within)
            self.lines[header] |= within | lines
            total = once.times(rounds) + last
            for a in loop:
                self.home[a] = header
            for a, home in self.home.items():
                self.home[a] = header if home in inside else home
            for a in inside - {header}:
                del self.cost[a], self.after[a]
            self.cost[header], self.after[header] = total, leaving - {header}
            for to in self.after.values():
                moved = to & (loop - {header})
                to.difference_update(moved)
                to.update({header} if moved else ())
            self.after[header].discard(header)

    def _test(self, door: int, inside: set[int]) -> Cost:
        """Return the cost of a loop's start as far as nothing but leaving it is decided there."""
        cost, at = Cost(), door
        while True:
            cost += self.cost[at]
            on = self.after[at] & inside
            if len(on) != 1:
                return cost
            at = on.pop()

    def _left(self, loop: set[int], door: int) -> int:
        """Return how many nodes are in loops still when a loop is opened at a door."""
        cut = {a: self.after[a] - {door} for a in loop}
        return sum(len(circle) for circle in _circles(loop, cut))

    def _paths(self, within: set[int]) -> dict[int, Cost]:
        """Return the longest path from each of some nodes, among which there is no loop."""
        best: dict[int, Cost] = {}
        for first in within:
            stack = [first]
            while stack:
                at = stack[-1]
                waiting = [to for to in self.after[at] if to in within and to not in best]
                if waiting and at not in best:
                    stack += waiting
                    continue
                stack.pop()
                rest = Cost()
                for to in self.after[at] & within:
                    rest = rest.worse(best[to])
                best[at] = self.cost[at] + rest
        return best


def _circles(nodes: set[int], after: Mapping[int, set[int]]) -> list[set[int]]:
    """Return the sets of nodes that reach each other and themselves."""
    at = {node: k for k, node in enumerate(sorted(nodes))}
    pairs = [(at[a], at[to]) for a in nodes for to in after[a] if to in nodes]
    if not pairs:
        return []
    rows, columns = zip(*pairs, strict=True)
    graph = coo_array((np.ones(len(pairs)), (rows, columns)), shape=(len(at), len(at)))
    count, labels = connected_components(graph, connection="strong")
    circles: list[set[int]] = [set() for _ in range(count)]
    for node, k in at.items():
        circles[labels[k]].add(node)
    return [c for c in circles if len(c) > 1 or any(a in after[a] for a in c)]
