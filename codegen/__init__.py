# SPDX-License-Identifier: BSD-3-Clause
"""CasADi expressions to portable C99 packages."""

from .errors import FailedOwnTest, UnsupportedOperation
from .inputs.defaults import Payload
from .inputs.regions import region_parameters
from .package.folder import FolderNotWritable, ForeignFolder
from .package.generate import generate_package, package_of
from .record.manifest import FunctionRecord, Manifest

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
