# SPDX-License-Identifier: BSD-3-Clause
"""Commands on consoles that lack letters: every result is printed, also through a pipe."""

from __future__ import annotations

import io
import sys
from pathlib import Path

import pytest
from command_line import run

from softimpact.cli import main
from softimpact.console import PLAIN, accept_any_console

ROOT = Path(__file__).resolve().parents[2]
COMBINING = {"\N{COMBINING DOT ABOVE}", "\N{COMBINING DIAERESIS}"}

Q = ("panda", "--q", "[0, 0.3, 0, -2, 0, 2, 0.8]", "--direction", "[0, 1, 0]")
COMMANDS = {
    "robots": ("robots",),
    "analyze": ("analyze", *Q, "--joint-stiffness", "1e4"),
    "factors": ("factors", *Q),
    "dashes": ("factors", "rr", "--q", "0.3,0.2,0.1,0.2", "--direction", "1,0,0"),
    "init": ("init", "ur5e"),
    "check": ("check", "mårvin→θ̇.toml"),
    "help": ("simulate", "--help"),
    "refusal": ("analyze", "mårvin→θ̇", *Q[1:]),
}


def printed(encoding: str, command: tuple[str, ...], monkeypatch: pytest.MonkeyPatch) -> str:
    """Run a command on a console of an encoding; return what it printed."""
    raw = io.BytesIO()
    console = io.TextIOWrapper(raw, encoding=encoding, errors="strict")
    for name in ("stdout", "stderr"):
        monkeypatch.setattr(sys, name, console)
    assert main(command) in (0, 2)
    console.flush()
    return raw.getvalue().decode(encoding)


@pytest.mark.parametrize("encoding", ["cp1252", "cp437", "ascii"])
@pytest.mark.parametrize("command", COMMANDS.values(), ids=COMMANDS)
def test_any_console_prints_every_result(
    encoding: str, command: tuple[str, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    text = printed(encoding, command, monkeypatch)
    assert text
    assert "?" not in text


def test_what_a_console_lacks_is_spelled(monkeypatch: pytest.MonkeyPatch) -> None:
    assert "marvin->theta" in printed("ascii", COMMANDS["refusal"], monkeypatch)
    analysis = printed("cp1252", COMMANDS["analyze"], monkeypatch)
    assert "Lambda_F" in analysis
    assert "Λ" not in analysis


def test_a_console_that_knows_the_letters_gets_them(monkeypatch: pytest.MonkeyPatch) -> None:
    assert "Λ_F" in printed("utf-8", COMMANDS["analyze"], monkeypatch)


def test_every_letter_of_ours_can_be_spelled() -> None:
    accept_any_console()
    folders = (ROOT / name for name in ("symbolic", "simulate", "optimize", "studio", "papers"))
    text = "".join(p.read_text("utf-8") for folder in folders for p in folder.rglob("*.py"))
    used = {character for character in text if not character.isascii()}
    assert {c for c in used if c.encode("ascii", PLAIN) in (b"?", b"")} <= COMBINING


def test_what_nobody_can_spell_does_no_harm() -> None:
    accept_any_console()
    assert "手 \udc80".encode("ascii", PLAIN) == b"? ?"


@pytest.mark.parametrize("command", ["robots", "analyze", "factors"])
def test_a_pipe_gets_lines_of_80_columns(command: str) -> None:
    outcome = run(*COMMANDS[command])
    assert (outcome.code, outcome.err) == (0, "")
    assert max(map(len, outcome.out.splitlines())) <= 80
