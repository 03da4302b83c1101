# SPDX-License-Identifier: BSD-3-Clause
"""Options, settings and robots that all tests share."""

from __future__ import annotations

import os
from collections.abc import Iterator
from pathlib import Path

import mujoco
import pytest
from hypothesis import Phase, settings

from softimpact.symbolic import Robot, load_robot

OPTIONAL = {
    "slow": "takes more than a few seconds",
    "embedded": "needs a cross toolchain or an emulator",
}
"""Markers whose tests run only with the option of the same name."""

settings.register_profile("softimpact", deadline=None, derandomize=True, database=None)
settings.register_profile(  # of tests/mutation, which needs no smaller example
    "first-failure", settings.get_profile("softimpact"), phases=(Phase.explicit, Phase.generate)
)
settings.load_profile("softimpact")


def pytest_addoption(parser: pytest.Parser) -> None:
    for marker, reason in OPTIONAL.items():
        parser.addoption(
            f"--{marker}", action="store_true", help=f"run tests marked {marker}: {reason}"
        )


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    for marker, reason in OPTIONAL.items():
        if config.getoption(f"--{marker}"):
            continue
        skip = pytest.mark.skip(reason=f"{reason}; run with --{marker}")
        for item in items:
            if marker in item.keywords:
                item.add_marker(skip)
    _begin_with_long(items)


def _begin_with_long(items: list[pytest.Item]) -> None:
    """Put long tests where each process begins, so that none is waited for at the end.

    xdist gives each process a part of the list, in order; who is done takes from others' ends.
    """
    count = int(os.environ.get("PYTEST_XDIST_WORKER_COUNT", "1"))
    long = [item for item in items if "long" in item.keywords]
    others = [item for item in items if "long" not in item.keywords]
    size = -(-len(others) // count)
    items[:] = [
        item for i in range(count) for item in (*long[i::count], *others[i * size : (i + 1) * size])
    ]


@pytest.fixture(scope="session", autouse=True)
def _no_log_file() -> Iterator[None]:
    """Keep MuJoCo, which tests ask for a second opinion, from logging to the working directory."""
    mujoco.set_mju_user_warning(lambda _: None)
    yield
    mujoco.set_mju_user_warning(None)


@pytest.fixture(scope="session")
def shared_folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder that all processes of a test run share; ``sharing.once`` fills it.

    Runs of the same sources share it, too, where SOFTIMPACT_TESTS_SHARED names one.
    """
    if kept := os.environ.get("SOFTIMPACT_TESTS_SHARED"):
        Path(kept).mkdir(parents=True, exist_ok=True)
        return Path(kept)
    base = tmp_path_factory.getbasetemp()
    folder = (base.parent if "PYTEST_XDIST_WORKER" in os.environ else base) / "shared"
    folder.mkdir(exist_ok=True)
    return folder


@pytest.fixture(scope="session", autouse=True)
def _compiled_functions(shared_folder: Path) -> Iterator[None]:
    """Keep the optimiser's machine code for this run alone, so that none is an older version's."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("SOFTIMPACT_CACHE", str(shared_folder / "cache"))
        yield


@pytest.fixture(scope="session")
def panda() -> Robot:
    """The built-in Panda, chain to its hand's centre point."""
    return load_robot("panda")
