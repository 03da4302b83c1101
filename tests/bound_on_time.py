# SPDX-License-Identifier: BSD-3-Clause
"""How many instructions a safe speed of driven motors takes at most, whatever its inputs.

The longest path through the compiled code, see ``longest_path``. Rounds of loops are what their C
says; those of a loop within a loop, whose ends hang on each other, are the mean over all times it
begins, so that their sum is right.
"""

from __future__ import annotations

import re
from math import ceil
from pathlib import Path

from compiled_packages import Generated
from longest_path import Budget, LongestPath, Rounds

STEPS_OF_RUN = 7
"""ROBOT_STEPS_OF_RUN of the runtime."""

ITERATIONS, LEVELS = 3, 7
"""Of ``robot_contact.c`` and ``robot_impact.h``."""

LIBRARY = {"memcpy": 60, "memset": 60, "cbrtf": 45, "expf": 80, "sinf": 600, "cosf": 600}
"""Instructions of the C library's functions, above what was ever counted."""

NEVER = (
    *("damp", "damp_ahead", "damping_rate", "servo_modes", "pass", "two_body_force", "law_press"),
    *("force_between", "slip_off", "owed_slip", "slowing"),
)
"""Functions of servos, of what presses late, of peak forces and of other laws than Hertz's."""


def bound_of_driven_safe_speed(package: Generated, image: Path, steps: int) -> int | None:
    """Return the bound for Hertz's law; None for robots whose modes are found in another way.

    Args:
        package: with springs in all joints, without gravity and the joints' own damping.
        image: of its float build, with lines.
        steps: budget.
    """
    name, n = package.manifest.name, package.robot.n
    internal = (package.folder / f"src/{name}_internal.h").read_text()
    header = f"_ELASTIC 1 .*\\n#define {name.upper()}_POTENTIAL 0 "
    if not re.search(header, internal) or package.robot.loops:
        return None
    if package.robot.damping.any():  # `damp`, which is not counted here, is for servos alone
        return None
    known = {f"{name}_{function}": 0 for function in NEVER}
    known |= {f"{name}_law_twice_work": 80, f"{name}_law_stiffness": 75, f"{name}_law_is_one": 12}
    # no square root is of a negative number, for which the library is asked
    known |= LIBRARY | {"piece_of": 0, "piece_of.isra.0": 0, "sqrtf": 0}
    once = (f"{name}_impact_let_go",)
    paths = LongestPath(image, lambda file, line: rounds(f"{file} {line}", name, n), once, known)
    whole, loose = paths.of(f"{name}_safe_speed"), paths.of(once[0])
    return ceil(whole.once + loose.once + steps * max(whole.step, loose.step))


def rounds(line: str, name: str, n: int) -> Rounds:
    """Return the rounds of a loop by its source and line."""
    rows, squares = sum(range(2, n)), sum(m * m for m in range(2, n))
    qr_steps, qr_turns = 2 * n + 2, n * (n + 2)  # MOST_QR, MOST_ROTATIONS
    # the step whose rotations have no room is done before it fails
    turned = (qr_turns + n - 1) / (qr_steps + 1)
    N, modes = name.upper(), n + 2  # one of links and rotors together, one of the body
    table: list[tuple[str, Rounds]] = [
        (r"ticks > 0", Budget()),
        (r"sines.*(while \(more|k = doubled)", 25),  # doublings, of a float
        (r"k < TRIALS", Budget(STEPS_OF_RUN)),
        (r"k < SHARES", Budget(STEPS_OF_RUN)),
        (r"motors >= first", 1),
        (r"step <= most", qr_steps + 1),
        (r"spectrum.*last > 0", n / (qr_steps + 1)),
        (r"spectrum.*first > 0", n - 2),
        (r"spectrum.*k = (first; k < last|last - 1; k >= first)", turned),
        (r"internal\.h.*< count", 4 + 2 * n),  # numbers of a body and of drives
        (r"spectrum.*step (< turns->steps|>= 0)", qr_steps),
        (r"spectrum.*m < count", 1),
        (r"spectrum.*k \+ 1 < size", n - 1),
        (r"spectrum.*k (\+ 2 < |= ).*_N", n - 2),
        (r"spectrum.*i = k \+ 1", n / 2),
        (r"spectrum.*i = k \+ 2", (n - 2) / 2),
        (r"spectrum.*i = first; i < size", rows / (n - 1)),
        (r"spectrum.*i = first; i < .*_N", rows / (n - 2)),
        (r"spectrum.*j = first; j < size", squares / rows),
        (r"spectrum.*j = first; j <= i", (squares + rows) / 2 / rows),
        (r"spectrum.*k = size - 3", n - 2),
        (r"spectrum.*i = next \+ 1", (n - 1) / 2),
        (r"spectrum.*j = next \+ 1", (2 * n - 3) / 3),
        (r"compliance.*m = l \+ 1", (n - 1) / 3),
        (r"compliance.*m = i \+ 1", (n - 1) / 2),
        (r"compliance.*l <= j", (n + 2) / 3),
        (r"compliance.*(l = i; l >= 0)", (n + 1) / 2),
        (r"compliance.*i = end", n),
        (r"(j|l) <= i|l = i; l <", (n + 1) / 2),
        (r"links\.c .*i < \d", n),
        (r"linear.*(i = j \+ 1|k < [ij];|k = i \+ 1)", (n - 1) / 2),
        (r"ITERATIONS", ITERATIONS),
        (rf"{N}_LEVELS", LEVELS),
        (r"level < shortest", LEVELS - 1),
        (rf"{N}_SYSTEM", 2 * n),
        (rf"{N}_(N|DAMPERS)\b|< count|< size|size - 1", n),
        (rf"{N}_REACH|l <= k", 3),
        (r"end < 2", 2),
        (r"< modes->rigid", 1),
        (r"active|own|body|count", modes),
    ]
    for pattern, found in table:
        if re.search(pattern, line):
            return found
    raise AssertionError(f"a loop whose rounds are not known: {line}")
