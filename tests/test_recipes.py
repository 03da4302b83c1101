# SPDX-License-Identifier: BSD-3-Clause
"""CONTRIBUTING's other recipes, followed: a robot, a command and a C function of one's own."""

from __future__ import annotations

import re
import shutil
from pathlib import Path
from typing import Annotated, Any

import pytest
import typer
from command_line import run, run_json
from compiled_packages import Generated

from softimpact import cli, robots
from softimpact.codegen import generate_package
from softimpact.codegen.functions.catalogue import functions_of
from softimpact.codegen.functions.description import Output
from softimpact.codegen.functions.symbols import function_over
from softimpact.codegen.package import generate
from softimpact.studio.commands.common import common
from softimpact.symbolic import frame_pose, load_robot

ROOT = Path(__file__).resolve().parents[1]
ROBOT = """<!-- SPDX-License-Identifier: BSD-3-Clause -->
<mujoco model="flail">
  <custom><text name="tip" data="end"/></custom>
  <worldbody>
    <body name="handle"><joint name="swing" axis="0 0 1" armature=".2"/>
      <inertial mass="2" pos=".2 0 0" diaginertia=".01 .02 .02"/>
      <site name="end" pos=".5 0 0"/>
    </body>
  </worldbody>
</mujoco>
"""


def test_a_robot_is_one_file(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    folder = tmp_path / "robots"
    shutil.copytree(robots.FOLDER, folder, ignore=shutil.ignore_patterns("__pycache__"))
    (folder / "flail.xml").write_text(ROBOT, encoding="utf-8")
    monkeypatch.setattr(robots, "FOLDER", folder)
    listed = {robot["name"]: robot for robot in run_json("robots")["robots"]}
    assert listed["flail"]["tip"] == "end"
    found = run_json("analyze", "flail", "--q", "[0.3]", "--direction", "[-0.2955, 0.9553, 0]")
    assert found["m_c"] == pytest.approx((0.2 + 0.02 + 2 * 0.2**2) / 0.5**2, rel=1e-3)


def test_a_command_is_a_function_and_a_line(monkeypatch: pytest.MonkeyPatch) -> None:
    def weigh(
        model: Annotated[str, typer.Argument()],
        times: Annotated[int, typer.Option(min=1)] = 1,
    ) -> None:
        """Print what moves."""
        from softimpact.studio.output.printed import print_table

        robot = load_robot(model)
        mass = times * sum(joint.inertia.mass for joint in robot.joints)
        print_table("Weight", ("mass [kg]",), [(mass,)])

    registered = list(cli.app.registered_commands)
    monkeypatch.setattr(cli.app, "registered_commands", registered)
    cli.app.command()(common(weigh))
    assert run("weigh", "ur10e", "--times", 2, "--csv").out.startswith("# Weight\nmass [kg]\n58.2")
    assert run("weigh", "ur10", "-v").code == 2
    assert "Print what moves." in run("--help").out


def test_every_command_is_where_contributing_says() -> None:
    files = [*ROOT.glob("studio/commands/*.py"), *ROOT.glob("papers/*_command.py")]
    commands = {path.stem for path in files} - {"__init__", "common"}
    homes = {
        str(command.callback.__module__)
        for command in cli.app.registered_commands
        if command.callback
    }
    assert {home.rpartition(".")[2] for home in homes} == commands
    readme = (ROOT / "README.md").read_text(encoding="utf-8")
    for name in getattr(typer.main.get_command(cli.app), "commands", {}):
        assert f"`{name}`" in readme, name


@pytest.mark.slow
def test_a_c_function_is_a_function_and_its_place(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def with_height(s: Any, *given: Any, **options: Any) -> Any:
        height = frame_pose(s.model.robot, s.model.tip, s.q).position[2]
        output = Output("height", height, "m", "of the contact point, base axes")
        own = function_over(s, "height", "Height of the contact point.", (output,))
        return (*functions_of(s, *given, **options), own)

    monkeypatch.setattr(generate, "functions_of", with_height)
    robot = load_robot("ur5e")
    manifest = generate_package(robot, tmp_path / "c", chain_order=2)
    assert manifest.functions[-1].name == "ur5e_height"
    built = Generated(robot, str(robot.tip), tmp_path / "c", manifest)
    said = built.run_own_test("gcc", "double", tmp_path / "test")
    assert said.endswith("all passed\n")
    assert "ur5e_height" in said
    assert "Height of the contact point." in (tmp_path / "c/include/ur5e.h").read_text()
    assert "`ur5e_height`" in (tmp_path / "c/README.md").read_text()


def test_contributing_names_what_is_there() -> None:
    text = (ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")
    section = text.split("## Other usual changes")[1].split("\n## ")[0]
    for path in re.findall(r"`([\w/]+(?:/|\.\w+))`", section):
        if "NAME" not in path:
            assert (ROOT / path).exists(), path
