# SPDX-License-Identifier: BSD-3-Clause
"""What packages say they cost on a microcontroller is theirs, true and affordable."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from adversarial.draw import Draw
from adversarial.impacts import Robot
from adversarial.instructions import Counter
from compiled_impacts import BOUNDED, DRIVEN
from compiled_packages import COMMITTED, Generated, missing, run, tool
from cross_compiled import GCC, flags, machine
from measured_costs import compiler_version, measure, stacks_of

from softimpact.codegen import generate_package
from softimpact.codegen.record import costs as costs_module
from softimpact.codegen.record.cost_digests import cost_digests
from softimpact.codegen.record.costs import (
    FEW_STEPS,
    Costs,
    FunctionCost,
    Instructions,
    SharedCost,
    stored_costs,
)
from softimpact.symbolic import load_robot

AGAIN = "run `make bench-c`"
FILES = {
    "include/a.h": "#define A_N 3\ntypedef struct {\n    a_real x;\n} a_params;\n"
    "/* What it does. */\nint a_f(const a_params *p);\n",
    "src/a_internal.h": "void a_help(void);\n",
    "src/a_f.c": '#include "a_internal.h"\nint a_f(const a_params *p)\n{\n    a_help();\n}\n',
    "src/a_common.c": "void a_help(void)\n{\n    /* nothing */\n}\n",
    "src/a_other.c": "int a_other(void)\n{\n    return A_N;\n}\n",
    "test/golden.c": "const a_golden a_golden_inputs[1] = {\n    1,\n};\n",
}
DIGESTS = cost_digests("a", FILES)
SMALL = Costs(
    compiler="a compiler",
    flags="-O2",
    functions=tuple(
        FunctionCost(name, Instructions(9, 10), Instructions(7, 8), 100, 4, 16, DIGESTS[name])
        for name in ("a_f", "a_other")
    ),
    shared=(SharedCost("a_common", 50, 0, DIGESTS["a_common"]),),
)


@pytest.mark.parametrize("robot", COMMITTED)
def test_built_in_packages_know_their_costs(
    package: Callable[[str], Generated], robot: str
) -> None:
    generated = package(robot)
    costs = generated.manifest.costs
    assert costs is not None, f"{robot}'s costs are those of other sources: {AGAIN}"
    assert {f.name for f in generated.manifest.functions} <= {f.name for f in costs.functions}
    readme = (generated.folder / "README.md").read_text()
    for function in costs.functions:
        assert f"| `{function.name}` | {function.m4.mean} |" in readme
        assert "driven" not in function.name or f"budget of {FEW_STEPS} steps" in readme
    assert json.loads((generated.folder / "manifest.json").read_text())["costs"]


def panda_costs(package: Callable[[str], Generated]) -> dict[str, FunctionCost]:
    costs = package("panda").manifest.costs
    assert costs is not None, AGAIN
    return {function.name.removeprefix("panda_"): function for function in costs.functions}


def test_closed_forms_cost_what_the_design_allows(package: Callable[[str], Generated]) -> None:
    found = panda_costs(package)
    assert 600 < found["reflected_mass"].m4.mean <= 1400  # not fewer than it has operations
    assert found["reduced_model"].m4.mean <= 2100


def test_code_is_as_small_as_the_design_asks(package: Callable[[str], Generated]) -> None:
    costs = package("panda").manifest.costs
    assert costs is not None, AGAIN
    sizes = {f.function: f.text + f.rodata for f in costs.functions}
    assert sum(sizes.values()) + sum(s.text + s.rodata for s in costs.shared) <= 80_000


@pytest.mark.embedded
def test_a_safe_speed_alone_is_small(package: Callable[[str], Generated], tmp_path: Path) -> None:
    """With all that it calls, of the C library too, beyond what an empty program has."""
    tool(GCC)
    generated = package("panda")
    told = [*flags(generated, "float"), *machine("m4"), "-ffunction-sections", "-fdata-sections"]
    sources = sorted(generated.folder.glob("src/*.c"))
    program, image, sizes = tmp_path / "main.c", tmp_path / "image.elf", []
    head = '#include "panda_impact.h"\n\nint main(void)\n'
    alone: list[str | Path] = [
        "-I",
        generated.folder / "src",
        "--specs=rdimon.specs",
        "-Wl,--gc-sections",
    ]
    for body in ("0", "(int)(size_t)&panda_safe_speed"):
        program.write_text(f"{head}{{\n    return {body};\n}}\n")
        run(GCC, *told, program, *sources, *alone, "-o", image, "-lm")
        sizes.append(int(run("arm-none-eabi-size", image).splitlines()[1].split()[0]))
    assert 20_000 < sizes[1] - sizes[0] <= 30_000


def test_a_safe_speed_is_bounded_as_the_design_asks(
    package: Callable[[str], Generated],
) -> None:
    driven = panda_costs(package)["safe_speed (driven)"]
    assert driven.bound is not None
    assert driven.m7.most <= driven.bound <= 240_000  # found, and proven of any input
    assert driven.stack <= 13_000  # bytes
    assert panda_costs(package)["safe_speed"].m7.mean <= 155_000  # servos and free motors, too


@pytest.mark.xfail(
    strict=True,
    reason="with all modes, all contacts and a release a safe speed of driven motors takes some "
    "65,000 instructions: 29,000 to prepare and release, the rest for 62 steps of 7 modes",
)
def test_a_safe_speed_costs_what_the_design_allows(package: Callable[[str], Generated]) -> None:
    found = panda_costs(package)
    assert found["safe_speed (driven)"].m7.mean <= 48_000  # 100 µs at 480 MHz, one a cycle


@pytest.mark.embedded
def test_no_input_exceeds_the_stated_bound_on_time(
    package: Callable[[str], Generated], tmp_path: Path
) -> None:
    """Inputs that use up the budget, from where the adversarial search draws its own."""
    tool("qemu-system-arm")
    tool("arm-none-eabi-gcc")
    generated, count = package("panda"), 3000
    robot = Robot(generated, tmp_path)
    alike = {"motors": DRIVEN, "steps": FEW_STEPS, "reaction": 0.02, "horizon": 0.1}
    cases = Draw(robot, np.random.default_rng(51), wide=False).cases(count)
    cases = replace(
        cases, **{k: np.full(count, v, getattr(cases, k).dtype) for k, v in alike.items()}
    )
    hard = np.flatnonzero(robot.speeds(cases, "float")[0] == BOUNDED)[:200]
    assert len(hard) == 200
    most = Counter(generated, tmp_path)(cases.take(hard)).max()
    stated = panda_costs(package)["safe_speed (driven)"].bound
    assert stated is not None
    assert stated / 2 < most <= stated  # else the search or the bound is not worth much


def test_costs_come_back_for_their_sources_only(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(costs_module, "COSTS", tmp_path)
    assert stored_costs("a", FILES) is None
    (tmp_path / "a.json").write_text(SMALL.to_json())
    assert stored_costs("a", FILES) == SMALL
    assert stored_costs("b", FILES) is None

    def left(changed: dict[str, str]) -> list[str]:
        """Return the functions whose costs still hold when files change."""
        found = stored_costs("a", {**FILES, **changed})
        return [f.name for f in found.functions] if found else []

    header, other = FILES["include/a.h"], FILES["src/a_other.c"]
    both = ["a_f", "a_other"]
    assert left({"README.md": "x", "include/a_config.h": "float"}) == both
    assert left({"src/a_new.c": "int a_new(void)\n{\n}\n"}) == both
    assert left({"include/a.h": header + "int a_new(void);\n"}) == both
    assert left({"include/a.h": header.replace("What it does", "Why")}) == both
    assert left({"src/a_other.c": other + "/* why */\n"}) == both
    assert left({"src/a_other.c": other + "int b;\n"}) == ["a_f"]
    assert left({"src/a_common.c": "void a_help(void)\n{\n    a_other();\n}\n"}) == ["a_other"]
    assert left({"src/a_internal.h": "int a_help(int);\n"}) == ["a_other"]
    assert left({"include/a.h": header.replace("a_real x", "a_real x[2]")}) == ["a_other"]
    assert left({"include/a.h": header.replace("A_N 3", "A_N 4")}) == ["a_f"]
    assert left({"test/golden.c": FILES["test/golden.c"].replace("1,", "2,")}) == []


@pytest.mark.slow
def test_other_packages_say_that_nothing_was_measured(tmp_path: Path) -> None:
    robot = load_robot("rmin")
    manifest = generate_package(robot, tmp_path / "p", name="other")
    assert manifest.costs is None
    assert "has not been measured" in (tmp_path / "p/README.md").read_text()


@pytest.mark.long
@pytest.mark.embedded
@pytest.mark.parametrize("robot", COMMITTED)
def test_costs_are_those_measured_again(
    package: Callable[[str], Generated], robot: str, tmp_path: Path
) -> None:
    tool("qemu-system-arm")
    tool("arm-none-eabi-gcc")
    generated = package(robot)
    stated = generated.manifest.costs
    assert stated is not None, AGAIN
    if stated.compiler != compiler_version():
        missing(f"{stated.compiler}, not {compiler_version()}, or {AGAIN}")
    assert measure(generated, tmp_path) == stated, AGAIN


def test_stack_is_that_of_the_deepest_call(tmp_path: Path) -> None:
    node = 'node: {{ title: "{0}" label: "{0}\\n{0}.c:1:1\\n{1} bytes (static)" }}\n'
    edge = 'edge: {{ sourcename: "{}" targetname: "{}" label: "x" }}\n'
    nodes = [node.format(*pair) for pair in (("a", 8), ("b", 16), ("c", 100), ("d", 4))]
    edges = [edge.format(*pair) for pair in (("a", "b"), ("b", "c"), ("a", "d"), ("d", "sinf"))]
    (tmp_path / "x.ci").write_text("".join(nodes))
    (tmp_path / "y.ci").write_text("".join(edges))
    assert stacks_of(tmp_path) == {"a": 124, "b": 116, "c": 100, "d": 4}
    (tmp_path / "z.ci").write_text(edge.format("c", "a"))
    with pytest.raises(AssertionError, match="calls itself"):
        stacks_of(tmp_path)
