# SPDX-License-Identifier: BSD-3-Clause
"""CasADi expressions to portable C99 packages."""

from .defaults import Payload
from .errors import ForeignFiles, OutputNotWritable, UnsupportedOperation
from .manifest import FunctionRecord, Manifest
from .package import generate_package

__all__ = [
    "ForeignFiles",
    "FunctionRecord",
    "Manifest",
    "OutputNotWritable",
    "Payload",
    "UnsupportedOperation",
    "generate_package",
]
