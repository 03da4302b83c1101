# SPDX-License-Identifier: BSD-3-Clause
"""Second opinions on a robot's dynamics: Pinocchio and MuJoCo, in the robot's joint order."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import mujoco
import numpy as np
import pinocchio as pin
from numpy.typing import ArrayLike

from softimpact.symbolic import Matrix, Robot
from softimpact.symbolic.robot.rigid import Array
from softimpact.symbolic.robot.robot import BASE, JointKind

URDFS = Path(pin.__file__).parents[4] / "share/example-robot-data/robots"
"""Folder of the example robots' URDF files."""

TOLERANCE = 1e-10
"""Relative error that may separate us from an oracle."""


def example_urdf(name: str) -> Path:
    """Return the path of an example robot by its file's name."""
    (path,) = URDFS.rglob(name)
    return path


def configurations(robot: Robot, count: int, seed: int = 0) -> Iterator[Array]:
    """Yield random configurations inside the limits (or a turn, where there are none)."""
    lower, upper = (np.clip(bound, -np.pi, np.pi) for bound in robot.limits)
    random = np.random.default_rng(seed)
    for _ in range(count):
        yield random.uniform(lower, upper)


def assert_near(ours: object, theirs: object, tolerance: float = TOLERANCE) -> None:
    """Compare with the largest entry as scale."""
    a, b = np.asarray(ours, dtype=float), np.asarray(theirs, dtype=float)
    if a.ndim != b.ndim:  # CasADi has no vectors
        a, b = a.ravel(), b.ravel()
    assert a.shape == b.shape
    scale = abs(b).max(initial=0.0)
    np.testing.assert_allclose(a, b, rtol=0, atol=tolerance * (scale if scale > 1e-9 else 1.0))


def column(matrix: Matrix) -> Array:
    """Return CasADi's numbers as a vector."""
    return np.array(matrix, dtype=float).ravel()


class Pinocchio:
    """Pinocchio's model of a robot; sorts joints and turns of continuous joints as we do."""

    def __init__(self, model: pin.Model, robot: Robot) -> None:
        self.model, self.data, self.robot = model, model.createData(), robot
        self.joints = [model.joints[model.getJointId(name)] for name in robot.joint_names]
        self.order = [joint.idx_v for joint in self.joints]

    @staticmethod
    def of_urdf(path: Path, robot: Robot) -> Pinocchio:
        """Let Pinocchio read the file itself."""
        return Pinocchio(pin.buildModelFromUrdf(str(path)), robot)

    @staticmethod
    def of_robot(robot: Robot) -> Pinocchio:
        """Build a robot joint by joint (for robots that no file describes)."""
        model = pin.Model()
        indices = {BASE: 0}
        for i in _depth_first(robot):  # Pinocchio wants every subtree in one piece
            joint = robot.joints[i]
            kind = pin.JointModelRZ() if joint.kind is JointKind.HINGE else pin.JointModelPZ()
            place = pin.SE3(np.array(joint.placement.rotation), joint.placement.translation)
            index = model.addJoint(indices[joint.parent], kind, place, joint.name)
            indices[i] = index
            body, com = joint.inertia, joint.inertia.first_moment / joint.inertia.mass
            steiner = body.mass * (com @ com * np.eye(3) - np.outer(com, com))
            inertia = pin.Inertia(body.mass, com, body.about_origin - steiner)
            model.appendBodyToJoint(index, inertia, pin.SE3.Identity())
        for frame in robot.frames.values():
            place = pin.SE3(np.array(frame.placement.rotation), frame.placement.translation)
            carrier = indices[frame.joint]
            model.addFrame(pin.Frame(frame.name, carrier, place, pin.FrameType.BODY))
        return Pinocchio(model, robot)

    def configuration(self, q: Array) -> Array:
        """Return Pinocchio's configuration: its order, and cosine and sine where it has them."""
        found = np.array(pin.neutral(self.model))
        for joint, angle in zip(self.joints, q, strict=True):
            values = [angle] if joint.nq == 1 else [np.cos(angle), np.sin(angle)]
            found[joint.idx_q : joint.idx_q + joint.nq] = values
        return found

    def mass_matrix(self, q: Array) -> Array:
        """Return M."""
        found = pin.crba(self.model, self.data, self.configuration(q))
        upper = np.triu(found.reshape(self.model.nv, self.model.nv))
        full = upper + np.triu(upper, 1).T
        return np.asarray(full[np.ix_(self.order, self.order)])

    def bias(self, q: Array, velocity: Array, gravity: ArrayLike) -> Array:
        """Return gravity, Coriolis and centrifugal torques."""
        self.model.gravity.linear = np.array(gravity)
        v = np.zeros(self.model.nv)
        v[self.order] = velocity
        torques = pin.rnea(self.model, self.data, self.configuration(q), v, 0 * v)
        return np.asarray(torques[self.order])

    def jacobian(self, frame: str, q: Array) -> Array:
        """Return the 6×n Jacobian in the base's axes."""
        index = self._frame(frame)
        pin.computeJointJacobians(self.model, self.data, self.configuration(q))
        pin.updateFramePlacements(self.model, self.data)
        axes = pin.LOCAL_WORLD_ALIGNED
        J = pin.getFrameJacobian(self.model, self.data, index, axes)
        return np.asarray(J.reshape(6, self.model.nv)[:, self.order])

    def pose(self, frame: str, q: Array) -> pin.SE3:
        """Return the pose of a frame in the base."""
        pin.forwardKinematics(self.model, self.data, self.configuration(q))
        return pin.updateFramePlacement(self.model, self.data, self._frame(frame))

    def _frame(self, name: str) -> int:
        return int(self.model.getFrameId(name, pin.FrameType.BODY))


class FreeFlyer:
    """Pinocchio's model of a file behind a free-flyer, with joints in the robot's order.

    Configurations are (p, x, y, z, w, q), velocities (v, ω, q̇) in the base's axes.
    """

    def __init__(self, path: Path, robot: Robot) -> None:
        self.model = pin.buildModelFromUrdf(str(path), pin.JointModelFreeFlyer())
        self.data = self.model.createData()
        joints = [self.model.joints[self.model.getJointId(name)] for name in robot.joint_names]
        self.v_order = [*range(6), *(joint.idx_v for joint in joints)]
        self.q_order = [*range(7), *(joint.idx_q for joint in joints)]

    def configuration(self, ours: Array) -> Array:
        """Return a configuration in Pinocchio's order."""
        theirs = np.zeros(self.model.nq)
        theirs[self.q_order] = ours
        return theirs

    def velocity(self, ours: Array | float) -> Array:
        """Return a velocity in Pinocchio's order."""
        theirs = np.zeros(self.model.nv)
        theirs[self.v_order] = ours
        return theirs

    def mass_matrix(self, q: Array) -> Array:
        """Return M."""
        upper = np.triu(pin.crba(self.model, self.data, self.configuration(q)))
        full = upper + np.triu(upper, 1).T
        return np.asarray(full[np.ix_(self.v_order, self.v_order)])

    def bias(self, q: Array, velocity: Array, gravity: ArrayLike) -> Array:
        """Return gravity, Coriolis and centrifugal forces."""
        self.model.gravity.linear = np.array(gravity)
        state = (self.configuration(q), self.velocity(velocity), self.velocity(0.0))
        return np.asarray(pin.rnea(self.model, self.data, *state)[self.v_order])

    def jacobian(self, frame: str, q: Array) -> Array:
        """Return the 6×(6+n) Jacobian in the world's axes."""
        index = self.model.getFrameId(frame)
        pin.computeJointJacobians(self.model, self.data, self.configuration(q))
        pin.updateFramePlacements(self.model, self.data)
        J = pin.getFrameJacobian(self.model, self.data, index, pin.LOCAL_WORLD_ALIGNED)
        return np.asarray(J[:, self.v_order])

    def pose(self, frame: str, q: Array) -> pin.SE3:
        """Return the pose of a frame in the world."""
        pin.forwardKinematics(self.model, self.data, self.configuration(q))
        return pin.updateFramePlacement(self.model, self.data, self.model.getFrameId(frame))


def _depth_first(robot: Robot, parent: int = BASE) -> Iterator[int]:
    for i, joint in enumerate(robot.joints):
        if joint.parent == parent:
            yield i
            yield from _depth_first(robot, i)


class Mujoco:
    """MuJoCo's own dynamics of an MJCF text or file."""

    def __init__(self, source: str | Path) -> None:
        if isinstance(source, Path):
            self.model = mujoco.MjModel.from_xml_path(str(source))
        else:
            self.model = mujoco.MjModel.from_xml_string(source)
        self.data = mujoco.MjData(self.model)

    def at(self, q: Array, velocity: Array | None = None) -> Mujoco:
        """Compute everything at a state."""
        self.data.qpos[:] = q
        self.data.qvel[:] = 0 if velocity is None else velocity
        mujoco.mj_forward(self.model, self.data)
        return self

    def mass_matrix(self) -> Array:
        """Return M with armature."""
        full = np.zeros((self.model.nv, self.model.nv))
        mujoco.mj_fullM(self.model, self.data, full)
        return full

    def bias(self) -> Array:
        """Return gravity, Coriolis and centrifugal torques."""
        return np.array(self.data.qfrc_bias)

    def spring_torques(self) -> Array:
        """Return what the joints' springs exert."""
        return np.array(self.data.qfrc_spring)

    def site_jacobian(self, name: str) -> Array:
        """Return the 6×n Jacobian of a site."""
        J = np.zeros((6, self.model.nv))
        mujoco.mj_jacSite(self.model, self.data, J[:3], J[3:], self.model.site(name).id)
        return J

    def site_position(self, name: str) -> Array:
        """Return where a site is."""
        return np.array(self.data.site(name).xpos)
