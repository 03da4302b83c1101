# SPDX-License-Identifier: BSD-3-Clause
"""Packages with a payload among their parameters, and with parameters built in."""

from __future__ import annotations

import re
from collections.abc import Callable, Collection
from pathlib import Path

import numpy as np
import pytest
from compiled_packages import Generated, run, tool
from package_oracle import assert_agrees

from softimpact.codegen import Payload, generate_package
from softimpact.codegen.inputs.parameters import parameters_of
from softimpact.codegen.inputs.samples import draw_samples
from softimpact.symbolic import InvalidValue, Robot, UnknownName, drives, load_robot

LOAD = Payload(1.5, (0.125, -0.0625, 0.25))

Make = Callable[..., Generated]


@pytest.fixture(scope="module")
def make(tmp_path_factory: pytest.TempPathFactory) -> Make:
    """Return a generator of packages; each is generated once."""
    root = tmp_path_factory.mktemp("parameters")
    known: dict[tuple[object, ...], Generated] = {}

    def made(name: str, payload: Payload | None, freeze: Collection[str]) -> Generated:
        key = (name, payload, *freeze)
        if key not in known:
            robot = load_robot(name)
            springs = {} if robot.has_springs else {"joint_stiffness": 3000.0}
            values = drives(robot, rotor_inertia=0.3, position_gain=64.0, **springs)
            folder, tip = root / str(len(known)), str(robot.tip)
            manifest = generate_package(
                robot,
                folder,
                drives=values,
                chain_order=2,
                payload=payload,
                freeze=freeze,
            )
            known[key] = Generated(robot, tip, folder, manifest)
        return known[key]

    return made


CASES = [
    *(
        pytest.param(*case, marks=pytest.mark.slow)
        for case in [
            ("panda", LOAD, ()),
            ("panda", LOAD, ("all",)),
            ("panda", None, ("joint_stiffness", "position_gain")),
            ("rr", None, ("rotor_inertia",)),
            ("rr", None, ("all",)),
            ("rr", LOAD, ("all",)),
        ]
    ),
    ("rr", LOAD, ("payload_mass", "position_gain")),
]


@pytest.mark.parametrize("real", ["double", "float"])
@pytest.mark.parametrize(("robot", "payload", "freeze"), CASES)
def test_c_agrees_with_a_model_whose_last_link_holds_the_payload(
    make: Make, robot: str, payload: Payload | None, freeze: tuple[str, ...], real: str
) -> None:
    generated = make(robot, payload, freeze)
    samples = draw_samples(generated.robot, generated.parameters, 20, seed=98)
    compared = assert_agrees(generated.load(real), samples)
    assert compared > 0.9 * len(samples) * len(generated.functions)


@pytest.mark.parametrize("real", ["double", "float"])
@pytest.mark.parametrize(("robot", "payload", "freeze"), CASES)
def test_own_test_and_example_pass(
    make: Make,
    robot: str,
    payload: Payload | None,
    freeze: tuple[str, ...],
    real: str,
    tmp_path: Path,
) -> None:
    generated = make(robot, payload, freeze)
    assert generated.run_own_test("gcc", real, tmp_path / "test").endswith("all passed\n")
    fuzz = generated.folder / "fuzz/fuzz.c"
    run(tool("gcc"), *generated.flags(real), "-c", fuzz, "-o", tmp_path / "fuzz.o")
    readme = (generated.folder / "README.md").read_text()
    source = tmp_path / "main.c"
    source.write_text(readme.split("```c\n")[1].split("```")[0])
    files = [source, *generated.folder.glob("src/*.c")]
    flags = ["-std=c99", "-Wall", "-Wextra", "-Werror", f"-I{generated.folder / 'include'}"]
    use = f"-D{generated.manifest.name.upper()}_USE_{real.upper()}"
    run(tool("gcc"), *flags, use, *files, "-o", tmp_path / "main", "-lm")
    assert re.match(r"m_c = [\d.]+ kg", run(tmp_path / "main"))


def test_struct_holds_what_is_not_frozen(make: Make) -> None:
    some = make("rr", LOAD, ("payload_mass", "position_gain"))
    assert some.manifest.parameters == ("rotor_inertia", "damping_gain", "payload_com")
    assert some.manifest.frozen == {"payload_mass": (1.5,), "position_gain": (64.0, 0.0, 64.0, 0.0)}
    header = (some.folder / "include/rr.h").read_text()
    assert "rr_real payload_com[3];" in header
    assert "rr_real payload_mass" not in header
    assert "position_gain is built in: 64.0, 0.0, 64.0, 0.0 N m/rad" in header
    everything = make("rr", LOAD, ("all",))
    assert everything.manifest.parameters == ()
    header = (everything.folder / "include/rr.h").read_text()
    struct = header[: header.index("} rr_params;")].rsplit("typedef struct {", 1)[1]
    kept = [line.split(";")[0].split()[-1] for line in struct.strip().splitlines()]
    assert kept == ["layout", "reaction_time", "horizon", "motors", "steps"]  # what impacts go by


@pytest.mark.slow
def test_numbers_built_in_save_operations(make: Make) -> None:
    free, frozen = make("panda", LOAD, ()), make("panda", LOAD, ("all",))
    flops = [{f.name: f.flops for f in g.manifest.functions} for g in (free, frozen)]
    assert all(flops[1][name] <= flops[0][name] for name in flops[0])
    for short, saved in (("mass_matrix", 60), ("reduced_model", 90), ("giaf", 60)):
        name = f"panda_{short}"
        assert flops[0][name] - flops[1][name] >= saved, name


@pytest.mark.slow
def test_payload_costs_little(make: Make, package: Callable[[str], Generated]) -> None:
    loaded, empty = make("panda", LOAD, ()), package("panda")
    flops = [{f.name: f.flops for f in g.manifest.functions} for g in (loaded, empty)]
    for short in ("mass_matrix", "reflected_mass", "osim", "giaf"):
        name = f"panda_{short}"
        assert flops[0][name] - flops[1][name] <= 70, name
    assert flops[0]["panda_jacobian"] == flops[1]["panda_jacobian"]


def test_same_numbers_frozen_or_given_at_run_time(make: Make) -> None:
    given, built_in = make("rr", LOAD, ()), make("rr", LOAD, ("all",))
    samples = draw_samples(built_in.robot, built_in.parameters, 10, seed=7)
    library, frozen = given.load("double"), built_in.load("double")
    for sample in samples:  # built_in's samples hold its numbers
        for one, other in zip(given.functions, built_in.functions, strict=True):
            assert one.name == other.name
            for a, b in zip(
                library.call(one, sample)[1], frozen.call(other, sample)[1], strict=True
            ):
                np.testing.assert_allclose(a, b, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize(
    ("load", "field"),
    [
        (Payload(-1.0), "payload_mass"),
        (Payload(float("nan")), "payload_mass"),
        (Payload(1.0, (0.0, float("inf"), 0.0)), "payload_com"),
    ],
)
def test_impossible_payloads_are_refused(
    tmp_path: Path, panda: Robot, load: Payload, field: str
) -> None:
    with pytest.raises(InvalidValue, match=field):
        generate_package(panda, tmp_path / "p", payload=load)
    assert not (tmp_path / "p").exists()


def test_closed_chains_carry_no_payload(tmp_path: Path) -> None:
    with pytest.raises(InvalidValue, match=r"payload.*closed chain"):
        generate_package(load_robot("rmin"), tmp_path / "p", payload=Payload())


def test_what_is_not_known_cannot_be_frozen(tmp_path: Path, panda: Robot) -> None:
    elastic = drives(load_robot("rr"), joint_stiffness=3e3, rotor_inertia=0.1)
    with pytest.raises(InvalidValue, match=r"joint_stiffness: the C of 'rr'.*springs of its own"):
        generate_package(load_robot("rr"), tmp_path / "p", drives=elastic)
    with pytest.raises(InvalidValue, match=r"joint_stiffness.*needs numbers"):
        generate_package(panda, tmp_path / "p", freeze=["joint_stiffness"])
    with pytest.raises(InvalidValue, match="joint_stiffness"):
        generate_package(panda, tmp_path / "p", freeze=["all"])
    with pytest.raises(UnknownName, match="payload_mass"):
        generate_package(panda, tmp_path / "p", freeze=["payload_mass"])
    assert not (tmp_path / "p").exists()


def test_parameters_are_drawn_within_their_range(panda: Robot) -> None:
    parameters = parameters_of(panda, payload=True)
    for sample in draw_samples(panda, parameters, 100, seed=4):
        values = dict(zip([p.name for p in parameters], sample.parameters, strict=True))
        assert len(values["payload_mass"]) == 1
        assert len(values["payload_com"]) == 3
        assert values["payload_mass"][0] >= 0
        assert min(*values["rotor_inertia"], *values["joint_stiffness"]) > 0
