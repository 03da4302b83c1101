# SPDX-License-Identifier: BSD-3-Clause
"""CasADi expressions to portable C99 packages."""

from .defaults import Payload
from .errors import FailedOwnTest, UnsupportedOperation
from .folder import FolderNotWritable, ForeignFolder
from .manifest import FunctionRecord, Manifest
from .package import generate_package, package_of
from .region_parameters import region_parameters

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
    "region_parameters",
]
