# SPDX-License-Identifier: BSD-3-Clause
"""The equations of closed chains, against MuJoCo's constraints and numeric derivatives."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import casadi as ca
import mujoco
import numpy as np
import pytest
from mechanisms import (
    FIVE_BAR,
    FOUR_BAR,
    PARALLELOGRAM,
    SIX_BAR,
    SPATIAL,
    THIRD_CRANK,
    four_bar,
    robot_of,
)
from oracles import Mujoco, assert_near
from scipy.linalg import block_diag
from symbol_kinds import KINDS

from softimpact.robots import built_in_robots
from softimpact.symbolic import (
    InvalidValue,
    Loop,
    LoopCannotClose,
    RedundantLoop,
    Robot,
    SingularLoop,
    SoftImpactError,
    UnknownName,
    chain_to,
    close_loops,
    closed_chain,
    constrained_stiffness,
    drives,
    frame_pose,
    impact_model,
    load_robot,
    lock_joints,
    loop_acceleration,
    loop_gaps,
    loop_jacobian,
    loop_tangent,
    mass_matrix,
    potential_energy,
)
from softimpact.symbolic.robot.rigid import Array

GRAVITY = (0.4, -9.0, -2.0)
FOUR_BAR_TEXT = FOUR_BAR.format(
    tilt="20", crank="0.2", length="0.5", lift="0", more="", equality="", key="1 -0.4 1.7"
)
USUAL = {"tilt": "0", "crank": "0.2", "length": "0.5", "lift": "0"}
SOURCES: dict[str, str | Path] = {
    "six_bar": FOUR_BAR.format(**(USUAL | SIX_BAR)),
    "four_bar": FOUR_BAR_TEXT,
    "five_bar": FIVE_BAR,
    "spatial": SPATIAL,
    "rmin": built_in_robots()["rmin"],
}


Closed = tuple[Robot, Mujoco, Array]


@pytest.fixture(params=SOURCES)
def mechanism(request: pytest.FixtureRequest, tmp_path: Path) -> Closed:
    """A closed chain, MuJoCo's model of it, and a closed configuration off home."""
    source = SOURCES[request.param]
    robot = robot_of(tmp_path, source) if isinstance(source, str) else load_robot(source)
    chain = closed_chain(robot)
    start = chain.home[list(chain.independent)]
    return robot, Mujoco(source), close_loops(robot, start + np.linspace(0.05, 0.15, len(start)))


def constraint_rows(oracle: Mujoco) -> Array:
    """Return MuJoCo's Jacobian of the loops, three rows each."""
    data, model = oracle.data, oracle.model
    rows = data.efc_type == int(mujoco.mjtConstraint.mjCNSTR_EQUALITY)
    return np.asarray(data.efc_J.reshape(-1, model.nv)[rows])


def test_jacobian_is_mujocos(mechanism: Closed) -> None:
    robot, oracle, q = mechanism
    theirs = constraint_rows(oracle.at(q))
    ours = np.array(loop_jacobian(robot, q))
    axes = block_diag(*closed_chain(robot).axes)
    assert_near(ours, axes @ theirs, 1e-9)
    assert np.linalg.matrix_rank(theirs, 1e-9) == len(ours)  # what was left out always holds


def test_tangent_keeps_loops_closed(mechanism: Closed) -> None:
    robot, oracle, q = mechanism
    G = np.array(loop_tangent(robot, q))
    assert abs(constraint_rows(oracle.at(q)) @ G).max() < 1e-9
    assert_near(G[list(closed_chain(robot).independent)], np.eye(G.shape[1]))


def test_mass_and_jacobian_are_mujocos_along_the_tangent(mechanism: Closed) -> None:
    robot, oracle, q = mechanism
    oracle.at(q)
    G = np.array(loop_tangent(robot, q))
    model = impact_model(robot)
    assert_near(model.generalised_mass(q).matrix, G.T @ oracle.mass_matrix() @ G, 1e-9)
    assert_near(model.mass_matrix(q), G.T @ np.array(mass_matrix(robot, q)) @ G)
    if model.tip in {oracle.model.site(i).name for i in range(oracle.model.nsite)}:
        assert_near(model.jacobian(q), oracle.site_jacobian(model.tip)[:3] @ G, 1e-9)
    n = ca.DM([0.0, 0.6, 0.8])
    assert_near(model.contact_jacobian(q, n), n.T @ model.jacobian(q))


def test_tangent_is_the_slope_of_the_closure(mechanism: Closed) -> None:
    robot, _, q = mechanism
    ind = list(closed_chain(robot).independent)
    G = np.array(loop_tangent(robot, q))
    for k, step in enumerate(1e-5 * np.eye(len(ind))):
        slope = (close_loops(robot, q[ind] + step) - close_loops(robot, q[ind] - step)) / 2e-5
        np.testing.assert_allclose(slope, G[:, k], atol=1e-7)


def test_stiffness_is_the_curvature_of_the_reduced_potential(mechanism: Closed) -> None:
    robot, _, q = mechanism
    ind, h = list(closed_chain(robot).independent), 1e-4

    def energy(u: Array) -> float:
        return float(potential_energy(robot, close_loops(robot, u), GRAVITY))

    u, size = q[ind], len(ind)
    steps = h * np.eye(size)
    numeric = np.array(
        [
            [
                energy(u + a + b) - energy(u + a - b) - energy(u - a + b) + energy(u - a - b)
                for a in steps
            ]
            for b in steps
        ]
    ) / (4 * h * h)
    exact = np.array(constrained_stiffness(robot, q, GRAVITY))
    np.testing.assert_allclose(exact, numeric, atol=2e-5 * abs(exact).max())
    assert_near(impact_model(robot, gravity=GRAVITY).generalised_stiffness(q), exact)


def test_acceleration_is_the_slope_of_the_jacobian(mechanism: Closed) -> None:
    robot, _, q = mechanism
    velocity = np.random.default_rng(3).normal(size=robot.n)
    h = 1e-6
    slope = (
        np.array(loop_jacobian(robot, q + h * velocity) - loop_jacobian(robot, q - h * velocity))
        / (2 * h)
    ) @ velocity
    found = np.array(loop_acceleration(robot, q, velocity)).ravel()
    np.testing.assert_allclose(found, slope, atol=1e-6 * abs(found).max())


def test_gaps_are_between_the_frames(mechanism: Closed) -> None:
    robot, _, _ = mechanism
    q = np.random.default_rng(0).uniform(-1, 1, robot.n)
    found = np.array(loop_gaps(robot, q)).ravel()
    for loop, axes in zip(robot.loops, closed_chain(robot).axes, strict=True):
        assert isinstance(loop, Loop)
        ends = [np.array(frame_pose(robot, name, q).position) for name in (loop.first, loop.second)]
        gap, found = found[: len(axes)], found[len(axes) :]
        assert_near(gap, axes @ (ends[0] - ends[1]), 1e-9)
        assert_near(np.linalg.norm(gap), np.linalg.norm(ends[0] - ends[1]), 1e-7)
    assert not found.size


def test_symbols_of_every_kind_give_the_same(mechanism: Closed) -> None:
    robot, _, q = mechanism
    model = impact_model(robot, gravity=GRAVITY)
    n = ca.DM([1.0, 0.0, 0.0])
    reduced = model.reduced(ca.DM(q), n)
    exact = [float(reduced.m_c), float(reduced.k_r)]
    for kind in KINDS:
        symbol = kind.sym("q", robot.n)
        reduced = model.reduced(symbol, n if kind is ca.MX else ca.SX(n))
        function = ca.Function("f", [symbol], [ca.vertcat(reduced.m_c, reduced.k_r)])
        assert np.array(function(q)).ravel() == pytest.approx(exact, rel=1e-9)


@pytest.mark.parametrize(
    ("source", "independent", "rows"),
    [
        ("four_bar", ("crank",), 2),
        ("six_bar", ("crank",), 4),
        ("five_bar", ("a1", "b1"), 2),
        ("spatial", ("a1", "b1"), 3),
        ("rmin", ("q11", "q21", "q13", "q23"), 2),
    ],
)
def test_motors_come_first(
    source: str, independent: tuple[str, ...], rows: int, tmp_path: Path
) -> None:
    text = SOURCES[source]
    robot = robot_of(tmp_path, text) if isinstance(text, str) else load_robot(text)
    for known in (robot, replace(robot, independent=())):
        chain = closed_chain(known)
        assert tuple(robot.joint_names[i] for i in chain.independent) == independent
        assert len(chain.dependent) == rows == sum(len(axes) for axes in chain.axes)


def test_open_chains_have_no_equations() -> None:
    robot = load_robot("rr")
    chain = closed_chain(robot)
    assert chain.independent == tuple(range(4))
    assert not chain.dependent
    assert loop_gaps(robot, np.zeros(4)).numel() == 0
    assert_near(loop_tangent(robot, np.zeros(4)), np.eye(4))
    assert_near(close_loops(robot, [0.1, 0.2, 0.3, 0.4]), [0.1, 0.2, 0.3, 0.4])


def test_a_joint_welded_in_a_loop_leaves_one_freedom_less() -> None:
    robot = load_robot("rmin")
    home = closed_chain(robot).home
    locked = lock_joints(robot, {"q13": float(home[2])})
    chain = closed_chain(locked)
    assert tuple(locked.joint_names[i] for i in chain.independent) == ("q11", "q21", "q23")
    whole, part = impact_model(robot, "O13"), impact_model(locked, "O13")
    M, keep = np.array(whole.mass_matrix(home)), [0, 1, 3]
    assert_near(part.mass_matrix(np.delete(home, 2)), M[np.ix_(keep, keep)], 1e-7)


def test_chains_keep_the_joints_of_their_loops_and_no_others(tmp_path: Path) -> None:
    beside = """<body name="beside" pos="3 0 0"><joint name="beside" axis="0 0 1"/>
      <inertial mass="1" pos="0.2 0 0" diaginertia=".01 .01 .01"/></body>"""
    robot = four_bar(tmp_path, more=beside, key="1 -0.4 1.7 0")
    assert chain_to(robot, "tool").joint_names == ("crank", "coupler", "rocker")
    assert chain_to(robot, "eye").loops == robot.loops
    alone = chain_to(robot, "beside")
    assert alone.joint_names == ("beside",)
    assert not alone.loops


def test_rotors_of_joints_that_follow_move_with_them() -> None:
    robot = load_robot("rmin").with_armature([0.1, 0.2, 0.3, 0.4, 0.5, 0.6])
    q = closed_chain(robot).home
    G = np.array(loop_tangent(robot, q))
    full = G.T @ (np.array(mass_matrix(robot, q)) + np.diag(robot.armature)) @ G
    model = impact_model(robot)
    assert_near(model.generalised_mass(q).matrix, full)
    assert_near(model.rotor_mass_matrix(q), full)


ELASTIC = """
    <body name="shaft"><joint name="shaft" axis="0 0 1" armature="0.02"/>
      <inertial mass="1e-9" pos="0 0 0" diaginertia="1e-12 1e-12 1e-12"/>
      <body name="crank" euler="0 0 20"><joint name="crank" axis="0 0 1" stiffness="150"/>
"""


def test_a_spring_behind_the_motor_is_a_joint_more(tmp_path: Path) -> None:
    """The drive's spring of joint_stiffness against the same one modelled as a body of its own."""
    short, joint = FOUR_BAR_TEXT, '<body name="crank" euler="0 0 20"><joint name="crank" '
    start = short.index(joint)
    end = short.index("/>", start) + 2
    text = short[:start] + ELASTIC.strip() + short[end:]
    text = text.replace('    <body name="rocker"', '    </body><body name="rocker"')
    text = text.replace('motor joint="crank"', 'motor joint="shaft"')
    text = text.replace('qpos="1 ', 'qpos="1 0 ')
    modelled = replace(robot_of(tmp_path, text), independent=("shaft", "crank"))
    plain = robot_of(tmp_path, short)
    gains = [30.0, 0.0, 0.0]
    given = drives(plain, joint_stiffness=[150.0, np.inf, np.inf], position_gain=gains)
    same = drives(modelled, position_gain=[30.0, 0.0, 0.0, 0.0])
    q = close_loops(plain, [1.1])
    n = ca.DM([0.6, 0.8, 0.0])
    ours = impact_model(plain, drives=given, gravity=GRAVITY).linear(q, n)
    theirs = impact_model(modelled, drives=same, gravity=GRAVITY).linear([1.1, 0.0, *q[1:]], n)
    assert_near(ours.mass.matrix, theirs.mass.matrix, 1e-7)
    assert_near(ours.stiffness, theirs.stiffness, 1e-9)
    assert_near(ours.jacobian, theirs.jacobian, 1e-9)


def test_computed_torque_gains_follow_the_motors_inertia() -> None:
    robot = load_robot("rmin")
    q = closed_chain(robot).home
    held = impact_model(robot, drives=drives(robot, computed_torque_gain=1076.0))
    free = impact_model(robot)
    added = np.array(held.generalised_stiffness(q) - free.generalised_stiffness(q))
    M0 = np.array(free.generalised_mass(q).matrix)
    assert_near(added[:2, :2], 1076.0 * M0[:2, :2], 1e-9)
    assert not added[2:].any()


def test_ends_that_never_meet(tmp_path: Path) -> None:
    with pytest.raises(LoopCannotClose, match=r"loop 'pin'.*0\.05 m apart.*\[0, 0, 1\]") as error:
        closed_chain(four_bar(tmp_path, lift="0.05"))
    assert error.value.loop == "pin"
    assert error.value.gap == pytest.approx(0.05)


def test_links_too_short_to_meet(tmp_path: Path) -> None:
    with pytest.raises(LoopCannotClose, match=r"'pin' does not close.*apart.*keyframe") as error:
        impact_model(four_bar(tmp_path, crank="0.05", length="0.1"))
    assert error.value.gap == pytest.approx(0.6 - 0.55)


def test_a_loop_given_twice_is_redundant(tmp_path: Path) -> None:
    again = '<connect name="again" site1="eye" site2="pin"/>'
    with pytest.raises(RedundantLoop, match="loop 'again' is redundant") as error:
        closed_chain(four_bar(tmp_path, equality=again))
    assert error.value.loop == "again"


def test_loops_close_on_sites_that_share_their_names_with_bodies(tmp_path: Path) -> None:
    text = FOUR_BAR_TEXT.replace('"pin"', '"crank"').replace('"eye"', '"rocker"')
    ours, theirs = robot_of(tmp_path, text), robot_of(tmp_path, FOUR_BAR_TEXT)
    (loop,) = ours.loops
    assert isinstance(loop, Loop)
    assert loop.first == "site:crank"
    assert_near(closed_chain(ours).home, closed_chain(theirs).home)


def test_one_crank_too_many_is_redundant(tmp_path: Path) -> None:
    with pytest.raises(RedundantLoop, match="loop 'third'"):
        closed_chain(four_bar(tmp_path, **THIRD_CRANK))
    assert closed_chain(four_bar(tmp_path, **PARALLELOGRAM)).independent == (0,)


def test_a_loop_that_always_holds_is_redundant(tmp_path: Path) -> None:
    on_axis = '<connect name="idle" body1="crank" body2="world" anchor="0 0 0.1"/>'
    with pytest.raises(RedundantLoop, match="'idle' holds whatever the joints do"):
        closed_chain(four_bar(tmp_path, equality=on_axis))


def test_an_inactive_loop_is_none(tmp_path: Path) -> None:
    text = FOUR_BAR_TEXT.replace('<connect name="pin"', '<connect name="pin" active="false"')
    assert not robot_of(tmp_path, text).loops


@pytest.mark.parametrize(
    ("names", "error", "reason"),
    [
        (("q11", "q21"), InvalidValue, "must name 4 joints"),
        (("q11", "q21", "q13", "q13"), InvalidValue, "must name 4 joints"),
        (("q11", "q21", "q13", "q99"), UnknownName, "q99.*q23"),
        (("q11", "q12", "q13", "q23"), InvalidValue, "leaves out 'q21', which has a motor"),
    ],
)
def test_wrong_names_of_independent_joints(
    names: tuple[str, ...], error: type[SoftImpactError], reason: str
) -> None:
    with pytest.raises(error, match=reason):
        closed_chain(replace(load_robot("rmin"), independent=names))


def test_a_keyframe_where_the_chain_is_stretched_is_told(tmp_path: Path) -> None:
    """Crank 0.2 and coupler 0.8 just reach the rocker's end at 0.6 + 0.4, all on a line."""
    with pytest.raises(RedundantLoop, match="keyframe where the mechanism is not singular"):
        closed_chain(four_bar(tmp_path, length="0.8", key="0 0 0"))


def test_joints_that_do_not_follow_from_those_named(tmp_path: Path) -> None:
    """With coupler and rocker on a line the crank cannot say which way they will fold."""
    crank = np.arccos((0.2**2 + 0.6**2 - 0.7**2) / (2 * 0.2 * 0.6))
    line = np.arctan2(-0.2 * np.sin(crank), 0.6 - 0.2 * np.cos(crank))
    key = f"{crank:.17g} {line - crank:.17g} {line + np.pi:.17g}"
    robot = four_bar(tmp_path, length="0.3", key=key)
    with pytest.raises(SingularLoop, match="'pin' does not decide coupler, rocker"):
        closed_chain(replace(robot, independent=("crank",)))
    assert closed_chain(robot).independent != (0,)


def test_elastic_joints_must_be_independent() -> None:
    robot = load_robot("rmin").with_armature(0.1 * np.ones(6))
    stiffness = [np.inf, 100.0, np.inf, np.inf, np.inf, np.inf]
    with pytest.raises(InvalidValue, match="'q12' follows from others through a loop"):
        impact_model(robot, drives=drives(robot, joint_stiffness=stiffness))
