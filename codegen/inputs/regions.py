# SPDX-License-Identifier: BSD-3-Clause
"""Contacts as the fields of a package's region struct, and those that it has built in.

Built in are bodies beside the standard's regions, some of them behind covers.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from math import inf
from typing import Any

from softimpact.symbolic import Contact, InvalidValue
from softimpact.symbolic.body.laws import HERTZ_EXPONENT, Law, PowerLaw
from softimpact.symbolic.body.shapes import Shape
from softimpact.symbolic.body.verdict import limits_of

from .law_points import law_points


@dataclass(frozen=True, eq=False)
class BuiltIn:
    """A contact that is built in.

    Attributes:
        name: in C.
        contact: what it is.
        numbers: its ``region_parameters``.
    """

    name: str
    contact: Contact
    numbers: Mapping[str, Any]

    @property
    def title(self) -> str:
        """What it is, in words."""
        region = self.contact.region
        return f"{region.title or region.name}{', covered' if self.contact.cover else ''}"


def built_in(contacts: Mapping[str, Contact]) -> tuple[BuiltIn, ...]:
    """Return contacts as a package has them.

    Raises:
        InvalidValue: names the contact that C cannot name or take.
    """
    found, seen = [], set()
    for name, contact in contacts.items():
        if not (name.isidentifier() and name.isascii()) or name.lower() in seen:
            raise InvalidValue("contacts", f"'{name}' is no name of one contact in C")
        seen.add(name.lower())
        try:
            numbers = region_parameters(contact)
        except InvalidValue as error:
            raise InvalidValue(f"contacts.{name}.{error.field}", error.reason) from None
        found.append(BuiltIn(name, contact, numbers))
    return tuple(found)


def region_parameters(contact: Contact, shape: Shape | None = None) -> dict[str, Any]:
    """Return what a package's impacts need to know of a contact, by the fields of its region.

    Limits are the least of force, energy and pressure, and 0 where there is none, which C refuses.
    ``law`` is None where skin and cover together follow Hertz's law, else their points, a row each
    (see ``law_points``): never softer than the law, and at most 2e-4 stiffer. A compiled package
    takes the whole as ``region=``.

    Args:
        contact: body and cover.
        shape: what touches; None: limits of pressure do not count.

    Raises:
        InvalidValue: a number of the contact cannot be, or the body has a plate.
    """
    contact.check()
    region, law = contact.region, contact.law
    if region.plate_mass:
        raise InvalidValue("plate_mass", "must be 0 here: only simulations take a plate")
    hertz = hertz_stiffness(law)
    limits = limits_of(region, contact.clamped, shape)
    pressing = limits_of(region, True, shape).quasi_static
    assert pressing is not None
    return {
        "stiffness": region.stiffness,
        "damping": region.damping,
        "effective_mass": region.effective_mass,
        "hertz_stiffness": hertz or 0.0,
        "quasi_static_limit": _known(pressing.force),
        "force_limit": _known(limits.transient.force),
        "law": None if hertz else law_points(law),
        "clamped": contact.clamped,
    }


def hertz_stiffness(law: Law) -> float | None:
    """Return k_f [N/m^1.5] of Hertz's law; None for another."""
    if isinstance(law, PowerLaw) and law.exponent == HERTZ_EXPONENT:
        return law.stiffness
    return None


def _known(limit: float) -> float:
    return limit if limit < inf else 0.0
