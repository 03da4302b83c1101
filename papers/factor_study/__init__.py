# SPDX-License-Identifier: BSD-3-Clause
"""Impact factors over a study's configurations: what GIAF's paper shows, and what follows."""

from .study import FactorStudy, factor_study

__all__ = ["FactorStudy", "factor_study"]
