# SPDX-License-Identifier: BSD-3-Clause
"""Whatever a robot is called, its package compiles, alone and beside others in one program."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from compiled_packages import COMMITTED, run, tool

from softimpact.codegen import generate_package, package_of
from softimpact.codegen.package.names import INNER, c_name
from softimpact.codegen.package.render import Templates, render, sources
from softimpact.codegen.verification.replay import replay
from softimpact.symbolic import InvalidValue, load_robot

ROOT = Path(__file__).parents[2]
LONG = "a robot of a company that gives its products very long names indeed"


@pytest.mark.parametrize(
    ("name", "identifier"),
    [
        ("UR5e", "ur5e"),
        ("my arm-2", "my_arm_2"),
        ("7dof", "robot_7dof"),
        ("机器人", "robot"),
        ("Größe", "groe"),
        ("Café", "cafe"),
        ("float", "robot_float"),  # include/float.h would hide that of C
        ("golden", "robot_golden_robot"),  # test/golden.h
        ("Test", "robot_test"),  # CMake has a target of this name
        ("m", "robot_m"),  # libm.a would be the C library's
        ("arm", "robot_arm"),  # arm_status is a type of DSP libraries
        ("threads", "robot_threads"),
        ("COM1", "robot_com1"),  # a device of Windows
        ("flt", "robot_flt"),  # FLT_EPSILON
        ("arm_impact", "arm_impact_robot"),  # arm has an arm_impact.h
        ("left contact", "left_contact_robot"),  # left_contact_jacobian is left's
        (LONG, "a_robot_of_a_company_that_gives_a6dbfc98"),
    ],
)
def test_names_become_c_identifiers(name: str, identifier: str) -> None:
    assert c_name(name) == identifier


def own_names(package: str) -> set[str]:
    """Return the names of a package's files and of what these declare, without the prefix."""
    found = set()
    for path in (ROOT / "generated" / package).rglob("*.[ch]"):
        text = re.sub(r"/\*.*?\*/", "", path.read_text(), flags=re.DOTALL)
        found |= {name.lower() for name in re.findall(rf"(?i)\b{package}_(\w+)", text)}
        found.add(path.stem.removeprefix(f"{package}_"))
    return found


def test_no_name_of_a_package_is_that_of_another() -> None:
    names = {name for package in COMMITTED for name in own_names(package)}
    names |= {"impact_mitigation", "configuration"}
    between = {
        name.removesuffix(f"_{other}")
        for name in names
        for other in names
        if name.endswith(f"_{other}") and other != "h"
    }
    clashes = {end for end in between if not c_name(f"arm_{end}").endswith("_robot")}
    assert {end for end in clashes if not end.startswith("golden_")} == set()
    assert {c_name(f"arm_{end}") for end in INNER} == {f"arm_{end}_robot" for end in INNER}


@pytest.mark.slow
def test_packages_of_difficult_names_are_parts_of_one_program(tmp_path: Path) -> None:
    compiler, robot = tool("gcc"), load_robot("rr")
    given = ("arm", "arm_impact", "threads", "errno", "class", LONG)
    names = [c_name(name) for name in given]
    objects = []
    for name in given:
        package = package_of(robot, name=name, verified=False)
        files = sources(package, Templates(package))
        for path, text in files.items():
            (tmp_path / path).parent.mkdir(exist_ok=True)
            (tmp_path / path).write_text(text)
        compiled = [path for path in files if path.startswith("src/") and path.endswith(".c")]
        folder = tmp_path / c_name(name)
        folder.mkdir()
        told = [compiler, "-std=c99", "-Wall", "-Werror", f"-I{tmp_path / 'include'}", "-c"]
        run("sh", "-c", f"cd {folder} && {' '.join(map(str, told))} "
            + " ".join(str(tmp_path / path) for path in compiled))  # fmt: skip
        objects += sorted(folder.glob("*.o"))
    lines = [f'#include "{name}.h"' for name in names]
    lines += ["typedef enum { ARM_OK = 0 } arm_status;", "int main(void)", "{", "    int sum = 0;"]
    for name in names:
        lines += [f"    {name}_params {name}_p;",
                  f"    sum += {name}_default_params(&{name}_p);"]  # fmt: skip
    program = tmp_path / "program.c"
    program.write_text("\n".join([*lines, "    return sum;", "}", ""]))
    include = f"-I{tmp_path / 'include'}"
    run(compiler, "-std=c99", "-Wall", "-Werror", include, program, *objects, "-o",
        tmp_path / "program", "-lm")  # fmt: skip
    run(tmp_path / "program")
    run(
        tool("g++"),
        "-std=c++17",
        "-Wall",
        "-Werror",
        "-fsyntax-only",
        include,
        "-x",
        "c++",
        program,
    )


@pytest.mark.slow
def test_one_candidate_passes_its_own_test() -> None:
    robot = load_robot("rr")
    package = package_of(robot, poses={"alone": [0.4, 0.0, 1.0, 0.0]})
    replay(render(package)[0], [tool("gcc")])


@pytest.mark.parametrize("name", ["Tip", "tip"])
def test_points_of_one_name_in_c_are_refused(tmp_path: Path, name: str) -> None:
    with pytest.raises(InvalidValue, match="two contact points"):
        generate_package(load_robot("rr"), tmp_path / "p", points={name: "O3"})
