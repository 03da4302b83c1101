# SPDX-License-Identifier: BSD-3-Clause
"""An impact as the generated C integrates it, and the same with fine steps as its reference.

The robot is a sum of modes that only meet in the contact force, so that for a force that is
quadratic between nodes each mode's step is exact, however fast the mode is: a leapfrog with its
own coefficients. Forces are implicit; with u = √δ of the skin they follow from a cubic. The node
x_0 between skin and body is a backward difference (order 3), which no damping makes unstable.

Modes so fast that they stand, bent by the force of the moment, are a spring beside the body's.

The first nodes are ``2**LEVELS`` times closer, as the force starts like t^1.5 or with a jump c_h v;
then spacing doubles. Everything is computed for an approach of 1 m/s: speed only scales the skin.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np

from .tridiagonal import Numbers, eigen_rows, sharpened

LEVELS = 3
"""How often spacing doubles after the first nodes."""

FIRST_NODES, NODES = 1, 2
"""Nodes after the first at the closest spacing, and at each of the others but the last."""

CONTACT_STEP = 0.24
"""Most radians in a step of the vibration of the contact point, held by body and robot."""

MODE_STEP = 1.6
"""Most radians of the fastest mode in a step."""

ROUGH_CONTACT_STEP, ROUGH_MODE_STEP = 0.48, 2.8
"""The same of rough steps, which find about the speed that the others are needed at."""

STANDS = 3e-5
"""Share of the displacement below which a mode's own motion counts as none."""

STEPS = 1024
"""Most nodes of an impact."""

REFERENCE_STEPS = 2**20
"""The same with finer steps, so many that references end where C does not."""

HALLEY, CLOSE = 32, 0.03
"""Most iterations for a force, and the relative change after which the next would be nothing."""

TRIALS = 16
"""Most impacts integrated for one safe speed; two do, the first of them in rough steps."""

AIM = 0.998
"""Share of the limit at which a safe speed aims, for the sake of what integration may be off by."""

LONG, AIM_IF_LONG = 52, 0.996
"""Nodes in rough steps above which all impacts of a safe speed are integrated in these, and the
share of the limit at which it then aims."""

NEAR, REACH = 3e-3, 1 / 32
"""How near its aim, as a share of it, an impact must come for the force to be proportional to
speed; how much farther off it may be where the last one's force tells the exponent of a power law,
as a share of the distance to that or of the aim, whichever is less."""

EXPONENT, EXPONENTS, APART = 1.025, (0.95, 1.15), 0.05
"""Usual exponent of the force over speed; those there are, others being of a peak that jumps; and
how far apart two forces must be to tell it."""

LARGE, LATER, GRAZES = 0.8, 1.1, 0.15
"""Impacts at about the same speed may be left after 1.1 times the time when one's force was last
0.8 of its peak, unless it parts by less than 0.15 of its depth in the last step."""

GUESS, SLOW = 1.05, 1.5
"""First guess of a safe speed over that of its simple model, and the squared frequency, over the
contact's, at which a mode counts half there; neither changes what is found."""

LINEAR = (1 / 6, -1 / 120, 1 / 5040)
"""(θ − sin θ)/θ³ over θ²: what a force that grows linearly does to a mode in a step."""

QUADRATIC = (1 / 12, -1 / 360, 1 / 20160, -1 / 1814400)
"""(θ² − 2 + 2 cos θ)/θ⁴ over θ²: the share α of both ends of two steps."""

BACKWARD = ((1.5, 2.0, -0.5, 0.0), (11 / 6, 3.0, -1.5, 1 / 3))
"""Weights of x_0 at the new node and, with the sign turned, at those before it."""


@dataclass(frozen=True, eq=False)
class Modes:
    """A robot by its modes, for an approach of 1 m/s.

    Attributes:
        squared_frequency: ω² [1/s²].
        weight: mobility at the contact point [1/kg].
        velocity: share of the contact point's velocity at first touch; they sum up to 1.
    """

    squared_frequency: Numbers
    weight: Numbers
    velocity: Numbers


@dataclass(frozen=True)
class Body:
    """What is hit: k_h [N/m], c_h [N·s/m], m_h [kg] (None if clamped), k_f [N/m^1.5]."""

    stiffness: float
    damping: float
    mass: float | None
    hertz_stiffness: float


@dataclass(frozen=True)
class Peak:
    """Largest force [N] until separation, and how many nodes it took; force is NaN if endless."""

    force: float
    nodes: int


def modes_of_chain(mass: Numbers, stiffness: Numbers, velocity: Numbers) -> Modes:
    """Return the modes of a chain; ``stiffness[-1]`` holds the last mass to ground.

    Masses are taken from the last, as numbers mostly grow towards the contact.
    """
    root = np.sqrt(mass)
    before = np.concatenate([stiffness[:1] * 0, stiffness[:-1]])
    off = -stiffness[:-1] / (root[:-1] * root[1:])
    at_contact = np.zeros_like(mass)
    at_contact[0] = 1 / root[0]
    rows = np.array([at_contact, root * velocity])[:, ::-1]
    squared_frequency, (shape, rate) = eigen_rows(
        ((before + stiffness) / mass)[::-1], off[::-1], rows
    )
    squared_frequency = sharpened(mass, stiffness, squared_frequency)
    return Modes(squared_frequency, shape * shape, shape * rate)


def peak_force(modes: Modes, speed: float, body: Body, finer: float = 1.0) -> Peak:
    """Integrate an impact in the precision of the modes.

    Args:
        modes: of the robot.
        speed: of the approach [m/s].
        body: what it hits.
        finer: by how much steps are shorter than in C.
    """
    run = _Run(modes, speed, body, finer)
    run.first_node()
    most = STEPS if finer == 1 else REFERENCE_STEPS
    for level in range(LEVELS + 1):
        nodes = {0: FIRST_NODES, LEVELS: most}.get(level, NODES)
        for left in reversed(range(nodes)):
            if not run.node(doubles=level < LEVELS and left == 0):
                return Peak(float(run.best) * speed, run.nodes)
    return Peak(float("nan"), run.nodes)


class _Run:
    """State of an integration; names follow the C code."""

    def __init__(self, modes: Modes, speed: float, body: Body, finer: float) -> None:
        self.real: type[Any] = modes.weight.dtype.type
        free = [] if body.mass is None else [body.mass]
        self.w = np.append(modes.weight, [1 / m for m in free]).astype(self.real)
        self.v = np.append(modes.velocity, [0.0 for _ in free]).astype(self.real)
        self.squared = np.append(modes.squared_frequency, [0.0 for _ in free]).astype(self.real)
        self.k_h, self.c_h = self.real(body.stiffness), self.real(body.damping)
        self.skin = self.real(body.hertz_stiffness * np.sqrt(speed))
        rate2 = self.k_h * self.w.sum() + (self.v * self.v * np.maximum(self.squared, 0)).sum()
        h2 = CONTACT_STEP**2 / rate2
        self.compliance = self.real(0)
        if finer == 1:
            self._let_stand()
        fastest = max(self.squared.max(), 0.0)
        h2 = min(h2, MODE_STEP**2 / fastest) if fastest > 0 else h2
        self.h = self.real(np.sqrt(h2) / finer / 2**LEVELS)
        self.theta2 = self.squared * self.h * self.h
        self.alpha = _polynomial(QUADRATIC, self.theta2)

    def _let_stand(self) -> None:
        """Turn modes without a motion of their own into a spring."""
        contact = self.k_h * self.w.sum()
        energy = self.v * self.v / np.maximum(self.squared, contact)
        stands = self.w * contact * contact < STANDS * self.w.sum() * self.squared**2
        stands &= self.v * self.v < STANDS * STANDS * energy.max() * self.squared
        self.compliance = self.real((self.w[stands] / self.squared[stands]).sum())
        self.w, self.v, self.squared = self.w[~stands], self.v[~stands], self.squared[~stands]

    def first_node(self) -> None:
        """Take the first step, over which the force is about linear."""
        h, zero = self.h, self.real(0)
        lean = _polynomial(LINEAR, self.theta2)
        y = self.v * h * (1 - self.theta2 * lean)
        hold = 1 / (self.k_h + self.c_h / h)
        force = self.w * h * h * lean
        soft = force.sum() + self.compliance + hold
        light = np.sqrt(y.sum())
        guess = light / np.sqrt(np.sqrt(1 + soft * self.skin * light))
        u = self._root(y.sum(), soft, self.real(guess))
        f = self.skin * u**3
        self.edge = self.w * h * h * self.alpha
        self.g = y - force * f + self.edge * f
        self.d = self.g.copy()
        self.f, self.u, self.s = [f, zero, zero], [u, zero, zero], [f * hold, zero, zero]
        self.past, self.nodes, self.best = 1, 1, f

    def node(self, doubles: bool) -> bool:
        """Take a step, and double the spacing after it; False once robot and body part."""
        psi = 1 - self.alpha * self.theta2
        kappa = self.theta2 * psi
        gamma = self.w * self.h * self.h * psi - kappa * self.edge
        before = self.d
        self.d = self.d - kappa * self.g - gamma * self.f[0]
        self.g = self.g + self.d
        even = self.past >= 3
        b = BACKWARD[even]
        rate = self.c_h / self.h
        hold = 1 / (self.k_h + self.real(b[0]) * rate)
        memory = rate * sum(self.real(w) * s for w, s in zip(b[1:], self.s, strict=True))
        line = 2 * self.u[0] - self.u[1]
        guess = line + (self.u[0] - 2 * self.u[1] + self.u[2]) if even else line
        soft = self.edge.sum() + self.compliance + hold
        u = self._root(self.g.sum() - memory * hold, soft, max(guess, self.u[0] / 2))
        f = self.skin * u**3
        self.nodes += 1
        self._see(f, even)
        if not f > 0:
            return False
        new = (f + memory) * hold
        if doubles:
            self._double(before, psi, f)
            self.f, self.u, self.s = [f, *self.f[1:]], [u, *self.u[1:]], [new, *self.s[1:]]
            self.past = 2
        else:
            self.f, self.u, self.s = [f, *self.f[:2]], [u, *self.u[:2]], [new, *self.s[:2]]
            self.past += 1
        return True

    def _see(self, f: Any, even: bool) -> None:
        """Note the top of the cubic through the last four nodes, or of a parabola at first."""
        here, last, second = self.f
        if not (here >= last and here > f):
            return
        third = f - 3 * here + 3 * last - second if even else self.real(0)
        bend, lean = (f - here) + (last - here), (f - last) / 2 - third / 6
        x = -lean / bend
        x = x - (lean + x * (bend + x * third / 2)) / (bend + x * third)
        x = x if -1 < x < 1 else self.real(0)
        self.best = max(self.best, here, here + x * (lean + x * (bend / 2 + x * third / 6)))

    def _double(self, before: Numbers, psi: Numbers, f: Any) -> None:
        self.alpha = self.alpha / 4 + psi * psi / 16
        self.theta2, self.h = 4 * self.theta2, 2 * self.h
        edge = self.w * self.h * self.h * self.alpha
        self.g = self.g + (edge - self.edge) * f
        self.d = self.d + before + (edge - self.edge) * (f - self.f[1])
        self.edge = edge

    def _root(self, depth: Any, soft: Any, guess: Any) -> Any:
        """Return u with u² + soft·skin·u³ = depth, or 0 where that is not positive."""
        if not depth > 0:
            return self.real(0)
        cubic, u = soft * self.skin, guess
        for _ in range(HALLEY):
            bend = 1 + 3 * cubic * u
            slope, over = u * (1 + bend), u * u * (1 + cubic * u) - depth
            change = over * slope / (slope * slope - over * bend)
            u = u - change
            if abs(change) <= CLOSE * u:
                break
        return u


def _polynomial(coefficients: tuple[float, ...], x: Numbers) -> Numbers:
    total = np.zeros_like(x)
    for coefficient in reversed(coefficients):
        total = total * x + x.dtype.type(coefficient)
    return total
