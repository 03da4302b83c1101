# SPDX-License-Identifier: BSD-3-Clause
"""A page's C package, compiled to WebAssembly once and then taken from the user's cache."""

from __future__ import annotations

import hashlib
import json
import os
import tempfile
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path

import softimpact
from softimpact.codegen import wasm
from softimpact.codegen.errors import NoCrossCompiler
from softimpact.codegen.package.render import Package, render
from softimpact.toolchain import usable_cache

from .package import PREFIX

SHIM = Path(__file__).parent / "shim"
"""C that is added to the package, with the runtime's prefix ``robot_``."""

HEADER = "robot_page.h"
"""Of the shim: what it adds to the package's header."""

OPTIONAL = ("reduced_model", "giaf")
"""Functions that some robots' packages do not have."""


def module_of(package: Package) -> bytes:
    """Return a page's module; raises NoCrossCompiler."""
    if find_spec("ziglang") is None:
        raise NoCrossCompiler
    files = sources_of(package)
    content = json.dumps([softimpact.__version__, version("ziglang"), wasm.FLAGS, files])
    key = hashlib.sha256(content.encode()).hexdigest()[:32]
    cache = usable_cache()
    if cache is None:  # a user without a home, or one that is read only
        return _compiled(files)
    module = cache / "page" / f"{key}.wasm"
    if not module.is_file():
        module.parent.mkdir(parents=True, exist_ok=True)
        fresh = module.with_suffix(f".{os.getpid()}")
        fresh.write_bytes(_compiled(files))
        fresh.replace(module)
    return module.read_bytes()


def _compiled(files: dict[str, str]) -> bytes:
    with tempfile.TemporaryDirectory() as made:
        for path, text in files.items():
            target = Path(made, path)
            target.parent.mkdir(exist_ok=True)
            target.write_text(text, encoding="utf-8")
        return wasm.web_assembly(made)


def sources_of(package: Package) -> dict[str, str]:
    """Return the package's sources with the shim's among them, by path."""
    rendered, _ = render(package)
    files = {p: text for p, text in rendered.items() if p.startswith(("src/", "include/"))}
    for path in sorted(SHIM.iterdir()):
        if path.name != HEADER:
            files[f"src/{_named(path.name)}"] = _named(path.read_text(encoding="utf-8"))
    has = "".join(
        f"#define {PREFIX.upper()}_HAS_{name.upper()} {int(package.has(name))}\n"
        for name in OPTIONAL
    )
    header = f"include/{PREFIX}.h"
    added = has + _named((SHIM / HEADER).read_text(encoding="utf-8"))
    closed, end, rest = files[header].rpartition("#endif")
    files[header] = f"{closed}{added}\n{end}{rest}"
    return files


def _named(text: str) -> str:
    return text.replace("ROBOT_", f"{PREFIX.upper()}_").replace("robot_", f"{PREFIX}_")
