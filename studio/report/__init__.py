# SPDX-License-Identifier: BSD-3-Clause
"""Reports: one HTML file each, that opens offline, prints, and says what an answer rests on."""

from .page import ArmPicture, Page, Section, TableOfNumbers, write_page

__all__ = ["ArmPicture", "Page", "Section", "TableOfNumbers", "write_page"]
