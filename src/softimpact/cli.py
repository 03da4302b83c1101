# SPDX-License-Identifier: BSD-3-Clause
"""The command ``softimpact``: what it can do, and how it ends.

Commands import what they need when they run, so that ``--help`` answers at once.
"""

from __future__ import annotations

import logging
import os
import sys
from collections.abc import Sequence
from importlib.metadata import version
from itertools import pairwise
from typing import Annotated, Any

import typer

from .console import accept_any_console
from .interruption import INTERRUPTED, interruptible, report
from .papers.factors_study_command import factors_study
from .papers.reproduce_command import reproduce
from .studio.commands.analyze import analyze
from .studio.commands.check import check
from .studio.commands.common import common
from .studio.commands.design import design
from .studio.commands.factors import factors
from .studio.commands.generate import generate
from .studio.commands.init import init
from .studio.commands.inspect import inspect
from .studio.commands.map import safety_map
from .studio.commands.pareto import pareto
from .studio.commands.program import SeveralValues, program
from .studio.commands.robots import robots
from .studio.commands.select import select
from .studio.commands.simulate import simulate
from .studio.commands.studio import studio

USER_ERROR = 2
"""Exit code; a failed solver's is 3 and comes with its exception."""

app = typer.Typer(pretty_exceptions_enable=False)

app.command()(common(robots))
app.command()(common(inspect, "looking into the file"))
app.command()(common(init))
app.command()(common(check, "checking"))
app.command()(common(analyze, "deriving"))
app.command()(common(factors, "deriving"))
app.command()(common(factors_study, "computing"))
app.command()(common(simulate, "simulating"))
app.command(cls=SeveralValues)(common(program))
app.command("map")(common(safety_map))
app.command()(common(select, "ranking"))
app.command()(common(design))
app.command()(common(pareto))
app.command()(common(generate))
app.command()(common(studio, "writing the page"))
app.command()(common(reproduce))


@app.callback(invoke_without_command=True)
def softimpact(
    context: typer.Context,
    show_version: Annotated[
        bool, typer.Option("--version", help="Print the version and leave.")
    ] = False,
) -> None:
    """Design compliant robots whose impacts do not hurt."""
    if show_version:
        typer.echo(version("softimpact"))
    elif context.invoked_subcommand is None:
        typer.echo(context.get_help())


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line; return the exit code.

    Args:
        arguments: default the process's own.
    """
    os.environ.setdefault("MUJOCO_GL", "disable")  # nothing is drawn, and its graphics load slowly
    logging.getLogger("matplotlib").setLevel(logging.ERROR)  # where no home keeps its fonts
    words = list(sys.argv[1:] if arguments is None else arguments)
    accept_any_console()
    try:
        _refuse_empty(words)
        _refuse_repeated(words)
        _refuse_underscores(words)
        with interruptible():
            code = app(args=words, prog_name="softimpact", standalone_mode=False)
    except (KeyboardInterrupt, typer.Abort):
        code = INTERRUPTED
    except Exception as error:
        declared = _exit_code(error)
        if declared is None:
            raise
        print(f"error: {_one_line(error)}", file=sys.stderr)
        return declared
    if code == INTERRUPTED:  # newer typer returns it
        report()
    return code if isinstance(code, int) else 0


def _refuse_empty(words: Sequence[str]) -> None:
    """Raise a usage error for an option without a value, such as a shell's ``"$UNSET"``."""
    for option, value in pairwise([*words, "end"]):
        name, is_given, typed = option.partition("=")
        if name.startswith("--") and (value == "" if not is_given else typed == ""):
            raise typer.BadParameter("is empty; give a value, or leave it out", param_hint=name)


def _refuse_repeated(words: Sequence[str]) -> None:
    """Raise a usage error if an option that takes one value is given twice: the first is lost."""
    command = _command(words)
    if command is None:
        return
    once = {
        name: parameter.opts[0]
        for parameter in command.params
        if not parameter.multiple and parameter.nargs == 1
        for name in (*parameter.opts, *parameter.secondary_opts)
    }
    given = [once[word.partition("=")[0]] for word in words if word.partition("=")[0] in once]
    twice = [name for name in given if given.count(name) > 1]
    if twice:
        raise typer.BadParameter(
            "is given twice; only one of them could count", param_hint=twice[0]
        )


def _refuse_underscores(words: Sequence[str]) -> None:
    """Raise a usage error for a number as only Python's programs have it: 1_0 is 10 there."""
    command = _command(words)
    numbers = {
        name
        for parameter in getattr(command, "params", [])
        if _is_number(parameter)
        for name in parameter.opts
    }
    for option, value in pairwise([*words, "end"]):
        name, is_given, typed = option.partition("=")
        if name in numbers and "_" in (typed if is_given else value):
            raise typer.BadParameter("is no number; write it without '_'", param_hint=name)


def _is_number(parameter: Any) -> bool:
    """Whether an option takes one number; newer typer's own say so, click's otherwise."""
    own, clicks = getattr(parameter, "type_descriptor", None), getattr(parameter, "type", None)
    words = str(getattr(clicks, "name", ""))
    return getattr(own, "annotation", None) in (float, int) or words.startswith(("float", "integer"))


def _command(words: Sequence[str]) -> Any:
    """Return click's command of this name; None for an unknown one."""
    group = typer.main.get_command(app)
    return getattr(group, "commands", {}).get(words[0]) if words else None


def _exit_code(error: Exception) -> int | None:
    """Exit code of an error that its user can mend; None for one of ours."""
    from softimpact.symbolic import SoftImpactError

    declared = getattr(error, "exit_code", None)  # usage errors, failed solvers
    if isinstance(declared, int):
        return declared
    return USER_ERROR if isinstance(error, (SoftImpactError, OSError)) else None


def _one_line(error: Exception) -> str:
    text = str(error)
    if isinstance(error, OSError) and error.strerror:  # without a file stdout's, or a full disk's
        place = "the result cannot be written" if error.filename is None else error.filename
        text = f"{place}: {error.strerror}"
    elif hasattr(error, "format_message"):  # usage errors
        text = error.format_message().replace("Value error, ", "")  # pydantic's, of choices
    return " ".join(text.split())
