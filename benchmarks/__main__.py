# SPDX-License-Identifier: BSD-3-Clause
"""Run every benchmark: ``python -m benchmarks``. Each prints ratios measured in one run."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

if __name__ == "__main__":
    scripts = sorted(Path(__file__).parent.glob("*/run.py"))
    codes = [subprocess.run([sys.executable, s], check=False).returncode for s in scripts]
    sys.exit(any(codes))
