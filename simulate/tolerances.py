# SPDX-License-Identifier: BSD-3-Clause
"""How far the numbers of an impact may be from the truth."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from functools import lru_cache
from statistics import NormalDist

import numpy as np

from softimpact.symbolic import InvalidValue
from softimpact.symbolic.robot.rigid import Array


@dataclass(frozen=True)
class Tolerances:
    """Relative standard uncertainties: 0.3 is ±30 % in two cases of three, −44/+80 % in 19 of 20.

    Each number's error is lognormal, and independent of the others'; ``links``, ``rotors`` and
    ``springs`` err joint by joint. Where nobody states an uncertainty, the default is an estimate.

    Attributes:
        links: inertia of each link. Estimate: CAD and identification part by that much.
        rotors: reflected inertia of each rotor. Estimate; public numbers for the Panda are up to
            six times apart (see its three sets).
        springs: k_s of each joint. Estimate: it grows with torque, and few makers state it.
        gains: K_p and, with an error of its own, K_d. Estimate: inner loops change what they do.
        reaction_time: estimate: makers state a bound or a mean, if anything.
        body: k_h. Estimate: people differ, and the standard has one number for a region.
        law: force of skin, pad and cover at a given depth. Estimate: one pad was measured once.
        damping: c_h. Estimate: MSM's 10 N·s/m is there for the integrator, tissue has up to 100.
    """

    links: float = 0.05
    rotors: float = 0.3
    springs: float = 0.3
    gains: float = 0.1
    reaction_time: float = 0.2
    body: float = 0.25
    law: float = 0.3
    damping: float = 0.7

    def __post_init__(self) -> None:
        for field in fields(self):
            value = getattr(self, field.name)
            if not 0 <= value < LARGEST:
                reason = f"must be from 0 (exact) to {LARGEST:g}, not {value:g}"
                raise InvalidValue(f"tolerances.{field.name}", reason)


LARGEST = 3.0
"""Largest relative standard uncertainty; beyond it nothing is known at all."""

EXACT = Tolerances(*[0.0] * len(fields(Tolerances)))
"""Numbers without an error."""


@dataclass(frozen=True, eq=False)
class ErrorFactors:
    """Factors on the numbers of many impacts; ``links``, ``rotors``, ``springs`` are S×n."""

    links: Array
    rotors: Array
    springs: Array
    position_gains: Array
    damping_gains: Array
    reaction_time: Array
    body: Array
    law: Array
    damping: Array


def error_factors(tolerances: Tolerances, joints: int, samples: int) -> ErrorFactors:
    """Return factors for many impacts, always the same ones.

    Errors are those of a sequence of low discrepancy (Richtmyer's, with the square roots of the
    primes), so that a thousand samples show what many thousand random ones would.
    """
    t = tolerances
    per_joint = [t.links, t.rotors, t.springs]
    single = [t.gains, t.gains, t.reaction_time, t.body, t.law, t.damping]
    share = np.repeat(per_joint + single, [joints] * 3 + [1] * len(single))
    found = np.exp(np.log1p(share) * normal_sequence(samples, len(share)))
    links, rotors, springs = np.split(found[:, : 3 * joints], 3, axis=1)
    return ErrorFactors(links, rotors, springs, *found[:, 3 * joints :].T)


def normal_sequence(samples: int, dimensions: int) -> Array:
    """Return standard normal numbers of low discrepancy, samples × dimensions."""
    return np.column_stack([_normal(samples, prime) for prime in _primes(dimensions)])


def _normal(samples: int, prime: int) -> Array:
    uniform = (0.5 + math.sqrt(prime) * np.arange(1, samples + 1)) % 1.0
    # a fine table serves: errors of 1e-6 in an error do not matter
    table = np.linspace(0, 1, 4097)[1:-1]
    return np.asarray(np.interp(uniform, table, _inverse(table.tobytes())))


@lru_cache(maxsize=1)
def _inverse(table: bytes) -> Array:
    return np.array([NormalDist().inv_cdf(p) for p in np.frombuffer(table)])


@lru_cache(maxsize=16)
def _primes(count: int) -> tuple[int, ...]:
    """Return primes whose sequences have no bias and next to no correlation."""
    found: list[int] = []
    columns: list[Array] = []
    candidate = 1
    while len(found) < count:
        candidate += 1
        if any(candidate % factor == 0 for factor in range(2, math.isqrt(candidate) + 1)):
            continue
        column = _normal(1000, candidate)
        moments = [column.mean(), column.std() - 1, *(column @ c / 1000 for c in columns)]
        if max(map(abs, moments)) < UNRELATED:
            found.append(candidate)
            columns.append(column)
    return tuple(found)


UNRELATED = 0.05
"""Most bias of a thousand samples, and most correlation of two dimensions."""
