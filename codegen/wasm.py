# SPDX-License-Identifier: BSD-3-Clause
"""A generated package as WebAssembly, for pages and Node.

    python -m softimpact.codegen.wasm generated/panda panda.wasm

The module exports the package's functions and its memory, imports nothing, and describes itself:
its custom section ``softimpact`` says what the header declares. ``GLUE`` is JavaScript that calls
it.
"""

from __future__ import annotations

import json
import subprocess
import sys
import tempfile
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from softimpact.symbolic import SoftImpactError
from softimpact.toolchain import zig_environment

from .bindings.interface import SIZES, WASM_POINTER, CVariable, Interface, read_interface
from .errors import NoCrossCompiler
from .record.manifest import Real

GLUE = Path(__file__).parent / "web" / "package.mjs"
"""Module whose ``load(bytes)`` returns an object with a method for each function."""

SECTION = "softimpact"

FLAGS = ("--target=wasm32-wasi", "-mexec-model=reactor", "-std=c99", "-O3")

STACK = 256 * 1024
"""For a package's own structs [bytes]: those of an impact are some 25 kB for seven joints."""

WRITTEN = ("OK", "BOUNDED")
"""Statuses with which a function has written its results."""


def web_assembly(package: str | Path, real: Real = "double") -> bytes:
    """Return a package's folder as a WebAssembly module.

    Args:
        package: folder that ``generate_package`` wrote.
        real: number type; JavaScript has doubles.

    Raises:
        NoCrossCompiler: ``ziglang`` is not installed.
        UnknownDeclaration: the folder holds no package.
    """
    if find_spec("ziglang") is None:
        raise NoCrossCompiler
    folder = Path(package)
    interface = read_interface(folder)
    names = [f"{interface.prefix}_{name}" for name in (*interface.entries, *interface.tables)]
    exported = [f"-Wl,--export={name}" for name in (*names, "__heap_base")]
    with tempfile.TemporaryDirectory() as made:
        out = Path(made, "package.wasm")
        use = f"-D{interface.prefix.upper()}_USE_{real.upper()}=1"
        sources = map(str, sorted(folder.glob("src/*.c")))
        command = [sys.executable, "-m", "ziglang", "cc", *FLAGS, use, f"-I{folder / 'include'}"]
        link = [*exported, "-Wl,--strip-all", f"-Wl,-z,stack-size={STACK}", "-o", str(out)]
        subprocess.run(
            [*command, *sources, *link], check=True, capture_output=True, env=zig_environment()
        )
        module = out.read_bytes()
    return module + _section(json.dumps(described(interface, real)).encode())


def described(interface: Interface, real: Real) -> dict[str, Any]:
    """Return what JavaScript needs to know to call a package."""
    sizes = {**SIZES, "real": SIZES[real]}
    structs = {}
    for name, struct in interface.structs.items():
        offsets, size = interface.offsets(name, real, WASM_POINTER)
        fields = [
            {**_typed(f), "offset": offsets[f.name], **({"pointer": True} if f.pointer else {})}
            for f in struct.fields
        ]
        structs[name] = {"size": size, "fields": fields}
    entries = {
        name: {
            "returns": entry.returns,
            "arguments": [
                {**_typed(a), "pointer": a.pointer, "written": a.written} for a in entry.arguments
            ],
        }
        for name, entry in interface.entries.items()
    }
    return {
        "prefix": interface.prefix,
        "layout": interface.layout_in(real),
        "sizes": sizes,
        "structs": structs,
        "entries": entries,
        "enums": dict(interface.enums),
        "numbers": dict(interface.numbers),
        "texts": dict(interface.texts),
        "tables": {name: _typed(table) for name, table in interface.tables.items()},
        "written": [v for k, v in interface.enums["status"].items() if k in WRITTEN],
    }


def _typed(variable: CVariable) -> dict[str, Any]:
    return {"name": variable.name, "type": variable.type, "shape": list(variable.shape)}


def _section(content: bytes) -> bytes:
    """Return a custom section; sections may follow each other in any order."""
    name = SECTION.encode()
    body = _count(len(name)) + name + content
    return b"\0" + _count(len(body)) + body


def _count(number: int) -> bytes:
    """Return a number as WebAssembly writes it (LEB128)."""
    low, rest = number & 0x7F, number >> 7
    return bytes([low | 0x80]) + _count(rest) if rest else bytes([low])


def main(words: list[str]) -> int:
    """Compile a package from the command line; return the exit code."""
    if len(words) not in (2, 3) or words[2:] not in ([], ["double"], ["float"]):
        print("usage: python -m softimpact.codegen.wasm PACKAGE OUT.wasm [float]", file=sys.stderr)
        return 2
    try:
        module = web_assembly(words[0], "float" if words[2:] == ["float"] else "double")
        Path(words[1]).write_bytes(module)
    except (SoftImpactError, OSError) as error:
        print(f"error: {error}", file=sys.stderr)
        return 2
    return 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
