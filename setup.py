# SPDX-License-Identifier: BSD-3-Clause
"""Stop a build that would leave out the packages; all else stands in pyproject.toml."""

from __future__ import annotations

import sys
from pathlib import Path

from setuptools import setup

ROOT = Path(__file__).resolve().parent


def require_links() -> None:
    """Stop with a reason if src/softimpact does not lead to the packages beside it."""
    packages = sorted(path.parent.name for path in ROOT.glob("*/__init__.py"))
    linked = ROOT / "src" / "softimpact"
    missing = [name for name in packages if not (linked / name / "__init__.py").is_file()]
    if missing:
        sys.exit(
            "error: src/softimpact lacks the symbolic links to "
            f"{', '.join(missing)}: this copy was made without links. Clone it again with "
            "'git clone -c core.symlinks=true' (Windows: with Developer Mode on), or install a "
            "release with 'pip install softimpact'."
        )


require_links()
setup()
