# SPDX-License-Identifier: BSD-3-Clause
"""The faults of the mutation run are what they say, and no more; what was judged is still there."""

from __future__ import annotations

import ast
import csv
import importlib.util
import sys
from pathlib import Path
from types import ModuleType

PATH = Path(__file__).with_name("mutants.py")
SOURCE = '''"""A module of 3 lines."""
LIMIT: float = 130.0


def worse(force: float, count: int = 2) -> bool:
    return force / count >= LIMIT and -force < 1
'''


def load() -> ModuleType:
    spec = importlib.util.spec_from_file_location("mutants", PATH)
    assert spec is not None
    assert spec.loader is not None
    module = sys.modules[spec.name] = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_every_fault_changes_one_place() -> None:
    faults = load()
    found = faults.mutants(SOURCE)
    assert [(fault.line, fault.what) for fault in found] == [
        (2, "130.0 → 143.0"),
        (5, "2 → 3"),
        (6, "-force < 1 → -force >= 1"),
        (6, "-force → +force"),
        (6, "1 → 2"),
        (6, "force / count >= LIMIT and -force < 1 → force / count >= LIMIT or -force < 1"),
        (6, "force / count >= LIMIT → force / count < LIMIT"),
        (6, "force / count → force * count"),
    ]
    texts = {faults.mutated(SOURCE, fault) for fault in found}
    assert len(texts) == len(found)
    assert ast.unparse(ast.parse(SOURCE)) not in texts


def test_faults_that_are_known_as_harmless_can_still_be_made() -> None:
    root, mutants = PATH.parents[2], load().mutants
    with PATH.with_name("harmless.csv").open(encoding="utf-8", newline="") as lines:
        for row in csv.DictReader(lines):
            source = (root / row["file"]).read_text(encoding="utf-8")
            code = [line.strip() for line in source.splitlines()]
            made = {(code[fault.line - 1], fault.what) for fault in mutants(source)}
            assert (row["code"], row["change"]) in made, row
            assert row["reason"], row
