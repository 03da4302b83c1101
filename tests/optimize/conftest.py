# SPDX-License-Identifier: BSD-3-Clause
"""A cache of compiled functions for the tests alone."""

from __future__ import annotations

from collections.abc import Iterator

import pytest


@pytest.fixture(scope="session", autouse=True)
def _cache(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("SOFTIMPACT_CACHE", str(tmp_path_factory.mktemp("cache")))
        yield
