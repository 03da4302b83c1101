# SPDX-License-Identifier: BSD-3-Clause
"""What the reports of studies share: what was asked, on what it rests, where it comes from."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from softimpact.optimize import Study
from softimpact.optimize.machine.springs import sprung
from softimpact.optimize.study.study_scenarios import contacts_of
from softimpact.symbolic.robot.rigid import Array

from ..design.report import peak_in_words, versions
from ..output.cautions import not_permitted, study_warnings
from ..output.printed import Cell
from .page import Page, Section, TableOfNumbers
from .provenance import command, digest_of


def study_page(
    study: Study, question: str, answer: str, is_good: bool | None, sections: Sequence[Section]
) -> Page:
    """Return the page of a study, which ends with what it rests on."""
    warnings, regions = study_warnings(study), (c.region for c in contacts_of(study))
    if is_good and any(not_permitted(regions)):
        is_good = False
    return Page(
        question=question,
        answer=answer,
        is_good=is_good,
        sections=[
            *sections,
            Section("What it rests on", tables=[_impact(study), joints(study)]),
            Section(
                "What to know",
                words=[] if warnings else ["Nothing of the robot's file was ignored."],
                lines=warnings,
            ),
        ],
        command=command(),
        versions=versions(),
        digests={"robot": study.robot.digest(), "study": digest_of(study.source)},
    )


def impact_in_words(study: Study) -> str:
    """Return who hits whom, and how fast."""
    held = "held" if study.contact.clamped else "free to give way"
    region = study.contact.region.title.lower()
    return f"{study.robot.name} hits the {region} ({held}) at {study.speed:g} m/s"


def joints(
    study: Study, springs: Array | None = None, ranges: Array | None = None
) -> TableOfNumbers:
    """Return the numbers of joints with springs, with those found and what is indifferent."""
    rotors = np.array(study.model.drives.rotors, dtype=float).ravel()[list(sprung(study.model))]
    columns = [study.lower, study.nominal, study.upper, rotors]
    heads = ["joint", "k_s from N·m/rad", "nominal", "to", "rotor kg m²"]
    if springs is not None:
        columns.append(springs)
        heads.append("found N·m/rad")
    if ranges is not None:
        columns += [ranges[:, 0], ranges[:, 1]]
        heads += ["costs < 0.5 % from", "to"]
    numbers = np.transpose(columns).tolist()
    rows = [(name, *row) for name, row in zip(study.spring_names, numbers, strict=True)]
    return TableOfNumbers("Joint stiffness", heads, rows)


def _impact(study: Study) -> TableOfNumbers:
    region = study.contact.region
    direction = ", ".join(f"{x:.4g}" for x in study.direction)
    rows: list[tuple[Cell, ...]] = [
        ("impact", impact_in_words(study), ""),
        ("contact point", study.model.tip, ""),
        ("direction", f"[{direction}]", ""),
        ("what counts", peak_in_words(study), ""),
        ("limit", study.limit, "N"),
        ("stiffness of the body", region.stiffness, "N/m"),
        ("its damping", region.damping, "N s/m"),
        ("its effective mass", region.effective_mass, "kg"),
    ]
    return TableOfNumbers("The impact", ("what", "value", "unit"), rows)
