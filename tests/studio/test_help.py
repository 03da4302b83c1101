# SPDX-License-Identifier: BSD-3-Clause
"""Help shows what the options say: Rich takes words in square brackets for styles."""

from __future__ import annotations

import pytest
import typer
from command_line import run

from softimpact.cli import app


def test_help_is_printed_whole(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "400")
    group = typer.main.get_command(app)
    assert isinstance(group, typer.core.TyperGroup)
    for name, command in group.commands.items():
        printed = " ".join(run(name, "--help").out.split())
        for option in command.params:
            text = getattr(option, "help", None) or ""
            assert " ".join(text.split()) in printed, (name, option.name)
