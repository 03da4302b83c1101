# SPDX-License-Identifier: BSD-3-Clause
"""Write M(q) and J(q) of a URDF as adam and urdf2casadi see them, as serialised CasADi functions.

Usage: PYTHON others.py URDF FOLDER, with a Python that has both: urdf2casadi demands another CasADi
and NumPy than we do, so they live in an environment of their own (``requirements.txt``).
"""

from __future__ import annotations

import sys
from pathlib import Path
from typing import Any

import adam.casadi
import casadi as ca
import urdf2casadi.urdfparser

BASE, TIP = "base", "tip"


def by_adam(urdf: str, joints: list[str], q: Any) -> tuple[Any, Any]:
    """Return M and the translational J; the floating base stands still at the origin."""
    arm = adam.casadi.KinDynComputations(urdf, joints)
    M = arm.mass_matrix_fun()(ca.SX.eye(4), q)[6:, 6:]
    J = arm.jacobian_fun(TIP)(ca.SX.eye(4), q)[:3, 6:]
    return M, J


def by_urdf2casadi(urdf: str, q: Any) -> tuple[Any, Any]:
    """Return M and the translational J, which is the derivative of its forward kinematics."""
    arm = urdf2casadi.urdfparser.URDFparser()
    arm.from_string(urdf)
    M = arm.get_inertia_matrix_crba(BASE, TIP)(q)
    position = arm.get_forward_kinematics(BASE, TIP)["T_fk"](q)[:3, 3]
    return M, ca.jacobian(position, q)


def main() -> None:
    path, folder = Path(sys.argv[1]), Path(sys.argv[2])
    urdf = path.read_text(encoding="utf-8")
    joints = [f"joint{i}" for i in range(urdf.count('type="revolute"'))]
    q = ca.SX.sym("q", len(joints))
    for name, (M, J) in {
        "adam": by_adam(str(path), joints, q),
        "urdf2casadi": by_urdf2casadi(urdf, q),
    }.items():
        ca.Function(name, [q], [ca.densify(M), ca.densify(J)]).save(str(folder / f"{name}.casadi"))


if __name__ == "__main__":
    main()
