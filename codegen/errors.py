# SPDX-License-Identifier: BSD-3-Clause
"""What can go wrong while C is generated."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from softimpact.symbolic import SoftImpactError


class UnsupportedOperation(SoftImpactError):
    """An expression holds an operation that the C printer does not know."""

    def __init__(self, operation: int, name: str) -> None:
        self.operation = operation
        super().__init__(
            f"CasADi operation {name} ({operation}) has no C counterpart here; "
            "rewrite the expression or add it to codegen/operations.py"
        )


class ForeignFiles(SoftImpactError):
    """The output folder holds files that the generator did not write or that were edited."""

    def __init__(self, folder: Path, files: Sequence[str]) -> None:
        self.folder, self.files = folder, tuple(files)
        shown = ", ".join(self.files[:5]) + (", …" if len(self.files) > 5 else "")
        super().__init__(
            f"{folder}: not overwritten, because it holds files that were not generated or were "
            f"edited since ({shown}); move them away or choose another folder"
        )


class OutputNotWritable(SoftImpactError):
    """The package cannot be written where it should go."""

    def __init__(self, folder: Path, reason: str) -> None:
        self.folder, self.reason = folder, reason
        super().__init__(f"{folder}: cannot write the package: {reason}")
