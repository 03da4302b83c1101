# SPDX-License-Identifier: BSD-3-Clause
"""Small studies to test with: the Panda's of 24 poses with other fields and fewer poses."""

from __future__ import annotations

import json
import tomllib
from concurrent.futures import Executor, Future
from pathlib import Path
from typing import Any

from softimpact.optimize import Study, load_study
from softimpact.robots import FOLDER

PANDA_24 = FOLDER / "studies/panda_24_poses.toml"


def content() -> dict[str, Any]:
    """Return the 24-pose study as written."""
    return tomllib.loads(PANDA_24.read_text(encoding="utf-8"))


def changed(overrides: dict[str, dict[str, Any]] | None = None, poses: Any = None) -> Any:
    """Return the study's content with some fields replaced (None: left out) and some poses kept."""
    study = content()
    for section, fields in (overrides or {}).items():
        merged = {**study.get(section, {}), **fields}
        study[section] = {name: value for name, value in merged.items() if value is not None}
    if poses is not None:
        study["poses"] = [pose for pose in study["poses"] if pose["name"] in poses]
    return study


def written(folder: Path, study: dict[str, Any]) -> Path:
    """Write a study's content as TOML."""
    path = folder / "study.toml"
    tables = {name: value for name, value in study.items() if isinstance(value, dict)}
    others = {name: value for name, value in study.items() if name not in (*tables, "poses")}
    lines = [f"{name} = {_toml(value)}" for name, value in others.items()]
    if not _is_array_of_tables(study.get("poses", [])):
        lines.append(f"poses = {_toml(study.pop('poses'))}")
    for section, fields in tables.items():
        lines += [f"[{section}]", *(f"{name} = {_toml(value)}" for name, value in fields.items())]
    for pose in study.get("poses", []):
        lines += ["[[poses]]", *(f"{name} = {_toml(value)}" for name, value in pose.items())]
    path.write_text("\n".join(lines), encoding="utf-8")
    return path


def _is_array_of_tables(value: Any) -> bool:
    return isinstance(value, list) and all(isinstance(item, dict) for item in value)


def _toml(value: Any) -> str:
    """JSON's notation, which is TOML's for numbers, strings and lists (and NaN, in lower case)."""
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{name} = {_toml(item)}" for name, item in value.items()) + " }"
    return json.dumps(value).replace("NaN", "nan").replace("Infinity", "inf")


def study_of(
    folder: Path, overrides: dict[str, dict[str, Any]] | None = None, poses: Any = None
) -> Study:
    """Return the 24-pose study with some fields replaced and some poses kept."""
    return load_study(written(folder, changed(overrides, poses)))


class InProcess(Executor):
    """Runs everything at once where it is submitted, so that tests can replace parts."""

    def submit(self, fn: Any, /, *args: Any, **kwargs: Any) -> Future[Any]:
        future: Future[Any] = Future()
        try:
            future.set_result(fn(*args, **kwargs))
        except Exception as error:
            future.set_exception(error)
        return future
