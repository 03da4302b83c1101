# SPDX-License-Identifier: BSD-3-Clause
"""CasADi expressions to portable C99 packages."""

from .defaults import Payload
from .errors import FailedOwnTest, UnsupportedOperation
from .folder import FolderNotWritable, ForeignFolder
from .manifest import FunctionRecord, Manifest
from .package import generate_package, package_of

__all__ = [
    "FailedOwnTest",
    "FolderNotWritable",
    "ForeignFolder",
    "FunctionRecord",
    "Manifest",
    "Payload",
    "UnsupportedOperation",
    "generate_package",
    "package_of",
]
