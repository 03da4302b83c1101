# SPDX-License-Identifier: BSD-3-Clause
"""Files that mean harm, or that an accident has changed: one error, in time and memory."""

from __future__ import annotations

import random
import re
import time
import tracemalloc
from collections.abc import Callable, Iterator
from pathlib import Path

import pytest
from oracles import example_urdf
from robot_files import URDF_LIMIT, many_joints, two_links, two_links_urdf, urdf_inertial

from softimpact.robots import built_in_robots
from softimpact.symbolic import (
    InvalidValue,
    ModelFileError,
    Robot,
    SoftImpactError,
    arm_of,
    load_robot,
)

SECONDS, BYTES = 2.0, 50e6
"""What one file may cost; several times what it does, for busy machines."""

VISUAL = '<visual><geometry><mesh filename="package://nowhere/arm.dae"/></geometry></visual>'

BOMB = '<!DOCTYPE x [<!ENTITY a "aaaaaaaaaa">' + "".join(
    f'<!ENTITY {chr(98 + i)} "{f"&{chr(97 + i)};" * 10}">' for i in range(10)
)
NAMED = "<robot name='&k;'><link name='l'/></robot>"


@pytest.mark.parametrize(
    "text",
    [
        f"{BOMB}]>{NAMED}",
        f'<!DOCTYPE x [<!ENTITY k SYSTEM "file:///etc/passwd">]>{NAMED}',
        f'<!DOCTYPE x [<!ENTITY % k SYSTEM "file:///dev/zero"> %k;]>{NAMED}',
        f"{BOMB}]><mujoco model='&k;'/>",
        '<mujoco><include file="/dev/zero"/></mujoco>',
        '<mujoco><include file="robot.xml"/></mujoco>',
        '<mujoco><include file="/etc/passwd"/></mujoco>',
        "<mujoco>" + "<worldbody>" * 100_000,
        "<robot>" + "<link>" * 100_000,
        "<robot>" * 3,
        "<" * 1_000_000,
        "<robot name='a'><link name='" + "l" * 1_000_000 + "'/></robot>",
        '<mujoco><worldbody><body><joint/><geom size="1e308"/></body></worldbody></mujoco>',
        two_links(upper='pos="1e308 1e308 1e308"'),
        two_links(j1='axis="1e-320 0 0"'),
        two_links_urdf(limit='<limit lower="-1e400" upper="1e400"/>', type1="prismatic"),
        two_links_urdf(upper='<inertial><mass value="1e309"/></inertial>'),
        '<mujoco><asset><mesh name="m" file="/dev/zero"/></asset><worldbody><body><joint/>'
        '<geom type="mesh" mesh="m"/></body></worldbody></mujoco>',
    ],
    ids=lambda text: re.sub(r"\s+", " ", text)[:40],
)
def test_hostile_texts(tmp_path: Path, text: str) -> None:
    path = tmp_path / "robot.xml"
    path.write_text(text)
    started = time.process_time()
    survives(path, load_robot)
    assert time.process_time() - started < SECONDS
    tracemalloc.start()  # makes what follows four times slower
    try:
        survives(path, load_robot)
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    assert peak < BYTES


def test_what_is_no_file(tmp_path: Path) -> None:
    for path in (Path("/dev/zero"), tmp_path, Path("robot\0.xml")):
        with pytest.raises((ModelFileError, SoftImpactError)):
            load_robot(path)


def seeds() -> list[str]:
    """Texts that hold what robot files have."""
    tendons = (
        '<tendon><fixed name="t" stiffness="1"><joint joint="j1" coef="1"/>'
        '<joint joint="j2" coef="-1"/></fixed></tendon>'
        '<equality><joint joint1="j2" joint2="j1" polycoef="0 2 0 0 0"/></equality>'
        '<actuator><position tendon="t" kp="10"/></actuator>'
    )
    texts = [
        two_links(after=tendons, on_fore='<geom type="capsule" fromto="0 0 0 0 0 1" size=".1"/>'),
        two_links_urdf(on_j2='<mimic joint="j1" multiplier="-1"/>'),
        built_in_robots()["rmin"].read_text(),
        built_in_robots()["mini_cheetah"].read_text(),
        example_urdf("ur5_robot.urdf").read_text(),
    ]
    return [text[:20_000] for text in texts]


WORDS = (
    "nan",
    "inf",
    "-1",
    "0",
    "1e308",
    "",
    "joint",
    "j1",
    "world",
    "<body>",
    "</robot>",
    "é",
    "&",
)


def mutations(text: str, draw: random.Random) -> Iterator[str]:
    """Yield changed versions of a text, without end: characters, words, elements, lines."""
    tokens = re.split(r'(["<>\s]+)', text)
    elements = re.findall(r"<\w[^>]*>", text)
    while True:
        changed = list(tokens)
        for _ in range(draw.randint(1, 3)):
            place = draw.randrange(len(changed))
            kind = draw.randrange(5)
            if kind == 0:
                changed[place] = draw.choice(WORDS)
            elif kind == 1:
                del changed[place]
            elif kind == 2:
                changed.insert(place, changed[draw.randrange(len(changed))])
            elif kind == 3:
                changed[place] = draw.choice(elements)
            else:
                word = changed[place]
                cut = draw.randrange(len(word) + 1)
                changed[place] = word[:cut] + chr(draw.randrange(1, 0x250)) + word[cut + 1 :]
        yield "".join(changed)


def survives(path: Path, load: Callable[[Path], Robot]) -> bool:
    """Load a file; anything but a robot or one of our errors is raised."""
    try:
        load(path)
    except SoftImpactError as error:
        assert "\n" not in str(error)  # noqa: PT017
        assert len(str(error)) < 5000  # noqa: PT017
        return False
    return True


def mutated(tmp_path: Path, count: int, seed: int) -> int:
    """Load mutated files; return how many hold a robot still."""
    draw = random.Random(seed)
    path, good = tmp_path / "robot.xml", 0
    sources = [mutations(text, draw) for text in seeds()]
    for i in range(count):
        path.write_text(next(sources[i % len(sources)]), encoding="utf-8", errors="replace")
        good += survives(path, load_robot)
    return good


def test_mutated_files(tmp_path: Path) -> None:
    good = mutated(tmp_path, 60, 1)
    assert 0 < good < 60


@pytest.mark.slow
def test_many_mutated_files(tmp_path: Path) -> None:
    started = time.process_time()
    good = mutated(tmp_path, 5000, 2)
    assert 500 < good < 4500
    assert time.process_time() - started < 900


def nested(count: int) -> str:
    """Return many bodies one on another, of which the first and the middle one turn."""
    parts = ['<robot name="tower"><link name="l0"/>']
    for i in range(1, count + 1):
        kind = "revolute" if i in (1, count // 2) else "fixed"
        parts.append(
            f'<link name="l{i}">{urdf_inertial("0.01", "0", *["1e-4"] * 3)}</link>'
            f'<joint name="j{i}" type="{kind}"><origin xyz="0.001 0 0"/><axis xyz="0 0 1"/>'
            f'<parent link="l{i - 1}"/><child link="l{i}"/>{URDF_LIMIT}</joint>'
        )
    return "".join([*parts, "</robot>"])


@pytest.mark.slow
@pytest.mark.parametrize(
    ("text", "tip", "joints"),
    [
        (nested(3000), "l3000", 2),
        (two_links_urdf(upper=urdf_inertial("2", "0.2") + 1000 * VISUAL), "tool", 2),
        (two_links(on_upper=1500 * '<body><geom size="0.01" mass="0.001"/></body>'), "tool", 2),
        (two_links(on_upper=1000 * '<body><joint/><geom size="0.01"/></body>'), "tool", 2),
    ],
    ids=["3000 nested bodies", "1000 visuals", "1500 bodies", "1000 joints off the arm"],
)
def test_large_files_take_seconds(tmp_path: Path, text: str, tip: str, joints: int) -> None:
    path = tmp_path / "robot.xml"
    path.write_text(text)
    started = time.process_time()
    assert load_robot(path, tip).n >= joints
    assert arm_of(load_robot(path, tip), tip).robot.n == joints
    assert time.process_time() - started < 10.0


def test_arms_of_too_many_joints_are_refused(tmp_path: Path) -> None:
    path = tmp_path / "robot.urdf"
    path.write_text(many_joints(101))
    with pytest.raises(InvalidValue, match="101 joints lie on the way to 'tool', but no more"):
        arm_of(load_robot(path, "tool"), "tool")
