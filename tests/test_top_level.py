# SPDX-License-Identifier: BSD-3-Clause
"""The names at the top of the package."""

from __future__ import annotations

import subprocess
import sys

import pytest

import softimpact


@pytest.mark.parametrize("name", softimpact.__all__)
def test_names_lead_to_their_packages(name: str) -> None:
    found = getattr(softimpact, name)
    assert found.__module__.startswith("softimpact.")
    assert name in dir(softimpact)


def test_unknown_names_are_errors() -> None:
    with pytest.raises(AttributeError, match="has no attribute 'nothing'"):
        _ = softimpact.nothing


def test_the_package_alone_imports_nothing_heavy() -> None:
    code = "import sys, softimpact; print('casadi' in sys.modules, 'numpy' in sys.modules)"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.split() == ["False", "False"]
