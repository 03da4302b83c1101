# SPDX-License-Identifier: BSD-3-Clause
"""Bodies that a package has built in beside the standard's regions, some of them behind covers."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from softimpact.symbolic import Contact, InvalidValue

from .region_parameters import region_parameters


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
