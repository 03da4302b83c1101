# SPDX-License-Identifier: BSD-3-Clause
"""What every command has: tables as CSV, ``--verbose``, a sign of life, the name that was meant."""

from __future__ import annotations

import csv
import io
import logging
import time
from dataclasses import dataclass
from typing import Annotated

import pytest
import typer
from command_line import refusal, run, run_json

from softimpact.cli import app
from softimpact.studio.commands.common import common
from softimpact.studio.output.printed import folded, print_table, say, shown, tables_as_csv
from softimpact.studio.output.progress import working
from softimpact.studio.typed.groups import But

COMMANDS = {command.name or "": command for command in app.registered_commands}
ANALYZE = ("analyze", "rr", "--q", "[0.1, 0, 0.4, 0]", "--direction", "[1, 0, 0]")


def tables(text: str) -> dict[str, list[list[str]]]:
    """Return CSV tables by their titles."""
    blocks = [block.split("\n", 1) for block in text.strip().split("\n\n")]
    assert all(title.startswith("# ") for title, _ in blocks)
    return {title[2:]: list(csv.reader(io.StringIO(rows))) for title, rows in blocks}


def test_tables_are_csv_with_numbers_in_full() -> None:
    found = run(*ANALYZE, "--csv")
    assert found.code == 0
    assert found.err == ""
    numbers = run_json(*ANALYZE)
    met = tables(found.out)["What the impact meets"]
    assert met[0] == ["quantity", "value", "unit"]
    values = {name: value for name, value, _ in met[1:]}
    assert float(values["mass felt at the contact point, m_c"]) == numbers["m_c"]
    assert values["GIAF along the direction"] == ""
    assert numbers["directional_giaf"] is None


def test_csv_is_quoted_and_one_line_a_row(capsys: pytest.CaptureFixture[str]) -> None:
    with tables_as_csv(True):
        print_table("a\nb", ("x,\ny", "z"), [("two\nlines", 1 / 3), (None, float("inf"))])
        say("done")
    out, err = capsys.readouterr()
    assert out == f'# a b\n"x, y",z\ntwo lines,{1 / 3!r}\n,\n\n'
    assert err == "done\n"
    say("done")
    assert capsys.readouterr().out == "done\n"


def test_points_are_folded_for_people_alone() -> None:
    assert folded("link@0,0,1") == "link\n@0,0,1"
    with tables_as_csv(True):
        assert folded("link@0,0,1") == "link@0,0,1"


def test_csv_and_json_exclude_each_other() -> None:
    assert refusal(*ANALYZE, "--csv", "--json") == "error: csv: excludes json; give one of them\n"


def test_every_command_has_them() -> None:
    group = typer.main.get_command(app)
    for name, command in getattr(group, "commands", {}).items():
        options = {option for parameter in command.params for option in parameter.opts}
        assert {"--csv", "--verbose", "-v"} <= options, name
    assert {"--install-completion", "--show-completion"} <= {
        option for parameter in group.params for option in parameter.opts
    }


def test_verbose_says_what_is_done_and_leaves_no_trace() -> None:
    before = list(logging.getLogger("softimpact").handlers)
    found = run(*ANALYZE, "-v")
    assert found.out == run(*ANALYZE).out
    first, *_, last = found.err.splitlines()
    assert first.endswith("rr.xml")
    assert " read " in first
    assert "analyze took" in last
    assert logging.getLogger("softimpact").handlers == before


def test_a_terminal_sees_that_a_command_is_at_work(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr("softimpact.studio.output.progress.PATIENCE", 0.0)
    with working("simulating"):
        time.sleep(0.05)
    assert capsys.readouterr().err == ""  # no terminal
    monkeypatch.setenv("FORCE_COLOR", "1")
    with working(None):
        pass
    assert capsys.readouterr().err == ""
    with working("simulating"):
        time.sleep(0.05)
    assert "simulating" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("words", "meant"),
    [
        (("analyze", "pnda", "--q", "0", "--direction", "[1,0,0]"), "panda"),
        ((*ANALYZE, "--tip", "o3"), "O3"),
        ((*ANALYZE, "--lock", "q_1=0"), "q1"),
        ((*ANALYZE, "--motors", "drivn"), "driven"),
        (("simulate", *ANALYZE[1:], "--region", "chset", "--speed", "1"), "chest"),
        (("simulate", *ANALYZE[1:], "--region", "chest", "--model", "linearized"), "linearised"),
        (("select", "robots/studies/panda_24_poses.toml", "--by", "gaif"), "giaf"),
        (("check", "panda_24_pose"), "panda_24_poses"),
        (("studio", "robust_pand", "--out", "page"), "robust_panda"),
    ],
    ids=lambda case: case if isinstance(case, str) else case[0],
)
def test_errors_show_the_name_that_was_meant(words: tuple[str, ...], meant: str) -> None:
    assert f"did you mean '{meant}'?" in refusal(*words)


@dataclass(frozen=True)
class Hand:
    mass: Annotated[float, typer.Option("--mass")]
    tip: Annotated[str | None, typer.Option("--tip")] = None
    end: Annotated[str | None, typer.Option("--end")] = None


Kilograms = Annotated[float, typer.Option("--kg")]


def test_a_command_takes_a_group_of_options_but_those_it_cannot_use(
    capsys: pytest.CaptureFixture[str],
) -> None:
    def hit(
        hand: Annotated[Hand, But(mass=Kilograms, end=None)],
        speed: Annotated[float, typer.Option("--speed")] = 0.5,
    ) -> None:
        print(hand, speed)

    command = typer.Typer()
    command.command()(common(hit))
    command(["--kg", "2", "--tip", "palm"], standalone_mode=False)
    assert capsys.readouterr().out == f"{Hand(2.0, 'palm')} 0.5\n"
    for other in ("--end", "--mass"):
        with pytest.raises(Exception, match=f"No such option: {other}"):
            command(["--kg", "2", other, "3"], standalone_mode=False)


def test_several_impacts_fit_eighty_columns() -> None:
    directions = ("--direction", "[0, 1, 0]")
    found = run("simulate", *ANALYZE[1:], *directions, "--region", "chest", "--speed", "0.5")
    assert found.code == 0
    assert max(map(len, found.out.splitlines())) <= 80
    assert found.out.index("exceeded") < found.out.index("kept")


def test_cells_are_short_for_people() -> None:
    assert [shown(x) for x in (1 / 3, 12345.6, None, "text")] == ["0.3333", "12,346", "–", "text"]
