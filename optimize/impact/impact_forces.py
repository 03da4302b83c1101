# SPDX-License-Identifier: BSD-3-Clause
"""The contact force over time of the linearised robot, as a differentiable expression.

The impact is integrated inside the expression, so that an NLP has no states: a leapfrog in link
and motor angles (explicit, second order, no 2n×2n algebra) around an implicit trapezoidal step for
the one stiff variable, the compression of the body.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from typing import Any, NamedTuple

import casadi as ca

from softimpact.symbolic import Contact, Matrix
from softimpact.symbolic.matrices import MatrixExpression

from .motor_laws import LAW, MotorLaws

NEWTON_STEPS = 4
"""Newton steps for the body's compression, from the value of the step before."""


ROUNDING = 1e-12
"""Depth [m] that rounds the force law at first touch, where its second derivative is unbounded."""


FEW_DIRECTIONS = {"max_num_dir": 2}
"""Derivative code for two directions at a time instead of all at once: compiles in a tenth of the
time and runs as fast."""


IN_A_ROW = 10
"""Calls that a function of several nodes is made of: that of ten, of a hundred, and so on."""


class ContactParameters(NamedTuple):
    """The contact as numbers or symbols: k_f, k_h, c_h and 1/m_h (zero for a clamped region)."""

    hertz_stiffness: Matrix
    region_stiffness: Matrix
    region_damping: Matrix
    region_mobility: Matrix

    @staticmethod
    def of(contact: Contact) -> ContactParameters:
        """Return a contact's numbers; raises InvalidValue if it does not follow Hertz's law."""
        region = contact.region
        mobility = 0.0 if contact.clamped else 1.0 / region.effective_mass
        return ContactParameters(
            contact.series_stiffness, region.stiffness, region.damping, mobility
        )


@dataclass(frozen=True, eq=False)
class ImpactDynamics:
    """The linearised robot in link angles x and motor angles θ, both since first touch.

    M ẍ = −k_s(x − θ) − D(ẋ − q̇0) − K_V x − J_cᵀ f_c, and B θ̈ = k_s(x − θ) + τ or a motion that is
    given; a servo has τ = −K_p(θ − q̇0 t) − K_d(θ̇ − q̇0). A passive joint's spring is one whose
    motor never moves: B⁻¹ = 0. Where a motor has no spring θ = x, and its rotor is part of M.

    Attributes:
        mobility: (M + h D/2)⁻¹ for time steps h, n×n; so a step with damping stays stable and
            exact to second order.
        jacobian: J_c, 1×n.
        springs: k_s, length n; zero where there is none.
        rotor_mobility: B⁻¹, length n; zero for what is no motor behind a spring.
        gains: K_p, n×n; sparse where it is structurally zero.
        damping: K_d, length n.
        velocity: q̇0 of links and motors at first touch, length n [rad/s].
        joint_damping: D, n×n; None where no joint damps.
        potential: K_V, curvature of the links' potential energy, n×n; None where there is none.
        rigid: places of motors without a spring.
        carried: how the coordinates follow such motors by a unit of velocity each, whose motion is
            given, n×r: M⁻¹ E (Eᵀ M⁻¹ E)⁻¹.
    """

    mobility: Matrix
    jacobian: Matrix
    springs: Matrix
    rotor_mobility: Matrix
    gains: Matrix
    damping: Matrix
    velocity: Matrix
    joint_damping: Matrix | None = None
    potential: Matrix | None = None
    rigid: tuple[int, ...] = ()
    carried: Matrix = ca.DM(0, 0)  # noqa: RUF009 - never changed


def contact_forces(
    dynamics: ImpactDynamics,
    contact: ContactParameters,
    laws: MotorLaws,
    step: Matrix,
    nodes: int,
    substeps: int,
) -> MatrixExpression:
    """Return the force at ``nodes`` equidistant times, length ``nodes`` [N], differentiable.

    Between contacts the force is zero and the body comes back; every contact counts.

    Args:
        dynamics: of the robot, MX expressions.
        contact: the contact, MX expressions or numbers.
        laws: what the motors do, MX expressions or numbers.
        step: time step [s]; 2/step must exceed the robot's largest angular frequency.
        nodes: number of forces returned.
        substeps: time steps from node to node.
    """
    D, K_V = dynamics.joint_damping, dynamics.potential
    given: list[Matrix] = [
        ca.vec(dynamics.mobility),
        dynamics.jacobian.T,
        dynamics.springs,
        dynamics.rotor_mobility,
        dynamics.damping,
        dynamics.velocity,
        *contact,
        step,
        _nonzeros(dynamics.gains),
        ca.vec(dynamics.carried),
        *([] if D is None else [_nonzeros(D)]),
        *([] if K_V is None else [ca.vec(K_V)]),
    ]
    parameters: MatrixExpression = ca.vertcat(*given)
    n = dynamics.springs.shape[0]
    damping = ca.Sparsity(n, n) if D is None else D.sparsity()
    patterns = (tuple(each.compress()) for each in (dynamics.gains.sparsity(), damping))
    steps = n, substeps, *patterns, dynamics.rigid, K_V is not None
    velocity: MatrixExpression = dynamics.velocity
    start = ca.vertcat(
        ca.MX.zeros(2 * n),
        velocity,
        velocity,
        ca.MX.zeros(len(BodyState._fields)),
    )
    motors: MatrixExpression = laws.at_nodes(step, substeps, nodes)
    _, forces = _in_a_row(nodes, *steps)(start, parameters, motors)
    return forces.T


@lru_cache(maxsize=64)
def _in_a_row(count: int, *steps: Any) -> ca.Function:
    """Return (state, parameters, laws, a column a node) -> the state after some nodes, and forces.

    CasADi's own ``mapaccum`` copies the parameters for each node, and keeps all states: half of the
    time.

    Args:
        count: of nodes.
        steps: arguments of ``_leapfrog``.
    """
    if count == 1:
        return _leapfrog(*steps)
    size = 1
    while size * IN_A_ROW < count:
        size *= IN_A_ROW
    state, parameters, _ = _leapfrog(*steps).mx_in()
    laws, forces = ca.MX.sym("laws", LAW, count), []
    after = state
    for begin in range(0, count, size):
        end = min(begin + size, count)
        after, force = _in_a_row(end - begin, *steps)(after, parameters, laws[:, begin:end])
        forces.append(force)
    found = [after, ca.horzcat(*forces)]
    return ca.Function(f"nodes_{count}", [state, parameters, laws], found, FEW_DIRECTIONS)


def _nonzeros(matrix: Matrix) -> Matrix:
    """Return the structurally nonzero entries as a dense column."""
    picked = [matrix[i, j] for i, j in zip(*matrix.sparsity().get_triplet(), strict=True)]
    return ca.vertcat(*picked) if picked else ca.DM(0, 1)


class BodyState(NamedTuple):
    """State of the body region during the impact, and the time.

    Attributes:
        position: of the effective mass that gives way behind the region [m].
        velocity: of that mass, half a step ahead [m/s].
        compression: of the region's spring [m].
        force: f_c [N].
        time: since first touch [s].
    """

    position: Matrix
    velocity: Matrix
    compression: Matrix
    force: Matrix
    time: Matrix


@lru_cache(maxsize=16)
def _leapfrog(
    n: int,
    steps: int,
    gains: tuple[int, ...],
    damping: tuple[int, ...],
    rigid: tuple[int, ...],
    has_potential: bool,
) -> ca.Function:
    """Return (state, parameters, what the motors do) -> state after some steps, and the force.

    The state is link angles, motor angles, their velocities half a step ahead, and the body's.
    ``gains`` and ``damping`` are the patterns of K_p and D, as ``casadi.Sparsity.compressed`` takes
    them.
    """
    patterns = ("K_p", gains), ("D", damping)
    state = ca.SX.sym("state", 4 * n + len(BodyState._fields))
    M_inv, j, k_s = ca.SX.sym("M_inv", n, n), ca.SX.sym("j", n), ca.SX.sym("k_s", n)
    B_inv, K_d, velocity = ca.SX.sym("B_inv", n), ca.SX.sym("K_d", n), ca.SX.sym("dq0", n)
    K_p, D = (ca.SX.sym(name, ca.Sparsity.compressed(list(pattern))) for name, pattern in patterns)
    law, K_V = ca.SX.sym("law", LAW), ca.SX.sym("K_V", *(2 * [n * has_potential]))
    contact = ContactParameters(*ca.vertsplit(ca.SX.sym("contact", 4)))
    h = ca.SX.sym("h")
    R, carried = list(rigid), ca.SX.sym("carried", n if rigid else 0, len(rigid))
    x, theta, dx, dtheta, rest = ca.vertsplit(state, [0, n, 2 * n, 3 * n, 4 * n, state.numel()])
    body = BodyState(*ca.vertsplit(rest))
    moves, share, servo = ca.vertsplit(law)
    for _ in range(steps):
        x, theta = x + h * dx, theta + h * dtheta
        body = _press(body, ca.dot(j, x), contact, h)
        pull = k_s * (x - theta)
        push = pull + j * body.force + ca.mtimes(D, dx - velocity)
        if has_potential:
            push = push + ca.mtimes(K_V, x)
        for i in R:
            theta[i], dtheta[i] = x[i], dx[i]
        torque = ca.mtimes(K_p, theta - velocity * body.time) + K_d * (dtheta - velocity)
        for i in R:
            push[i] += servo * torque[i]
        dx = dx - h * ca.mtimes(M_inv, push)
        if R:  # an impulse of the motors whose motion is given
            dx = dx + (1 - moves) * ca.mtimes(carried, share * velocity[R] - dx[R])
        moved = dtheta + h * B_inv * (pull - servo * torque)
        dtheta = moves * moved + (1 - moves) * share * velocity
    parameters = ca.vertcat(
        ca.vec(M_inv),
        j,
        k_s,
        B_inv,
        K_d,
        velocity,
        *contact,
        h,
        _nonzeros(K_p),
        ca.vec(carried),
        _nonzeros(D),
        ca.vec(K_V),
    )
    after = ca.vertcat(x, theta, dx, dtheta, *body)
    return ca.Function("leapfrog", [state, parameters, law], [after, body.force], FEW_DIRECTIONS)


def _press(body: BodyState, tip: Matrix, contact: ContactParameters, h: Matrix) -> BodyState:
    """Move the body by one step to where the robot's contact point is now."""
    position = body.position + h * body.velocity
    depth = tip - position
    k_f, k_h, c_h, mobility = contact
    drag = 2 * c_h / h
    # trapezoid: c_h ẏ = f_c − k_h y, with f_c = k_f (depth − y)₊^1.5 at the new time
    known = drag * body.compression + body.force - k_h * body.compression
    y = body.compression
    for _ in range(NEWTON_STEPS):
        skin = ca.fmax(depth - y, 0)
        root = ca.sqrt(skin + ROUNDING)
        residual = (drag + k_h) * y - k_f * skin * root - known
        y = y - residual / (drag + k_h + 1.5 * k_f * root)
    skin = ca.fmax(depth - y, 0)
    force = k_f * skin * ca.sqrt(skin + ROUNDING)
    return BodyState(position, body.velocity + h * mobility * force, y, force, body.time + h)
