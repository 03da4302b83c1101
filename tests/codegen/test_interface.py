# SPDX-License-Identifier: BSD-3-Clause
"""What is read back from a package's header is what a C compiler makes of it."""

from __future__ import annotations

import re
from pathlib import Path

import pytest
from compiled_packages import COMMITTED, run, tool

from softimpact.codegen.bindings.interface import Interface, interface_of, read_interface
from softimpact.codegen.errors import UnknownDeclaration

ROOT = Path(__file__).parents[2]


def program(interface: Interface, real: str) -> str:
    """Return a program whose assertions hold if sizes and offsets are right."""
    prefix = interface.prefix
    lines = ["#include <stddef.h>", f'#include "{prefix}.h"']
    for name in interface.structs:
        offsets, size = interface.offsets(name, real)
        lines.append(f'_Static_assert(sizeof({prefix}_{name}) == {size}, "size of {name}");')
        lines += [
            f'_Static_assert(offsetof({prefix}_{name}, {field}) == {at}, "{name}.{field}");'
            for field, at in offsets.items()
        ]
    return "\n".join([*lines, "int main(void) { return 0; }", ""])


@pytest.mark.parametrize("name", COMMITTED)
@pytest.mark.parametrize("real", ["double", "float"])
def test_structs_lie_as_the_compiler_lays_them(name: str, real: str, tmp_path: Path) -> None:
    folder = ROOT / "generated" / name
    source = tmp_path / "check.c"
    source.write_text(program(read_interface(folder), real))
    use = f"-D{name.upper()}_USE_{real.upper()}=1"
    run(tool("gcc"), "-std=c11", "-fsyntax-only", use, f"-I{folder / 'include'}", source)


@pytest.mark.parametrize("name", COMMITTED)
def test_nothing_of_a_header_is_missed(name: str) -> None:
    found = read_interface(ROOT / "generated" / name)
    text = (ROOT / "generated" / name / "include" / f"{name}.h").read_text()
    code = re.sub(r"/\*.*?\*/", "", text, flags=re.DOTALL)
    inlined = {"default_params"}
    assert {*found.entries, *inlined} == set(re.findall(rf"\b{name}_(\w+)\(", code))
    assert len(found.structs) == code.count("typedef struct")
    assert len(found.enums) == code.count("typedef enum")
    assert found.enums["status"]["BOUNDED"] == 9
    assert found.numbers["JOINTS"] > 0
    assert len(found.texts["MODEL_DIGEST"]) == 64


def test_comments_and_arguments_are_kept() -> None:
    panda = read_interface(ROOT / "generated/panda")
    fields = {f.name: f for f in panda.structs["params"].fields}
    assert fields["joint_stiffness"].comment.startswith("N m/rad, > 0; stiffness")
    safe = panda.entries["safe_speed"]
    assert [a.name for a in safe.arguments] == ["q", "n", "limit", "region", "p", "out"]
    assert [a.written for a in safe.arguments] == [False] * 5 + [True]
    assert safe.comment.startswith("Speed along n up to which impacts keep a limit")
    assert panda.entries["select_configuration"].arguments[0].shape == (None, 7)


def test_other_headers_are_refused() -> None:
    for text in (
        "typedef struct {\n    a_real *x;\n} a_params;",
        "typedef struct {\n    a_real x;\n} b_params;",
        "int a_f(int (*call)(void));",
    ):
        with pytest.raises(UnknownDeclaration):
            interface_of(text, "a")
