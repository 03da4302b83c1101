# SPDX-License-Identifier: BSD-3-Clause
"""``softimpact analyze`` against dense NumPy on Pinocchio's matrices."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pinocchio as pin
import pytest
import scipy.linalg
from command_line import run, run_json
from oracles import example_urdf

from softimpact.symbolic.robot.rigid import Array

CONTRACT = {
    *("m_c", "k_r", "m_a", "chain", "giaf", "giif", "directional_giaf", "osim", "osim_free"),
    *("reflected_mass_rigid", "mass_matrix", "jacobian"),
}
UR5_Q = [0.3, -1.1, 1.4, -0.6, 0.9, 0.2]
PANDA_Q = [0.2, 0.3, -0.4, -1.8, 0.1, 2.0, 0.5]
PUSH = np.array([0.3, 0.8, -0.5])
ROTORS = [0.61, 0.61, 0.46, 0.46, 0.21, 0.21, 0.21]
SPRINGS = [9e3, 2e4, 5e3, 1e4, 3e3, 8e3, 4e3]


@dataclass
class Reference:
    """M, J and gravity's Hessian by Pinocchio, of a chain whose other joints are locked."""

    M: Array
    J: Array
    gravity: Array

    @staticmethod
    def of(
        path: Path, tip: str, q: list[float], joints: list[str], g: tuple[float, ...] = (0, 0, 0)
    ) -> Reference:
        whole = pin.buildModelFromUrdf(str(path))
        others = [whole.getJointId(name) for name in whole.names[1:] if name not in joints]
        model = pin.buildReducedModel(whole, others, pin.neutral(whole))
        assert list(model.names[1:]) == joints
        model.gravity.linear = np.array(g, dtype=float)
        data, angles = model.createData(), np.array(q)
        M = pin.crba(model, data, angles)
        pin.computeJointJacobians(model, data, angles)
        pin.updateFramePlacements(model, data)
        frame = model.getFrameId(tip)
        J = pin.getFrameJacobian(model, data, frame, pin.LOCAL_WORLD_ALIGNED)[:3]
        hessian = pin.computeGeneralizedGravityDerivatives(model, data, angles)
        return Reference(np.triu(M) + np.triu(M, 1).T, J, hessian)


def elastic(ref: Reference, n: Array, B: Array, k_s: Array, K_p: Array) -> dict[str, Any]:
    """Eq. 36-38 and the Lanczos chain with dense matrices, elastic joints throughout."""
    M, G = ref.M, ref.gravity
    M0 = np.block([[M + np.diag(B), M], [M, M]])
    K0 = np.block([[K_p + G, G], [G, np.diag(k_s) + G]])
    return reduced(M0, K0, np.tile(n @ ref.J, 2))


def reduced(M0: Array, K0: Array, J_c: Array) -> dict[str, Any]:
    W = np.linalg.inv(M0)
    m_c = float(1 / (J_c @ W @ J_c))
    mode = W @ J_c * m_c
    k_r = mode @ K0 @ mode
    J_a = scipy.linalg.null_space(mode[None, :]).T  # orthonormal rows with J_a J_c# = 0
    M_a = np.linalg.inv(J_a @ W @ J_a.T)
    to_a = W @ J_a.T @ M_a
    K_a = to_a.T @ K0 @ to_a
    m_a = k_r * np.sum(M_a * K_a) / np.sum(K_a * K_a)
    return {"m_c": m_c, "k_r": k_r, "m_a": m_a, "chain": lanczos(M0, K0, mode, m_c)}


def lanczos(M0: Array, K0: Array, mode: Array, m_c: float) -> dict[str, list[float]]:
    """Masses and springs from T = VᵀK0V, V M0-orthonormal from the contact mode."""
    L = np.linalg.cholesky(M0)
    A = np.linalg.solve(L, np.linalg.solve(L, K0).T)
    V = [L.T @ mode / np.sqrt(m_c)]
    for _ in range(2):
        w = A @ V[-1]
        for _ in range(2):
            w -= np.array(V).T @ (np.array(V) @ w)
        V.append(w / np.linalg.norm(w))
    T = np.array(V) @ A @ np.array(V).T
    mass, stiffness = [m_c], [T[0, 0] * m_c]
    for i in (1, 2):
        mass.append(stiffness[-1] ** 2 / (T[i, i - 1] ** 2 * mass[-1]))
        stiffness.append(T[i, i] * mass[-1] - stiffness[-1])
    return {"mass": mass, "stiffness": stiffness}


def assert_agrees(result: dict[str, Any], expected: dict[str, Any]) -> None:
    for key, value in expected.items():
        if isinstance(value, dict):
            assert_agrees(result[key], value)
        else:
            np.testing.assert_allclose(result[key], value, rtol=1e-9, atol=1e-12, err_msg=key)


def factors(ref: Reference, n: Array, B: Array) -> dict[str, Any]:
    """GIAF §II with dense matrices."""
    osim = np.linalg.inv(ref.J @ np.linalg.inv(ref.M + np.diag(B)) @ ref.J.T)
    free = np.linalg.inv(ref.J @ np.linalg.inv(ref.M) @ ref.J.T)
    ratio = free @ np.linalg.inv(osim)
    return {
        "osim": osim,
        "osim_free": free,
        "giaf": np.linalg.det(ratio),
        "giif": np.linalg.det(np.eye(3) - ratio),
        "directional_giaf": (n @ free @ n) / (n @ osim @ n),
        "reflected_mass_rigid": 1 / (n @ np.linalg.inv(osim) @ n),
        "mass_matrix": ref.M,
        "jacobian": ref.J,
    }


def ur5(g: tuple[float, ...] = (0, 0, 0)) -> Reference:
    joints = ["shoulder_pan_joint", "shoulder_lift_joint", "elbow_joint"]
    joints += [f"wrist_{i}_joint" for i in (1, 2, 3)]
    return Reference.of(example_urdf("ur5_robot.urdf"), "tool0", UR5_Q, joints, g)


def panda_urdf(g: tuple[float, ...] = (0, 0, 0)) -> Reference:
    joints = [f"panda_joint{i}" for i in range(1, 8)]
    return Reference.of(example_urdf("panda.urdf"), "panda_hand_tcp", PANDA_Q, joints, g)


def analyze_ur5(*options: object) -> dict[str, Any]:
    path = example_urdf("ur5_robot.urdf")
    given = ("--tip", "tool0", "--q", UR5_Q, "--direction", PUSH.tolist())
    return run_json("analyze", path, *given, *options)


def analyze_panda(*options: object) -> dict[str, Any]:
    path = example_urdf("panda.urdf")
    given = ("--tip", "panda_hand_tcp", "--q", PANDA_Q, "--direction", PUSH.tolist())
    return run_json("analyze", path, *given, *options)


UNIT = PUSH / np.linalg.norm(PUSH)


def test_rigid_ur5_has_a_mass_and_nothing_behind_it() -> None:
    result, ref = analyze_ur5(), ur5()
    assert set(result) >= CONTRACT
    assert_agrees(result, factors(ref, UNIT, np.zeros(6)))
    assert result["m_c"] == pytest.approx(result["reflected_mass_rigid"], rel=1e-12)
    assert result["giaf"] == pytest.approx(1, rel=1e-12)
    assert result["k_r"] is None
    assert result["m_a"] is None
    assert result["static_stiffness"] is None
    assert result["chain"] == {"mass": [pytest.approx(result["m_c"])], "stiffness": [0.0]}


def test_lists_need_no_brackets() -> None:
    options = ("--tip", "panda_hand_tcp", "--joint-stiffness", "1e4", "--rotor-inertia", "0.1")
    path = example_urdf("panda.urdf")
    bare = (",".join(str(x) for x in PANDA_Q), ",".join(str(x) for x in PUSH.tolist()))
    lists = (PANDA_Q, PUSH.tolist())
    typed = [
        run_json("analyze", path, "--q", q, "--direction", n, *options) for q, n in (bare, lists)
    ]
    assert typed[0] == typed[1]
    short = [
        run_json("analyze", path, "--q", PANDA_Q, "--direction", n, "--payload", load, *options)
        for n, load in (("-.5,1.,+0", "2@0,0,.1"), ([-0.5, 1, 0], "2@[0,0,0.1]"))
    ]
    assert short[0] == short[1]


def test_rotors_of_rigid_joints_are_felt() -> None:
    rotors = np.array(ROTORS[:6])
    result, ref = analyze_ur5("--rotor-inertia", ROTORS[:6]), ur5()
    assert_agrees(result, factors(ref, UNIT, rotors))
    assert result["m_c"] == pytest.approx(result["reflected_mass_rigid"], rel=1e-12)
    assert result["giaf"] < 0.9


@pytest.mark.parametrize("gravity", [(0, 0, 0), (1.2, -0.4, -9.81)])
@pytest.mark.parametrize("gain", [0.0, 700.0])
def test_elastic_panda(gravity: tuple[float, ...], gain: float) -> None:
    options = ["--joint-stiffness", SPRINGS, "--rotor-inertia", ROTORS, "--position-gain", gain]
    options += ["--gravity", list(gravity)] if any(gravity) else []
    result, ref = analyze_panda(*options), panda_urdf(gravity)
    B, k_s = np.array(ROTORS), np.array(SPRINGS)
    assert set(result) >= CONTRACT
    assert_agrees(result, factors(ref, UNIT, B))
    assert_agrees(result, elastic(ref, UNIT, B, k_s, gain * np.eye(7)))
    assert result["m_c"] == pytest.approx(1 / (UNIT @ np.linalg.inv(result["osim_free"]) @ UNIT))


def test_gravity_changes_the_stiffness_but_no_mass() -> None:
    springs = ("--joint-stiffness", 300, "--rotor-inertia", 0.3)
    without, hanging = analyze_panda(*springs), analyze_panda(*springs, "--gravity", [0, 0, -9.81])
    assert hanging["m_c"] == without["m_c"]
    assert abs(hanging["k_r"] / without["k_r"] - 1) > 1e-4


def test_position_gains_alone_make_the_motors_springs() -> None:
    gains = [3e3, 2e3, 1e3, 900, 500, 400]
    result, ref = analyze_ur5("--position-gain", gains, "--rotor-inertia", 0.2), ur5()
    M0 = ref.M + 0.2 * np.eye(6)
    J_c = UNIT @ ref.J
    assert_agrees(result, reduced(M0, np.diag(gains), J_c))
    k_c = 1 / (J_c @ np.diag(1 / np.array(gains)) @ J_c)
    assert result["static_stiffness"] == pytest.approx(k_c, rel=1e-9)


def test_computed_torque_gain_multiplies_the_motor_block() -> None:
    springs = ("--joint-stiffness", 1e4, "--rotor-inertia", 0.3)
    result, ref = analyze_panda(*springs, "--computed-torque-gain", 6050), panda_urdf()
    B = np.full(7, 0.3)
    K_p = 6050 * (ref.M + np.diag(B))
    assert_agrees(result, elastic(ref, UNIT, B, np.full(7, 1e4), K_p))


def test_gear_ratios_square_the_motors_inertia() -> None:
    ratio = [50, 101, -80, 100, 60, 90]
    geared = analyze_ur5("--rotor-inertia", 1e-5, "--gear-ratio", ratio)
    reflected = analyze_ur5("--rotor-inertia", [1e-5 * N**2 for N in ratio])
    assert_agrees(geared, {key: reflected[key] for key in ("m_c", "giaf", "osim")})
    assert_agrees(geared, factors(ur5(), UNIT, 1e-5 * np.square(ratio)))


def test_some_joints_may_be_rigid() -> None:
    """Eq. 36-37 do not depend on coordinates: rigid is the limit of ever stiffer springs."""
    rotors = ("--rotor-inertia", 0.3)
    mixed = analyze_panda(*rotors, "--joint-stiffness", "[1e4, inf, 1e4, Infinity, 1e4, 1e4, 1e4]")
    ref, E = panda_urdf(), [0, 2, 4, 5, 6]
    M0 = np.block([[ref.M + 0.3 * np.eye(7), ref.M[:, E]], [ref.M[E, :], ref.M[np.ix_(E, E)]]])
    K0 = np.diag([0.0] * 7 + [1e4] * 5)
    row = UNIT @ ref.J
    assert_agrees(mixed, reduced(M0, K0, np.concatenate([row, row[E]])))
    assert analyze_panda(*rotors, "--joint-stiffness", "inf")["k_r"] is None


def test_an_arm_of_a_branched_robot_is_its_reduced_model() -> None:
    joints = [f"left_{name}" for name in ("s0", "s1", "e0", "e1", "w0", "w1", "w2")]
    q, path = [0.2, -0.5, 0.4, 1.1, -0.3, 0.8, 0.1], example_urdf("baxter.urdf")
    options = ("--joint-stiffness", 5e3, "--rotor-inertia", 0.2, "--direction", PUSH.tolist())
    result = run_json("analyze", path, "--tip", "left_gripper", "--q", q, *options)
    ref = Reference.of(path, "left_gripper", q, joints)
    assert result["joints"] == joints
    assert_agrees(result, factors(ref, UNIT, np.full(7, 0.2)))
    springs = np.full(7, 5e3)
    assert_agrees(result, elastic(ref, UNIT, np.full(7, 0.2), springs, np.zeros((7, 7))))


def test_planar_robot_has_no_3x3_factors() -> None:
    """rr: what print gives for scenario a is tested in papers/; here the shape of the answer."""
    result = run_json("analyze", "rr", "--q", "[0.3, 0, 0.7, 0]", "--direction", "[0, 1, 0]")
    for key in ("osim", "osim_free", "giaf", "giif", "directional_giaf"):
        assert result[key] is None
    assert result["k_r"] > 0
    assert len(result["chain"]["mass"]) == len(result["chain"]["stiffness"]) == 3


def test_chain_has_the_order_asked_for_and_ends_where_it_closes() -> None:
    springs = ("--joint-stiffness", 1e4, "--rotor-inertia", 0.3)
    five, three = analyze_panda(*springs, "--order", 5), analyze_panda(*springs)
    assert len(five["chain"]["mass"]) == 5
    assert_agrees({"m": five["chain"]["mass"][:3]}, {"m": three["chain"]["mass"]})
    longest = run_json(
        *("analyze", "rr", "--q", "[0.3, 0, 0.7, 0]", "--direction", "[0, 1, 0]", "--order", 40)
    )
    assert len(longest["chain"]["mass"]) == 3  # two springs join at most three masses


def test_named_rotor_inertias_and_the_files_own() -> None:
    where = ("--q", PANDA_Q, "--direction", "[0, 1, 0]")
    by_name = run_json("analyze", "panda", *where, "--rotor-inertia", "menagerie_fr3")
    typed = run_json(
        *("analyze", "panda", *where),
        *("--rotor-inertia", "[0.195, 0.195, 0.195, 0.195, 0.074, 0.074, 0.074]"),
    )
    default = run_json("analyze", "panda", *where)
    files = run_json("analyze", "panda", *where, "--rotor-inertia", "drake_fr3")
    assert by_name == typed
    assert default["osim"] == files["osim"]
    assert default["giaf"] < by_name["giaf"]


def test_motor_angles_sag_under_gravity() -> None:
    gravity = ("--gravity", "[0, 0, -9.81]")
    options = ("--joint-stiffness", 2e3, "--rotor-inertia", 0.3)
    sagged = analyze_panda(*options, "--motor-angles", *gravity)
    q, theta = np.array(sagged["q"]), np.array(PANDA_Q)
    model = pin.buildModelFromUrdf(str(example_urdf("panda.urdf")))
    full = np.concatenate([q, np.zeros(2)])
    torques = pin.computeGeneralizedGravity(model, model.createData(), full)[:7]
    np.testing.assert_allclose(2e3 * (q - theta), -torques, atol=1e-6)
    assert abs(q - theta).max() > 1e-3
    assert analyze_panda(*options, "--motor-angles")["q"] == PANDA_Q


def test_rigid_joints_do_not_sag() -> None:
    springs = '[2e3, "inf", 2e3, 2e3, 2e3, 2e3, 2e3]'
    options = ("--joint-stiffness", springs, "--rotor-inertia", 0.3, "--motor-angles")
    sagged = analyze_panda(*options, "--gravity", "[0, 0, -9.81]")
    assert sagged["q"][1] == PANDA_Q[1]
    assert abs(sagged["q"][3] - PANDA_Q[3]) > 1e-3


def test_a_servo_without_gains_is_refused() -> None:
    where = ("analyze", "panda", "--q", PANDA_Q, "--direction", "[0, 1, 0]", "--motors", "servo")
    outcome = run(*where)
    assert outcome.code == 2
    assert "'servo' needs position_gain: the file has no servo" in outcome.err
    assert run(*where, "--position-gain", 1e3).code == 0


def test_direction_needs_no_unit_length() -> None:
    where = ("analyze", "panda", "--q", PANDA_Q, "--joint-stiffness", 1e4)
    short = run_json(*where, "--direction", "[0, 1e-3, 0]")
    assert short == run_json(*where, "--direction", "[0, 1, 0]")


def test_tables_for_people() -> None:
    outcome = run("analyze", "panda", "--q", PANDA_Q, "--direction", "[0, 1, 0]")
    assert (outcome.code, outcome.err) == (0, "")
    for word in ("m_c", "k_r", "GIAF", "kg", "N/m", "–"):
        assert word in outcome.out
