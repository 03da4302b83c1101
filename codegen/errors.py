# SPDX-License-Identifier: BSD-3-Clause
"""What can go wrong while C is generated."""

from __future__ import annotations

from softimpact.symbolic import SoftImpactError


class UnsupportedOperation(SoftImpactError):
    """An expression holds an operation that the C printer does not know."""

    def __init__(self, operation: int, name: str) -> None:
        self.operation = operation
        super().__init__(
            f"CasADi operation {name} ({operation}) has no C counterpart here; "
            "rewrite the expression or add it to codegen/operations.py"
        )
