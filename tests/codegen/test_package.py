# SPDX-License-Identifier: BSD-3-Clause
"""What a package consists of, and that it depends on nothing but its robot."""

from __future__ import annotations

import hashlib
import json
import re
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import casadi as ca
import numpy as np
import pytest
from compiled_packages import COMMITTED, Generated, mostly_slow, run, tool

from softimpact.codegen import generate_package
from softimpact.codegen.inputs.parameters import parameters_of
from softimpact.codegen.inputs.samples import draw_samples
from softimpact.codegen.record.cost_digests import needed_sources
from softimpact.symbolic import (
    FrameNotFound,
    ImpactModel,
    InvalidValue,
    Robot,
    count_flops,
    drives,
    load_robot,
)

ROOT = Path(__file__).parents[2]
FLOAT_CALLS = {
    "sinf",
    "cosf",
    "sqrtf",
    "fmaxf",
    "powf",
    "cbrtf",
    "logf",
    "memcpy",
    "memset",
    "fminf",
    "expf",
}


@pytest.mark.parametrize("name", mostly_slow(COMMITTED))
def test_committed_packages_are_current(package: Callable[[str], Generated], name: str) -> None:
    committed, fresh = ROOT / "generated" / name, package(name).folder
    names = {p.relative_to(fresh) for p in fresh.rglob("*") if p.is_file()}
    assert names == {p.relative_to(committed) for p in committed.rglob("*") if p.is_file()}
    for path in sorted(names):
        again = f"run `softimpact generate {name} --out generated/{name}`"
        assert (committed / path).read_bytes() == (fresh / path).read_bytes(), again


def test_manifest_describes_the_package(package: Callable[[str], Generated]) -> None:
    generated = package("panda")
    manifest = json.loads((generated.folder / "manifest.json").read_text())
    assert manifest == json.loads(generated.manifest.to_json())
    assert manifest["digest"] == generated.robot.digest()
    for path, digest in manifest["files"].items():
        assert hashlib.sha256((generated.folder / path).read_bytes()).hexdigest() == digest
    assert str(generated.folder.parent) not in "".join(
        path.read_text() for path in generated.folder.rglob("*") if path.is_file()
    )


def test_costs_are_within_the_designs_limits(package: Callable[[str], Generated]) -> None:
    generated = package("panda")
    flops = {f.name.removeprefix("panda_"): f.flops for f in generated.manifest.functions}
    assert flops["mass_matrix"] <= 337
    assert flops["reflected_mass"] <= 621
    assert flops["reduced_model"] <= 1010
    assert flops["giaf"] <= 1180
    for function in generated.functions:  # carrying signs along never costs more
        outputs = [output.value for output in function.outputs]
        reciprocals = function.graph.count(ca.OP_INV)
        assert function.flops - reciprocals <= count_flops(ca.vertcat(*map(ca.vec, outputs)))


def test_giaf_is_taken_in_the_cheapest_axes(package: Callable[[str], Generated]) -> None:
    functions = {f.name: f for f in package("panda").functions}
    assert functions["giaf"].flops < functions["osim"].flops


def test_planar_robots_have_no_operational_space_inertia(
    package: Callable[[str], Generated],
) -> None:
    names = {f.name for f in package("rr").manifest.functions}
    assert {"rr_reduced_model", "rr_chain"} <= names
    assert not names & {"rr_osim", "rr_giaf", "rr_directional_giaf"}


@pytest.mark.slow
def test_every_robot_number_comes_from_the_model(tmp_path: Path, panda: Robot) -> None:
    values = drives(panda, joint_stiffness=1234.5, rotor_inertia=0.25, position_gain=7)
    generate_package(panda, tmp_path / "p", drives=values, name="My Arm-2")
    common = (tmp_path / "p/src/my_arm_2_common.c").read_text()
    assert common.count("MY_ARM_2_R(1234.5)") == common.count("MY_ARM_2_R(0.25)") == 7
    assert ImpactModel(panda, "hand_tcp", values).size == 14


def test_rejects_arguments_without_meaning(tmp_path: Path, panda: Robot) -> None:
    out = tmp_path / "p"
    with pytest.raises(FrameNotFound, match="hand_tcp"):
        generate_package(panda, out, tip="nose")
    with pytest.raises(InvalidValue, match="'link0' cannot move"):
        generate_package(panda, out, tip="link0")
    with pytest.raises(InvalidValue, match="real"):
        generate_package(panda, out, real="half")  # type: ignore[arg-type]
    with pytest.raises(InvalidValue, match="chain_order"):
        generate_package(panda, out, chain_order=0)
    with pytest.raises(InvalidValue, match="gravity"):
        generate_package(panda, out, gravity=(0, 0, float("nan")))
    assert not out.exists()


def test_chain_is_no_longer_than_the_robot(tmp_path: Path) -> None:
    model = tmp_path / "door.xml"
    model.write_text(
        '<mujoco model="test"><worldbody><body><joint name="hinge" axis="0 0 1" armature=".1"/>'
        '<inertial mass="1" pos=".3 0 0" diaginertia=".01 .01 .01"/>'
        '<site name="edge" pos=".5 0 0"/></body></worldbody></mujoco>'
    )
    robot = load_robot(model)
    manifest = generate_package(robot, tmp_path / "p", tip="edge")
    assert (manifest.name, manifest.coordinates, manifest.chain_order) == ("robot_test", 2, 2)
    generated = Generated(robot, "edge", tmp_path / "p", manifest)
    assert "all passed" in generated.run_own_test("gcc", "double", tmp_path / "run")


def test_header_says_what_units_sliding_joints_have(package: Callable[[str], Generated]) -> None:
    header = (package("gantry").folder / "include/gantry_2.h").read_text()
    assert "of the sliding ones (x, z) read m for rad" in header
    assert "sliding" not in (package("rr").folder / "include/rr.h").read_text()


def test_samples_are_exact_in_float_and_inside_the_limits(panda: Robot) -> None:
    lower, upper = panda.limits
    for sample in draw_samples(panda, parameters_of(panda), 200, seed=4):
        numbers = np.array([*sample.q, *sample.n, *np.ravel(sample.parameters)])
        assert (numbers.astype(np.float32) == numbers).all()
        assert (lower <= sample.q).all()
        assert (sample.q <= upper).all()
        assert np.ravel(sample.parameters[:2]).min() > 0


@pytest.mark.parametrize(
    ("limits", "sampled"),
    [
        ((-0.5, 0.25), (-0.5, 0.25)),
        ((-6.5, 6.5), (-6.5, 6.5)),  # as many turns as there are
        ((4.0, 6.0), (4.0, 6.0)),
        ((-np.inf, np.inf), (-np.pi, np.pi)),
        ((-1e10, -5.0), (-5.0 - np.pi, -5.0)),
    ],
)
def test_samples_reach_all_that_a_joint_may(
    panda: Robot, limits: tuple[float, float], sampled: tuple[float, float]
) -> None:
    turned = replace(panda.joints[2], lower=limits[0], upper=limits[1])
    robot = replace(panda, joints=(*panda.joints[:2], turned, *panda.joints[3:]))
    found = [sample.q[2] for sample in draw_samples(robot, parameters_of(robot), 2000, seed=4)]
    assert sampled[0] <= min(found) < max(found) <= sampled[1]
    assert max(found) - min(found) > 0.99 * (sampled[1] - sampled[0])


def test_joints_that_hardly_move_are_sampled_where_they_are(panda: Robot) -> None:
    fixed = replace(panda.joints[2], lower=0.3, upper=0.3001)
    robot = replace(panda, joints=(*panda.joints[:2], fixed, *panda.joints[3:]))
    for sample in draw_samples(robot, parameters_of(robot), 5, seed=4):
        assert sample.q[2] == pytest.approx(0.30005, abs=1e-6)


@pytest.mark.parametrize("name", mostly_slow(COMMITTED, ["rr"]))
def test_float_builds_hold_no_double_operation(
    package: Callable[[str], Generated], name: str, tmp_path: Path
) -> None:
    generated = package(name)
    for source in generated.folder.glob("src/*.c"):
        target = tmp_path / f"{source.stem}.o"
        run(tool("gcc"), *generated.flags("float"), "-c", source, "-o", target)
        needed = set(re.findall(r" U (\w+)", run(tool("nm"), target)))
        needed = {name for name in needed if not name.startswith(f"{generated.manifest.name}_")}
        assert needed <= {*FLOAT_CALLS, "sincosf", "_GLOBAL_OFFSET_TABLE_"}
        code = run(tool("objdump"), "-d", target)
        assert not re.search(r"\b(cvtss2sd|cvtsd2ss|mulsd|addsd|fcvt)\b", code)


@pytest.mark.slow
def test_names_of_the_model_cannot_end_a_comment(tmp_path: Path, panda: Robot) -> None:
    named = replace(panda.joints[0], name="*/ #error /* joint")
    robot = replace(panda, name="x */ #error", joints=(named, *panda.joints[1:]))
    generate_package(robot, tmp_path / "p", name="panda", chain_order=1)
    include = f"-I{tmp_path / 'p/include'}"
    run(tool("gcc"), "-Wall", "-Werror", include, "-c", tmp_path / "p/src/panda_common.c",
        "-o", tmp_path / "x.o")  # fmt: skip


def test_header_serves_cplusplus(package: Callable[[str], Generated], tmp_path: Path) -> None:
    generated = package("panda")
    source = tmp_path / "main.cpp"
    source.write_text(
        '#include "panda.h"\n'
        "int main() {\n"
        "  const panda_real q[PANDA_JOINTS] = {0, 0, 0, -1, 0, 1, 0}, n[3] = {1, 0, 0};\n"
        "  panda_real m_c = 0;\n"
        "  return panda_reflected_mass(q, n, &m_c) == PANDA_OK && m_c > 0 ? 0 : 1;\n"
        "}\n"
    )
    include = f"-I{generated.folder / 'include'}"
    objects: list[Path] = []
    sources = {f"src/{path.name}": path.read_text() for path in generated.folder.glob("src/*.c")}
    for file in sorted(needed_sources("panda", sources, "panda_reflected_mass") | {"panda_common"}):
        objects.append(tmp_path / f"{file}.o")
        run(tool("gcc"), *generated.flags("double"), "-c",
            generated.folder / f"src/{file}.c", "-o", objects[-1])  # fmt: skip
    flags = ["-std=c++11", "-Wall", "-Wextra", "-Wpedantic", "-Werror", include]
    run(tool("g++"), *flags, source, *objects, "-o", tmp_path / "main", "-lm")
    run(tmp_path / "main")


@pytest.mark.parametrize("name", ["panda", "rr", "rmin"])
def test_examples_of_the_readme_run(
    package: Callable[[str], Generated], tmp_path: Path, name: str
) -> None:
    generated = package(name)
    readme = (generated.folder / "README.md").read_text()
    main, *impacts = (part.split("```")[0] for part in readme.split("```c\n")[1:])
    assert len(impacts) == 2
    source, end = tmp_path / "main.c", "    return 0;\n"
    checked = [part + f"if (status != {name.upper()}_OK) return 2;\n" for part in impacts]
    source.write_text(main.replace(end, "{\n" + "".join(checked) + "}\n" + end))
    files = [source, *generated.folder.glob("src/*.c")]
    include = f"-I{generated.folder / 'include'}"
    run(tool("gcc"), "-std=c99", "-Wall", "-Wextra", "-Werror", include, *files,
        "-o", tmp_path / "main", "-lm")  # fmt: skip
    assert re.match(r"m_c = [\d.]+ kg, k_r = [\d.e+]+ N/m, m_a = [\d.]+ kg", run(tmp_path / "main"))


def test_finite_math_is_refused(package: Callable[[str], Generated], tmp_path: Path) -> None:
    generated = package("panda")
    source = generated.folder / "src/panda_common.c"
    flags = [*generated.flags("double"), "-ffast-math"]
    said = run(tool("gcc"), *flags, "-c", source, "-o", tmp_path / "x.o", ok=False)
    assert "without -ffast-math" in said


@pytest.mark.slow
def test_cmake_builds_tests_and_serves_others(
    package: Callable[[str], Generated], tmp_path: Path
) -> None:
    cmake, generated = tool("cmake"), package("rr")
    copy = tmp_path / "app" / "rr"
    shutil.copytree(generated.folder, copy)
    run(cmake, "-S", copy, "-B", tmp_path / "own", "-DRR_REAL=float")
    run(cmake, "--build", tmp_path / "own")
    run(tmp_path / "own" / "rr_test")
    said = run(cmake, "-S", copy, "-B", tmp_path / "half", "-DRR_REAL=half", ok=False)
    assert "RR_REAL must be double or float, not half" in said
    (tmp_path / "app/main.c").write_text(
        '#include "rr.h"\nint main(void) { rr_params p; return rr_default_params(&p); }\n'
    )
    (tmp_path / "app/CMakeLists.txt").write_text(
        "cmake_minimum_required(VERSION 3.13)\nproject(app C)\nadd_subdirectory(rr)\n"
        "add_executable(app main.c)\ntarget_link_libraries(app PRIVATE rr)\n"
    )
    run(cmake, "-S", tmp_path / "app", "-B", tmp_path / "build")
    run(cmake, "--build", tmp_path / "build")
    run(tmp_path / "build" / "app")
    run(cmake, "--install", tmp_path / "own", "--prefix", tmp_path / "installed")
    assert (tmp_path / "installed/include/rr.h").is_file()
