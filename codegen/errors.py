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
            "rewrite the expression or add it to codegen/expressions/operations.py"
        )


class FailedOwnTest(SoftImpactError):
    """A package does not meet its own golden results; it is not written."""

    exit_code = 3

    def __init__(self, reason: str) -> None:
        self.reason = reason
        super().__init__(
            f"the package fails its own test and was not written: {reason}; this is a fault of the "
            "generator, please report it with the robot's file"
        )


class UnknownDeclaration(SoftImpactError):
    """A header holds a declaration that our templates do not write."""

    def __init__(self, package: str, declaration: str) -> None:
        self.package, self.declaration = package, declaration
        super().__init__(f"{package}: not the header of a generated package ({declaration})")


class NoCrossCompiler(SoftImpactError):
    """WebAssembly needs a compiler that is not installed."""

    def __init__(self) -> None:
        super().__init__("WebAssembly needs the compiler Zig: pip install ziglang")
