# SPDX-License-Identifier: BSD-3-Clause
"""Robots whose base moves freely: legged robots, and arms on a mobile mass.

A configuration is (p, x, y, z, w, q): position of the base [m], its orientation as a unit
quaternion whose scalar comes last, and the joints' coordinates. A velocity is (v, ω, q̇): linear and
angular velocity of the base's origin in the base's own axes, and the joints' velocities. Both are
Pinocchio's conventions for a free-flyer. (MuJoCo has the scalar first, and v in the world's axes.)

Along the base's own axes a free joint moves like three slides followed by three hinges, all at
zero: the fixed robot with these six joints at its root has the same mass matrix and Jacobian.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import casadi as ca
import numpy as np
from numpy.typing import ArrayLike

from ..dynamics.equations_of_motion import STANDARD_GRAVITY, Gravity, bias_torques, mass_matrix
from ..dynamics.kinematics import FramePose, cross, frame_jacobian, frame_pose
from ..errors import InvalidInertia, MasslessBase
from ..former_names import renamed
from ..matrices import Matrix
from ..robot.plausibility import require_sound_masses
from ..robot.rigid import Inertia, Placement
from ..robot.robot import Joint, JointKind, Robot
from ..robot.welding import lock_joints
from .drives import Drives
from .drives import drives as drives_with
from .impact_model import ImpactModel, impact_model

BASE_COORDINATES = 6
"""Number of the base's velocity coordinates."""

BASE_JOINTS = tuple(f"base:{name}" for name in ("x", "y", "z", "roll", "pitch", "yaw"))
"""Names of the joints that stand for the free joint."""

X_TO_Z = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
"""Cyclic change of axes: a joint's axis z lies along its parent's x."""


@dataclass(frozen=True, eq=False)
class FloatingRobot:
    """A robot on a free base.

    Attributes:
        fixed: the robot, its base held.
        freed: the same with ``BASE_JOINTS`` before its own; they must stay at zero.
    """

    fixed: Robot
    freed: Robot

    @property
    def n(self) -> int:
        """Number of joints, without the free one."""
        return self.fixed.n

    def coordinates(self, q: Matrix) -> Matrix:
        """Return the coordinates of ``freed`` for joint coordinates q of any matrix kind."""
        return ca.vertcat(ca.DM.zeros(BASE_COORDINATES), q)

    def mass_matrix(self, q: Matrix) -> Matrix:
        """Return M without rotors over (v, ω, q̇), (6+n)×(6+n); only the joints' q matters."""
        return mass_matrix(self.freed, self.coordinates(q))

    def frame_pose(self, frame: str, configuration: Matrix) -> FramePose:
        """Return the pose of a frame in the world; raises FrameNotFound.

        Args:
            frame: its name.
            configuration: (p, x, y, z, w, q), length 7 + n.
        """
        position, R, q = _parted(configuration)
        seen = frame_pose(self.fixed, frame, q)
        return FramePose(ca.mtimes(R, seen.rotation), position + ca.mtimes(R, seen.position))

    def frame_jacobian(self, frame: str, configuration: Matrix) -> Matrix:
        """Return the 6×(6+n) Jacobian of a frame's origin, linear rows first, world axes.

        Args:
            frame: its name; raises FrameNotFound.
            configuration: (p, x, y, z, w, q), length 7 + n.
        """
        _, R, q = _parted(configuration)
        J = frame_jacobian(self.freed, frame, self.coordinates(q))
        return ca.vertcat(ca.mtimes(R, J[:3, :]), ca.mtimes(R, J[3:, :]))

    def bias_torques(
        self, configuration: Matrix, velocity: Matrix, gravity: Gravity = STANDARD_GRAVITY
    ) -> Matrix:
        """Return the forces h of gravity, Coriolis and centrifugal forces, length 6 + n.

        They hold the robot where (v, ω, q̇) does not change.

        Args:
            configuration: (p, x, y, z, w, q), length 7 + n.
            velocity: (v, ω, q̇), length 6 + n.
            gravity: acceleration along the world's axes [m/s²].
        """
        _, R, q = _parted(configuration)
        v, w = velocity[:3], velocity[3:6]
        still = (0.0, 0.0, 0.0)
        coriolis = bias_torques(self.freed, self.coordinates(q), velocity, still)
        # Constant v and ω are these accelerations of the slides and hinges; gravity is one more.
        linear = cross(w, v) - ca.mtimes(R.T, ca.DM(list(gravity)))
        angular = ca.vertcat(-w[1] * w[2], w[0] * w[2], -w[0] * w[1])
        moved = ca.mtimes(self.mass_matrix(q)[:, :6], ca.vertcat(linear, angular))
        return coriolis + moved

    def rate(self, configuration: Matrix, velocity: Matrix) -> Matrix:
        """Return the time derivative of (p, x, y, z, w, q), length 7 + n."""
        _, R, _ = _parted(configuration)
        xyz, scalar = configuration[3:6], configuration[6]
        w = velocity[3:6]
        turned = (scalar * w + cross(xyz, w)) / 2
        return ca.vertcat(ca.mtimes(R, velocity[:3]), turned, -ca.dot(xyz, w) / 2, velocity[6:])


def rotation_of(quaternion: Matrix) -> Matrix:
    """Return the rotation matrix of a unit quaternion (x, y, z, w), 3×3."""
    x, y, z, w = (quaternion[i] for i in range(4))
    return ca.blockcat(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def _parted(configuration: ArrayLike) -> tuple[Matrix, Matrix, Matrix]:
    """Position, rotation and joint coordinates of a configuration."""
    values: Matrix = configuration
    if isinstance(configuration, (np.ndarray, list, tuple)):
        values = ca.DM(configuration)
    return values[:3], rotation_of(values[3:7]), values[7:]


def floating_robot(robot: Robot, base_inertia: Inertia | None = None) -> FloatingRobot:
    """Return a robot with its base set free.

    Args:
        robot: any robot; its base keeps what is fixed to it.
        base_inertia: of the base in its frame, instead of the robot's own.

    Raises:
        MasslessBase: the base has no mass, so that it could move without any effort.
    """
    require_sound_masses(robot)
    inertia = robot.base_inertia if base_inertia is None else base_inertia
    if inertia.missing:
        raise InvalidInertia(robot.source or robot.name, "base", "; ".join(inertia.missing))
    if not inertia.mass > 0:
        raise MasslessBase(robot.name)
    shift = BASE_COORDINATES
    own = tuple(replace(joint, parent=joint.parent + shift) for joint in robot.joints)
    frames = {
        name: replace(frame, joint=frame.joint + shift) for name, frame in robot.frames.items()
    }
    sets = {name: (0.0,) * shift + values for name, values in robot.rotor_inertia_sets.items()}
    joints = _free_joint(inertia) + own
    freed = replace(robot, joints=joints, frames=frames, rotor_inertia_sets=sets)
    return FloatingRobot(robot, replace(freed, base_inertia=Inertia.zero()))


def is_floating(robot: Robot) -> bool:
    """Return whether a robot begins with the joints that stand for a free base."""
    return robot.joint_names[:BASE_COORDINATES] == BASE_JOINTS


def base_held(model: ImpactModel) -> ImpactModel:
    """Return a floating model with its base held where it is: heavier for all that it hits."""
    held = lock_joints(model.robot, dict.fromkeys(BASE_JOINTS, 0.0))
    own, shift = model.drives, BASE_COORDINATES
    damping, limits, known = own.damping_gains, own.torque_limits, own.rotors_known
    cut = Drives(
        own.rotors[shift:],
        own.springs[shift:],
        own.elastic[shift:],
        own.gains[shift:],
        own.computed_torque_gain,
        None if damping is None else damping[shift:],
        None if limits is None else limits[shift:],
        None if known is None else known[shift:],
    )
    return impact_model(held, model.tip, drives=cut, gravity=model.gravity)


def _free_joint(inertia: Inertia) -> tuple[Joint, ...]:
    """Slides along x, y and z, then hinges about them; each frame's z is the joint's axis."""
    joints = []
    along_z = np.eye(3)  # axes of the joint before, in the base's
    for i, name in enumerate(BASE_JOINTS):
        axes = np.linalg.matrix_power(X_TO_Z, (i % 3) + 1)
        placement = Placement(along_z.T @ axes, np.zeros(3))
        along_z = axes
        kind = JointKind.SLIDE if i < 3 else JointKind.HINGE
        joints.append(Joint(name, kind, i - 1, placement, Inertia.zero(), actuated=False))
    return (*joints[:-1], replace(joints[-1], inertia=inertia))


@renamed(drives_="drives")
def floating_model(
    robot: FloatingRobot, tip: str | None = None, *, drives: Drives | None = None
) -> ImpactModel:
    """Return the impact model of a floating robot.

    Its methods take ``robot.coordinates(q)`` and directions in the base's axes; its mass matrix
    and Jacobians begin with the base's six coordinates (v, ω).

    Args:
        robot: with its base free.
        tip: contact frame; default the robot's own; raises FrameNotFound.
        drives: of its joints, without the base; default rigid joints with the file's armature.
    """
    own = drives or drives_with(robot.fixed)
    none = ca.DM.zeros(BASE_COORDINATES)
    damping, limits, known = own.damping_gains, own.torque_limits, own.rotors_known
    padded = Drives(
        ca.vertcat(none, own.rotors),
        ca.vertcat(none, own.springs),
        (False,) * BASE_COORDINATES + own.elastic,
        ca.vertcat(none, own.gains),
        own.computed_torque_gain,
        None if damping is None else ca.vertcat(none, damping),
        None if limits is None else np.concatenate([np.full(BASE_COORDINATES, np.inf), limits]),
        None if known is None else (True,) * BASE_COORDINATES + known,
    )
    return impact_model(robot.freed, tip, drives=padded)
