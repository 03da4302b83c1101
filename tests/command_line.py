# SPDX-License-Identifier: BSD-3-Clause
"""The command line, run within the test's process."""

from __future__ import annotations

import contextlib
import io
import json
import re
from dataclasses import dataclass
from typing import Any

from softimpact.cli import main

PROGRESS = re.compile(r"^[^\n]*: \d+( of \d+)?, \d+ s\n", re.MULTILINE)
"""A line that commands say on the way once they take ten seconds, as all may on a busy machine."""


@dataclass(frozen=True)
class Outcome:
    """What a command left behind."""

    code: int
    out: str
    err: str


def run(*arguments: object) -> Outcome:
    """Run ``softimpact`` with arguments."""
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        code = main([str(argument) for argument in arguments])
    return Outcome(code, out.getvalue(), err.getvalue())


def run_json(*arguments: object) -> dict[str, Any]:
    """Run a command with ``--json``; return its one object. NaN and Infinity are not JSON.

    What stderr says stands in the object's warnings, but for progress.
    """
    outcome = run(*arguments, "--json")
    assert outcome.code == 0, outcome
    assert outcome.out.count("\n") == 1

    def not_json(constant: str) -> None:
        raise AssertionError(f"{constant} in JSON")

    result = json.loads(outcome.out, parse_constant=not_json)
    assert isinstance(result, dict)
    warned = [f"warning: {line}\n" for line in result.get("warnings", [])]
    assert PROGRESS.sub("", outcome.err) == "".join(warned)
    return result


def refusal(*arguments: object) -> str:
    """Run a command that must be refused; return its message.

    Exit code 2, one line on stderr, nothing on stdout.
    """
    outcome = run(*arguments)
    assert outcome.code == 2, outcome
    assert outcome.out == ""
    said = PROGRESS.sub("", outcome.err)
    assert said.startswith("error: ")
    assert said.count("\n") == 1
    assert said.endswith("\n")
    return said
