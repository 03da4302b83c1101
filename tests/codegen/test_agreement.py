# SPDX-License-Identifier: BSD-3-Clause
"""Compiled packages do what the symbolic model does, within the bounds they state."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from compiled_packages import Generated, Library, mostly_slow, run, tool
from package_oracle import OK, SINGULAR, assert_agrees

from softimpact.codegen import generate_package
from softimpact.codegen.inputs.parameters import SCALARS, parameters_of
from softimpact.codegen.inputs.samples import Sample, draw_samples
from softimpact.symbolic.robot.rigid import Array

ROBOTS = ["panda", "rr", "ur5e", "ur5", "baxter", "gantry", "rmin"]
ON_THREE_AXES = (
    *("osim", "giaf", "directional_giaf", "absorption_extremes"),
    *("force_measure", "impact_measure", "rotor_influence", "single_joint_giaf"),
)
NOT_FINITE, ZERO_DIRECTION, OUT_OF_RANGE = 2, 3, 4


@pytest.mark.parametrize("real", ["double", "float"])
@pytest.mark.parametrize("robot", mostly_slow(ROBOTS))
def test_c_agrees_with_the_model_on_fresh_inputs(
    package: Callable[[str], Generated], robot: str, real: str
) -> None:
    generated = package(robot)
    library = generated.load(real)
    samples = draw_samples(generated.robot, parameters_of(generated.robot), 40, seed=99)
    compared = assert_agrees(library, samples)
    assert compared > 0.9 * len(samples) * len(generated.functions)


EVERY_BUILD = [(compiler, real) for compiler in ("gcc", "clang") for real in ("double", "float")]
BUILDS = [("panda", *build) for build in EVERY_BUILD]
BUILDS += [(robot, *build) for robot in ROBOTS[1:] for build in EVERY_BUILD[::3]]
QUICK_BUILDS = [("panda", "gcc", "float"), ("rr", "gcc", "double"), ("rmin", "clang", "float")]


@pytest.mark.parametrize(("robot", "compiler", "real"), mostly_slow(BUILDS, QUICK_BUILDS))
def test_own_test_compiles_without_warnings_and_passes(
    package: Callable[[str], Generated], robot: str, compiler: str, real: str, tmp_path: Path
) -> None:
    said = package(robot).run_own_test(compiler, real, tmp_path / "test")
    assert said.endswith("all passed\n")
    manifest = package(robot).manifest
    assert said.count(" error ") == len(manifest.functions) + (manifest.impact is not None)


def test_own_test_fails_on_a_wrong_result(
    package: Callable[[str], Generated], tmp_path: Path
) -> None:
    generated = package("rr")
    golden = (generated.folder / "test/golden.c").read_text()
    row = next(line for line in golden.split("reflected_mass")[1].splitlines() if "    { " in line)
    wrong = tmp_path / "golden.c"
    wrong.write_text(golden.replace(row, row.replace("    { ", "    { 1")))
    sources = [*generated.folder.glob("src/*.c"), generated.folder / "test/run_tests.c", wrong]
    include = f"-I{generated.folder / 'test'}"
    binary = tmp_path / "test"
    run(tool("gcc"), *generated.flags("double"), include, *sources, "-o", binary, "-lm")
    assert "FAILED rr_reflected_mass: error within its bound" in run(binary, ok=False)


@pytest.mark.slow
def test_gravity_enters_the_stiffness(package: Callable[[str], Generated], tmp_path: Path) -> None:
    weightless = package("gantry")
    robot, tip, folder = weightless.robot, weightless.tip, tmp_path / "heavy"
    manifest = generate_package(robot, folder, tip=tip, gravity=(0.5, 0.0, -9.81), chain_order=2)
    heavy = Generated(robot, tip, folder, manifest).load("double")
    samples = draw_samples(robot, parameters_of(robot), 5, seed=3)
    assert_agrees(heavy, samples)
    change = stiffness(heavy, samples[0]) - stiffness(weightless.load("double"), samples[0])
    assert abs(change[1, 1]) > 1e-2  # the arm turns about a tilted axis


def stiffness(library: Library, sample: Sample) -> Array:
    """Return K0 of a compiled package."""
    (function,) = [f for f in library.package.functions if f.name == "stiffness_matrix"]
    return library.call(function, sample)[1][0]


def test_bad_input_returns_a_status_and_writes_nothing(
    package: Callable[[str], Generated],
) -> None:
    generated = package("panda")
    library = generated.load("double")
    good = draw_samples(generated.robot, parameters_of(generated.robot), 1, seed=5)[0]
    nan, inf = float("nan"), float("inf")
    springs, rotors, gains, *more = good.parameters
    cases = [
        (replace(good, q=(nan, *good.q[1:])), NOT_FINITE),
        (replace(good, q=(*good.q[1:], -inf)), NOT_FINITE),
        (replace(good, n=(0.0, 0.0, -0.0)), ZERO_DIRECTION),
        (replace(good, n=(0.0, inf, 1.0)), NOT_FINITE),
        (replace(good, parameters=((0.0, *springs[1:]), rotors, gains, *more)), OUT_OF_RANGE),
        (replace(good, parameters=(springs, (*rotors[1:], -1.0), gains, *more)), OUT_OF_RANGE),
        (replace(good, parameters=(springs, rotors, (*gains[1:], nan), *more)), NOT_FINITE),
    ]
    (chain,) = [f for f in generated.functions if f.name == "chain"]
    assert library.call(chain, good)[0] == OK
    for sample, expected in cases:
        status, outputs = library.call(chain, sample)
        assert status == expected, sample
        assert all(np.isnan(output).all() for output in outputs)


def test_length_of_the_direction_does_not_matter(
    package: Callable[[str], Generated],
) -> None:
    generated = package("panda")
    library = generated.load("float")
    good = draw_samples(generated.robot, parameters_of(generated.robot), 1, seed=5)[0]
    (function,) = [f for f in generated.functions if f.name == "reflected_mass"]
    lengths = [2.0**exponent for exponent in (-120, -10, 0, 10, 120)]
    scaled = [replace(good, n=tuple(length * x for x in good.n)) for length in lengths]
    masses = {float(library.call(function, sample)[1][0]) for sample in scaled}
    assert len(masses) == 1


def test_directions_without_motion_are_singular(
    package: Callable[[str], Generated],
) -> None:
    generated = package("rr")  # moves in a plane
    for real in ("double", "float"):
        library = generated.load(real)
        sample = draw_samples(generated.robot, parameters_of(generated.robot), 1, seed=1)[0]
        for function in generated.functions:
            status, outputs = library.call(function, replace(sample, n=(0.0, 0.0, 1.0)))
            mass = function.name in ("reflected_mass", "reduced_model", "chain", "joint_impulse")
            assert status == (SINGULAR if mass else OK)
            assert all(np.isnan(output).all() == mass for output in outputs)


def test_stretched_arm_has_no_operational_space_inertia(
    package: Callable[[str], Generated],
) -> None:
    generated = package("ur5_wrist")
    elbow = generated.robot.joint_names.index("elbow_joint")
    bent = draw_samples(generated.robot, parameters_of(generated.robot), 1, seed=1)[0]
    straight = replace(bent, q=tuple(0.0 if i == elbow else x for i, x in enumerate(bent.q)))
    functions = [f for f in generated.functions if f.name in ON_THREE_AXES]
    assert len(functions) == len(ON_THREE_AXES)
    for real in ("double", "float"):
        library = generated.load(real)
        for function in functions:
            assert library.call(function, bent)[0] == OK
            assert library.call(function, straight)[0] == SINGULAR


def test_manipulability_vanishes_where_an_arm_is_stretched(
    package: Callable[[str], Generated],
) -> None:
    generated = package("ur5_wrist")
    elbow = generated.robot.joint_names.index("elbow_joint")
    bent = draw_samples(generated.robot, parameters_of(generated.robot), 1, seed=1)[0]
    angles = (1e-6, 2e-6, 0.0)
    (function,) = [f for f in generated.functions if f.name == "manipulability"]
    found = []
    for angle in angles:
        sample = replace(bent, q=tuple(angle if i == elbow else x for i, x in enumerate(bent.q)))
        status, (omega_m, _) = generated.load("double").call(function, sample)
        assert status == OK
        found.append(float(omega_m))
    assert found[1] == pytest.approx(2 * found[0], rel=1e-5)  # det(J J') would leave six digits
    assert 0 <= found[2] < 1e-15


def test_scalars_outside_their_range_are_refused(package: Callable[[str], Generated]) -> None:
    generated = package("rr")
    library = generated.load("float")
    good = draw_samples(generated.robot, parameters_of(generated.robot), 1, seed=2)[0]
    (impulse,) = [f for f in generated.functions if f.name == "joint_impulse"]
    nan, inf = float("nan"), float("inf")
    cases = [
        ((0.5, 0.0, 0.0, 0.0), OK),
        ((0.5, 1.0, 1.0, 0.0), OK),
        ((0.0, 0.0, 0.0, 0.0), OUT_OF_RANGE),
        ((0.5, 1.5, 0.0, 0.0), OUT_OF_RANGE),
        ((0.5, 0.0, -1.0, 0.0), OUT_OF_RANGE),
        ((inf, 0.0, 0.0, 0.0), NOT_FINITE),
        ((0.5, nan, 0.0, 0.0), NOT_FINITE),
        ((3e38, 1.0, 0.0, 0.0), SINGULAR),  # the impulse is too large for a float
    ]
    for scalars, expected in cases:
        status, outputs = library.call(impulse, replace(good, scalars=scalars))
        assert status == expected, scalars
        assert all(np.isfinite(output).all() == (expected == OK) for output in outputs)


@pytest.mark.parametrize("real", ["double", "float"])
@pytest.mark.parametrize("robot", ["panda", "gantry"])
def test_any_bits_give_finite_results_or_a_status(
    package: Callable[[str], Generated], robot: str, real: str
) -> None:
    generated = package(robot)
    library = generated.load(real)
    n, fields = generated.robot.n, len(parameters_of(generated.robot))
    kind, bits = (np.float64, np.uint64) if real == "double" else (np.float32, np.uint32)
    random = np.random.default_rng(11)
    answered = 0
    for _ in range(300):
        count = n + 3 + len(SCALARS) + fields * n
        numbers = random.integers(0, np.iinfo(bits).max, count, dtype=bits).view(kind)
        numbers = np.where(random.random(numbers.size) < 0.9, abs(numbers), numbers)
        numbers = np.where(np.isfinite(numbers), numbers, 1).astype(float)
        q, direction, scalars, rest = np.split(numbers, [n, n + 3, n + 3 + len(SCALARS)])
        parameters = tuple(map(tuple, rest.reshape(-1, n)))
        sample = Sample(tuple(q), tuple(direction), parameters, tuple(scalars))
        for function in generated.functions:
            status, outputs = library.call(function, sample)
            for output in outputs:
                assert np.isfinite(output).all() if status == OK else np.isnan(output).all()
            answered += status == OK
    assert answered > 300


@pytest.mark.slow
@pytest.mark.slow
def test_sanitizers_find_nothing(package: Callable[[str], Generated], tmp_path: Path) -> None:
    generated = package("panda")
    sources = [*generated.folder.glob("src/*.c"), *generated.folder.glob("test/*.c")]
    checks = ["-fsanitize=address,undefined", "-fno-sanitize-recover=all", "-g"]
    run(tool("gcc"), *generated.flags("double"), *checks, *sources, "-o", tmp_path / "t", "-lm")
    assert run(tmp_path / "t").endswith("all passed\n")
