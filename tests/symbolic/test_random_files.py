# SPDX-License-Identifier: BSD-3-Clause
"""Random files in MJCF, with all that its compiler counts, against MuJoCo's own mass matrix."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from random import Random

import casadi as ca
import numpy as np
import pytest
from oracles import Mujoco

from softimpact.symbolic import chain_to, frame_jacobian, load_robot, mass_matrix

SIZES = {"sphere": 1, "capsule": 2, "box": 3, "cylinder": 2, "ellipsoid": 3}
"""Numbers that give a shape its size."""

TURNS = {"quat": 4, "axisangle": 4, "xyaxes": 6, "zaxis": 3, "euler": 3, "": 0}
"""Numbers that turn a body or a shape."""


@dataclass
class Writer:
    """Writes an arm at random; ``joints`` counts those written so far."""

    random: Random
    joints: int = 0

    def maybe(self, chance: float, text: str) -> str:
        """Return a text, or none."""
        return text if self.random.random() < chance else ""

    def number(self, low: float, high: float) -> str:
        """Return a random number."""
        return f"{self.random.uniform(low, high):.7g}"

    def vector(self, size: int, reach: float = 0.4) -> str:
        """Return random numbers."""
        return " ".join(self.number(-reach, reach) for _ in range(size))

    def place(self) -> str:
        """Return attributes of a random pose."""
        turn = self.random.choice(list(TURNS))
        turned = f' {turn}="{self.vector(TURNS[turn], 1)}"' if turn else ""
        return f'pos="{self.vector(3)}"{turned}'

    def shape(self) -> str:
        """Return a geom: its mass stated, by its density, or by that of a class."""
        kind = self.random.choice(list(SIZES))
        if kind in ("capsule", "cylinder") and self.random.random() < 0.5:
            form = f'fromto="{self.vector(6)}" size="{self.number(0.02, 0.1)}"'
        else:
            sizes = " ".join(self.number(0.02, 0.15) for _ in range(SIZES[kind]))
            form = f'size="{sizes}" {self.place()}'
        weight = self.random.choice(["", 'mass="1.5"', 'density="2300"', 'class="b"', 'class="c"'])
        hollow = self.maybe(0.1, 'shellinertia="true"')
        group = self.maybe(0.4, f'group="{self.random.randint(0, 5)}"')
        return f'<geom type="{kind}" {form} {weight} {hollow} {group}/>'

    def inertial(self) -> str:
        """Return an inertia that is stated, along axes of its own or as a full tensor."""
        mass = f'mass="{self.number(0.2, 4)}"'
        if self.random.random() < 0.5:
            return f'<inertial {self.place()} {mass} diaginertia=".1 .12 .05"/>'
        tensor = "0.1 0.11 0.09 0.01 -0.01 0.005"
        return f'<inertial pos="{self.vector(3)}" {mass} fullinertia="{tensor}"/>'

    def joint(self) -> str:
        """Return a hinge or a slide, its zero moved by ``ref``, with a rotor or a class's."""
        kind = self.random.choice(["hinge", "hinge", "slide"])
        name = f"j{self.joints}"
        self.joints += 1
        ref = self.maybe(0.3, f'ref="{self.number(-1, 1)}"')
        rotor = self.random.choice(["", 'armature="0.7"', 'class="b"', 'class="c"'])
        axes = f'axis="{self.vector(3, 1)}" pos="{self.vector(3, 0.2)}"'
        return f'<joint name="{name}" type="{kind}" {axes} {ref} {rotor}/>'

    def body(self, inner: str, joints: int) -> str:
        """Return a body around another one, perhaps within a frame."""
        shapes = "".join(self.shape() for _ in range(self.random.randint(0, 3)))
        stated = self.maybe(0.3 if shapes else 0.8, self.inertial())
        moves = "".join(self.joint() for _ in range(joints))
        child = self.maybe(0.3, f'childclass="{self.random.choice("bc")}"')
        body = f"<body {self.place()} {child}>{moves}{stated}{shapes}{inner}</body>"
        return f"<frame {self.place()}>{body}</frame>" if self.random.random() < 0.25 else body

    def rules(self) -> str:
        """Return attributes of the compiler."""
        order = self.random.choice(["xyz", "XYZ", "zyx", "XzY", "xZx"])
        return " ".join(
            (
                f'angle="{self.random.choice(["degree", "radian"])}" eulerseq="{order}"',
                self.maybe(0.2, 'inertiafromgeom="true"'),
                self.maybe(0.3, f'boundmass="{self.number(0.1, 2)}"'),
                self.maybe(0.3, f'boundinertia="{self.number(0.001, 0.2)}"'),
                self.maybe(0.1, f'settotalmass="{self.number(2, 20)}"'),
                self.maybe(0.2, f'inertiagrouprange="{self.random.randint(0, 1)} 3"'),
                self.maybe(0.1, 'balanceinertia="true"'),
            )
        )

    def file(self) -> str:
        """Return a file; its tip is the site ``tip``."""
        inner = f'<site name="tip" pos="{self.vector(3)}"/>'
        for _ in range(self.random.randint(0, 4)):
            inner = self.body(inner, self.random.choice([1, 1, 1, 2, 0, 3]))
        inner = self.body(inner, self.random.choice([1, 2]))
        classes = (
            '<geom density="1300"/><default class="b"><joint armature="0.3"/><geom density="700"/>'
            '<default class="c"><geom mass="0.4"/></default></default>'
        )
        return (
            f"<mujoco><compiler {self.rules()}/><default>{classes}</default>"
            f"<worldbody>{inner}</worldbody></mujoco>"
        )


def check(seed: int, folder: Path) -> bool:
    """Hold a file's mass matrix and Jacobian against MuJoCo's; whether MuJoCo takes the file."""
    text = Writer(Random(seed)).file()
    try:
        oracle = Mujoco(text)
    except ValueError:  # a body without mass
        return False
    state = np.random.default_rng(seed).uniform(-2, 2, oracle.model.nq)
    mass = oracle.at(state).mass_matrix()
    path = folder / "arm.xml"
    path.write_text(text)
    arm = chain_to(load_robot(path, "tip"), "tip")
    own = [int(oracle.model.joint(name).qposadr[0]) for name in arm.joint_names]
    q = ca.DM(state[own])
    ours = np.array(mass_matrix(arm, q)) + np.diag(arm.armature)
    np.testing.assert_allclose(ours, mass[np.ix_(own, own)], rtol=0, atol=1e-10 * mass.max())
    found = np.array(frame_jacobian(arm, "tip", q))
    np.testing.assert_allclose(found, oracle.site_jacobian("tip")[:, own], atol=1e-10)
    return True


@pytest.mark.parametrize("first", [0, pytest.param(60, marks=pytest.mark.slow)])
def test_files_weigh_what_mujoco_weighs(first: int, tmp_path: Path) -> None:
    count = 60 if first == 0 else 300
    taken = [check(seed, tmp_path) for seed in range(first, first + count)]
    assert sum(taken) > count / 2
