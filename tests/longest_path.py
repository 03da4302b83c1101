# SPDX-License-Identifier: BSD-3-Clause
"""A bound on a function's instructions that holds for every input, by its longest path.

Blocks and jumps are read from the disassembly of an image, loops are found in them, and each loop's
number of rounds is what its line of C says. A function that steps through time has a budget of
steps for all its runs together: what a step costs is counted apart.
"""

from __future__ import annotations

import re
from collections import defaultdict
from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from compiled_packages import run

LINE = re.compile(r"^ *([0-9a-f]+):\t(\S+)(?:\t(.*))?$")
NAME = re.compile(r"^([0-9a-f]+) <(.+)>:$")
LOOP = re.compile(r" *(for|while|do|} while)\b")
CONDITIONS = "eq|ne|cs|cc|mi|pl|vs|vc|hi|ls|ge|lt|gt|le"
JUMP = re.compile(rf"^b({CONDITIONS})?(\.[nw])?$")
BACK = re.compile(rf"^(bx|pop|ldmia|ldr)({CONDITIONS})?(\.[nw])?$")

BUDGET = -1
"""Rounds of the loop whose budget all runs share."""


@dataclass(frozen=True)
class Cost:
    """Instructions on the longest path, and those of a step of the budget."""

    once: int = 0
    step: int = 0

    def __add__(self, other: Cost) -> Cost:
        return Cost(self.once + other.once, max(self.step, other.step))

    def worse(self, other: Cost) -> Cost:
        """Return what is an upper bound of both."""
        return Cost(max(self.once, other.once), max(self.step, other.step))

    def times(self, rounds: int) -> Cost:
        """Return the cost of some rounds; a budget is for all of them."""
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
        return bool(found) and (self.rest == "lr" if found[1] == "bx" else "pc" in self.rest)

    @property
    def conditional(self) -> bool:
        """Whether it may do nothing."""
        return bool(re.search(rf"^(b|bx|pop|ldmia|ldr)({CONDITIONS})(\.[nw])?$", self.word))


class LongestPath:
    """Bounds of an image's functions.

    Args:
        image: ELF file with lines (``-g``).
        rounds: of a loop by its line of C, ``BUDGET`` for the one that steps through time.
        once: functions that run but once whatever calls them: counted by the caller, not here.
        known: costs of functions without lines.
    """

    def __init__(
        self,
        image: Path,
        rounds: Callable[[str, str], int],
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

    def line_of(self, address: int) -> tuple[str, str]:
        """Return the source's name and the line that begins the loop an address belongs to."""
        said = run("arm-none-eabi-addr2line", "-e", self.image, hex(address)).split(" ")[0].strip()
        file, _, number = said.rpartition(":")
        assert number.isdigit(), (hex(address), said)
        lines = Path(file).read_text().splitlines()
        at = int(number) - 1
        indent = len(lines[at]) - len(lines[at].lstrip()) + 1
        while not (LOOP.match(lines[at]) and len(lines[at]) - len(lines[at].lstrip()) < indent):
            at -= 1
        return Path(file).name, lines[at].strip()

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
        return _Graph(body[0].address, cost, after, self._rounds_of).longest()

    def _rounds_of(self, latches: Iterable[int]) -> int:
        """Return the rounds of a loop, by the lines of the jumps back to its start."""
        return max(self.rounds(*self.line_of(latch)) for latch in latches)


class _Graph:
    """Blocks of one instruction each."""

    def __init__(
        self,
        start: int,
        cost: dict[int, Cost],
        after: dict[int, set[int]],
        rounds: Callable[[Iterable[int]], int],
    ) -> None:
        self.start, self.cost, self.after, self.rounds = start, cost, after, rounds
        self.group = {at: at for at in cost}

    def longest(self) -> Cost:
        """Return the longest path, loops taken as often as they may."""
        for header, (latches, body) in sorted(self._loops().items(), key=lambda x: len(x[1][1])):
            self._collapse(header, latches, body)
        return self._path(self.start, self._reached())

    def _reached(self) -> set[int]:
        seen, waiting = set[int](), [self.start]
        while waiting:
            at = waiting.pop()
            if at not in seen:
                seen.add(at)
                waiting += self.after[at]
        return seen

    def _loops(self) -> dict[int, tuple[set[int], set[int]]]:
        """Return the jumps back to each loop's start, and all that lies between."""
        order, state, back = [], dict[int, int](), set[tuple[int, int]]()
        stack = [(self.start, iter(sorted(self.after[self.start])))]
        state[self.start] = 1
        while stack:
            at, rest = stack[-1]
            for to in rest:
                if to not in state:
                    state[to] = 1
                    stack.append((to, iter(sorted(self.after[to]))))
                    break
                if state[to] == 1:
                    back.add((at, to))
            else:
                state[at] = 2
                order.append(at)
                stack.pop()
        before: dict[int, set[int]] = defaultdict(set)
        for at in state:
            for to in self.after[at]:
                before[to].add(at)
        loops: dict[int, tuple[set[int], set[int]]] = {}
        for latch, header in back:
            latches, body = loops.setdefault(header, (set(), {header}))
            latches.add(latch)
            waiting = [latch]
            while waiting:
                at = waiting.pop()
                if at not in body:
                    assert at != self.start or header == self.start, "a loop with two entries"
                    body.add(at)
                    waiting += before[at]
        return loops

    def _collapse(self, header: int, latches: set[int], body: set[int]) -> None:
        inside = {self.group[at] for at in body}
        for at in inside:
            self.after[at].discard(header)
        round_ = Cost()
        for at in inside:
            round_ = round_.worse(self._path(header, inside, at))
        rounds = self.rounds(latches)
        last = round_
        total = Cost(last.once, round_.once) if rounds == BUDGET else round_.times(rounds) + last
        leaving = {to for at in inside for to in self.after[at]} - inside
        for at, group in self.group.items():
            if group in inside:
                self.group[at] = header
        for at in inside - {header}:
            del self.cost[at], self.after[at]
        self.cost[header], self.after[header] = total, leaving
        for at, to in self.after.items():
            self.after[at] = {self.group[t] for t in to} - {at}

    def _path(self, start: int, within: set[int], end: int | None = None) -> Cost:
        """Return the longest path from a start, to an end or to where it goes no further."""
        best: dict[int, Cost] = {}
        stack = [start]
        while stack:
            at = stack[-1]
            waiting = [to for to in self.after[at] if to in within and to not in best]
            if waiting and at not in best:
                stack += waiting
                assert len(stack) < 10**6, "a loop is left"
                continue
            stack.pop()
            if at not in best:
                rest = Cost()
                for to in self.after[at]:
                    if to in within:
                        rest = rest.worse(best[to])
                best[at] = self.cost[at] + rest
        return best[start]
