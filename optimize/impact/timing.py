# SPDX-License-Identifier: BSD-3-Clause
"""How long the impacts of a study last, and how finely they must be stepped."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import casadi as ca
import numpy as np

from softimpact.symbolic import ImpactModel, InvalidValue
from softimpact.symbolic.robot.rigid import Array

from ..evaluation import equipped
from ..machine.hardware import built
from ..machine.springs import sprung, with_springs
from ..study.scenarios import Scenarios
from ..study.study import Study
from .impact_program import forces_alone, impact_numbers, known_rotors

MARGIN = 1.3
"""Duration simulated, as a multiple of the latest time at which a force among trials is largest,
plus the time that a contact then takes to end."""

SHORTEST = 0.02
"""Least duration simulated [s]."""

LARGEST_PHASE = 1.5
"""Largest angular frequency times the step; the leapfrog is stable below 2."""

CONTACT_PHASE = 0.2
"""Largest angular frequency of a contact point on what it hits, times the step: peaks of light tips
are then right to 0.5 %."""

NODES = 150
"""Fewest times at which the force is taken (there are less than twice as many if they need several
steps each); a parabola gives the peak between them."""

INTERVAL = 5e-4
"""Most time between two of them [s]: peaks of light tips are a few milliseconds wide."""

TRIALS = 40
"""Scenarios of which the duration is taken."""

MOST_STEPS = 4500
"""Time steps beyond which compiling and running the impact would take minutes."""


@dataclass(frozen=True)
class Timing:
    """Time steps of the simulated impacts.

    Attributes:
        duration: simulated [s].
        nodes: times, evenly spaced up to the duration, at which the force is taken.
        substeps: time steps from node to node.
    """

    duration: float
    nodes: int
    substeps: int

    @property
    def steps(self) -> int:
        """Number of time steps."""
        return self.nodes * self.substeps

    @property
    def step(self) -> float:
        """Time step [s]."""
        return self.duration / self.steps


def impact_timing(study: Study, postures: Sequence[Array]) -> Timing:
    """Return a duration that holds every peak up to the study's horizon, and steps for the robot.

    Impacts are tried to the horizon with the softest, the nominal and the stiffest springs;
    frequencies with the stiffest. What is found in the end is simulated to the horizon again.

    Raises:
        InvalidValue: the stiffest springs are so stiff that an impact needs too many steps.
    """
    fastest, whole = _whole(study, postures)
    forces = forces_alone(study.model, whole.nodes, whole.substeps)
    latest = max(_latest_peak(study, forces, q, whole) for q in postures)
    return _timing(study, min(max(SHORTEST, MARGIN * latest), study.horizon), fastest)


def require_time_steps(study: Study, postures: Sequence[Array]) -> None:
    """Raise InvalidValue if the stiffest springs are so stiff that impacts need too many steps."""
    _whole(study, postures)


@dataclass(frozen=True)
class Fastest:
    """The largest angular frequencies that steps must follow [rad/s].

    Attributes:
        robot: of the joints on their springs.
        contact: of the contact points' mass on what is hit, where it bounces on that.
    """

    robot: float
    contact: float


def _whole(study: Study, postures: Sequence[Array]) -> tuple[Fastest, Timing]:
    """Return the fastest motions, and the steps of an impact up to the horizon."""
    n = study.direction
    q = ca.SX.sym("q", study.robot.n)
    mass = ca.Function("m_c", [q], [lightest(study).reflected_mass(q, ca.DM(n))])
    least = min(float(mass(posture)) for posture in postures)
    contact = np.sqrt(study.contact.region.stiffness / least)
    fastest = Fastest(_of_study(study, postures, n), float(contact))
    return fastest, _timing(study, study.horizon, fastest)


def scenario_timing(study: Study, scenarios: Scenarios) -> Timing:
    """Return time steps for all scenarios, from trials of some of them, evenly spread.

    Raises:
        InvalidValue: as ``impact_timing``; or a direction in which a pose cannot move.
    """
    n = scenarios.directions[0]
    frequency = _of_study(study, [pose.q for pose in scenarios.poses], n)
    fastest = Fastest(frequency, _of_contacts(study, scenarios))
    whole = _timing(study, study.horizon, fastest)
    of_point = [
        forces_alone(study.model, whole.nodes, whole.substeps, point) for point in scenarios.points
    ]
    latest = 0.0
    for i in np.unique(np.linspace(0, len(scenarios) - 1, TRIALS).astype(int)):
        one = scenarios[int(i)]
        row, forces = scenarios.numbers(one, whole.step), of_point[one.point]
        for springs in _tried(study):
            x = np.concatenate([scenarios.poses[one.pose].q, np.log10(springs)])
            latest = max(latest, _end_of_peak(np.array(forces(x, row)), whole))
    return _timing(study, min(max(SHORTEST, MARGIN * latest), study.horizon), fastest)


def _of_contacts(study: Study, scenarios: Scenarios) -> float:
    """Return the largest frequency of a contact point on what it hits, of all scenarios [rad/s]."""
    q, n = ca.SX.sym("q", study.robot.n), ca.SX.sym("n", 3)
    models = [replace(lightest(study), tip=point) for point in scenarios.points]
    masses = [ca.Function("m_c", [q, n], [model.reflected_mass(q, n)]) for model in models]
    least = min(
        float(masses[one.point](scenarios.poses[one.pose].q, scenarios.directions[one.direction]))
        for one in scenarios.groups()
    )
    hardest = max(contact.region.stiffness for contact in scenarios.contacts)
    return float(np.sqrt(hardest / least))


def stiffest_in_time(model: ImpactModel, q: Array, direction: Array, horizon: float) -> float:
    """Return the joint stiffness, alike in all joints, up to which impacts take few enough steps.

    Args:
        model: robot and rotors.
        q: posture, length n.
        direction: of the impact.
        horizon: of the impacts [s].
    """
    frequency = _largest_frequency(model, np.ones(len(sprung(model))), [q], direction)
    return (MOST_STEPS * LARGEST_PHASE / horizon / frequency) ** 2


def _timing(study: Study, duration: float, fastest: Fastest) -> Timing:
    needed = int(np.ceil(duration * fastest.robot / LARGEST_PHASE))
    bounces = int(np.ceil(duration * fastest.contact / CONTACT_PHASE))
    steps = max(NODES, int(np.ceil(duration / INTERVAL)), needed, bounces)
    if steps > MOST_STEPS:
        raised = "the lower ends of [hardware]" if study.other_variables else "robot.rotor_inertia"
        raise InvalidValue(
            f"{study.source}: stiffness.upper",
            f"joints that stiff vibrate so fast that {duration:g} s of impact need {steps} time "
            f"steps, more than {MOST_STEPS}; lower the bound or motors.horizon, or raise "
            f"{raised}",
        )
    substeps = max(1, int(steps / max(NODES, duration / INTERVAL)))
    return Timing(duration, int(np.ceil(steps / substeps)), substeps)


def _of_study(study: Study, postures: Sequence[Array], direction: Array) -> float:
    return _largest_frequency(lightest(study), study.upper, postures, direction)


def lightest(study: Study) -> ImpactModel:
    """Return a study's robot with the lightest links and rotors, and the stiffest springs beside.

    None that is sought is faster.
    """
    if not study.other_variables:
        return study.model
    ranges = [(each, each.range(study.model)) for each in study.other_variables]
    fastest = [own.upper if each.hastens else own.lower for each, own in ranges]
    return built(study.model, equipped(study, ca.DM(study.upper), np.concatenate(fastest)))


def _largest_frequency(
    model: ImpactModel, springs: Array, postures: Sequence[Array], direction: Array
) -> float:
    """Return the largest angular frequency of a robot on its springs in any posture [rad/s]."""
    known = replace(model, drives=replace(model.drives, rotors=known_rotors(model)))
    q = ca.SX.sym("q", model.robot.n)
    linear = with_springs(known, springs).linear(q, ca.DM(direction))
    both = [ca.densify(each) for each in (linear.mass.matrix, linear.stiffness)]
    robot = ca.Function("robot", [q], both, {"cse": True})
    squares = [
        np.linalg.eigvals(np.linalg.solve(*map(np.array, robot(posture)))) for posture in postures
    ]
    return float(np.sqrt(np.abs(squares).max()))


def study_impacts(study: Study, step: float) -> Array:
    """Return the numbers of a study's own impact, a row for each end of what motors may do."""
    return np.array(
        [
            impact_numbers(study.direction, study.speed, study.contact, motors, step)
            for motors in study.motors
        ]
    )


def _latest_peak(study: Study, forces: ca.Function, q: Array, timing: Timing) -> float:
    """Return when the contact that holds the largest force ends, the latest of all trials [s]."""
    latest = 0.0
    for row in study_impacts(study, timing.step):
        for springs in _tried(study):
            x = np.concatenate([q, np.log10(springs)])
            latest = max(latest, _end_of_peak(np.array(forces(x, row)), timing))
    return latest


def _tried(study: Study) -> Array:
    """Return the softest, the nominal and the stiffest springs, a row each, equal ones once."""
    return np.unique([study.lower, study.nominal, study.upper], axis=0)


def _end_of_peak(force: Array, timing: Timing) -> float:
    """Return when the contact that holds the largest force ends [s]."""
    force = force.ravel()
    peak = int(force.argmax())
    apart = np.flatnonzero(force[peak:] <= 0)
    end = peak + (int(apart[0]) if apart.size else force.size - peak)
    return timing.duration * (end + 1) / force.size
