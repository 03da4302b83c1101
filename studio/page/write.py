# SPDX-License-Identifier: BSD-3-Clause
"""A page as one file that needs no server: its scripts, its C as WebAssembly, and what it knows."""

from __future__ import annotations

import base64
import html
import json
import re
from pathlib import Path
from typing import Any

from softimpact.codegen.wasm import GLUE

from ..design.report import versions
from .content import content_of
from .module import module_of
from .opened import Opened
from .package import page_package

FRONT = Path(__file__).parent / "front"

SCRIPTS = [
    "package",
    "vectors",
    "sizes",
    "parts",
    "camera",
    "arm",
    "answers",
    "plot",
    "state",
    "solver",
    "motion",
    "controls",
    "strip",
    "map",
    "main",
]
"""In an order in which each has what it imports; the first is the packages' glue."""

IMPORT = re.compile(r'^import \{ (.*?) \} from "\./(\w+)\.js";\n', re.MULTILINE)
EXPORT = re.compile(r"^export (async function|function|const) (\w+)", re.MULTILINE)


def page_of(opened: Opened) -> str:
    """Return the page as HTML; raises what ``page_package`` and ``module_of`` do."""
    content = content_of(opened)
    module = module_of(page_package(opened.robot, opened.drives))
    values = {
        "title": html.escape(opened.title),
        "style": (FRONT / "style.css").read_text(encoding="utf-8"),
        "script": bundled(),
        "content": _data(content),
        "module": base64.b64encode(module).decode("ascii"),
        "provenance": html.escape(_provenance(content)),
    }
    page = (FRONT / "page.html").read_text(encoding="utf-8")
    return re.sub(r"\{\{(\w+)\}\}", lambda found: values[found[1]], page)


def bundled() -> str:
    """Return all scripts as one that a file can hold: browsers load no modules from files."""
    parts = ['"use strict";\nconst modules = {};']
    for name in SCRIPTS:
        path = GLUE if name == "package" else FRONT / f"{name}.js"
        text = path.read_text(encoding="utf-8")
        exported = [found[2] for found in EXPORT.finditer(text)]
        text = IMPORT.sub(r"const { \1 } = modules.\2;\n", text)
        text = EXPORT.sub(r"\1 \2", text)
        parts.append(
            f"modules.{name} = (() => {{\n{text}\nreturn {{ {', '.join(exported)} }};\n}})();"
        )
    return "\n".join(parts).replace("</script", "<\\/script")


def _data(content: dict[str, Any]) -> str:
    return json.dumps(content, allow_nan=False, separators=(",", ":")).replace("<", "\\u003c")


def _provenance(content: dict[str, Any]) -> str:
    made = "; ".join(f"{name} {version}" for name, version in versions().items())
    return f"{content['robot']} ({content['digest'][:16]}); {made}."
