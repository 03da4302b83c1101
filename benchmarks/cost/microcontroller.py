# SPDX-License-Identifier: BSD-3-Clause
"""Instructions of the package and of CasADi's code on emulated Cortex-M, in float."""

from __future__ import annotations

import re
import shutil
import sys
from collections.abc import Mapping
from pathlib import Path
from typing import Any

from compiled_packages import Generated
from compiling import run, write_c
from cross_compiled import GCC, build, flags, machine
from expressions import QUANTITIES, Quantities
from measured_costs import Call, calls, count
from page import Table

CORES = {"m4": "Cortex-M4F", "m7": "Cortex-M7"}
BY_HAND = " by hand"

WRAPPER = """
int {name}_call(const void *input);
int {name}_call(const void *input)
{{
    static float out[{outputs}], w[{w}];
    static int iw[{iw}];
    const panda_golden_input *const in = input;
    const float *arguments[] = {{in->q, in->n, in->p.joint_stiffness, in->p.rotor_inertia,
                                in->p.position_gain}};
    float *results[] = {{out}};
    return {name}(arguments, results, iw, w, 0);
}}
"""


def counts(package: Generated, rivals: Mapping[str, Quantities], folder: Path) -> dict[str, Table]:
    """Return mean instructions by core, quantity and contender; nothing without the tools."""
    for tool in (GCC, "qemu-system-arm"):
        if shutil.which(tool) is None:
            print(f"skipped: microcontrollers need {tool}", file=sys.stderr)
            return {}
    return {name: _on(core, package, rivals, folder / core) for core, name in CORES.items()}


def _on(core: str, package: Generated, rivals: Mapping[str, Quantities], folder: Path) -> Table:
    folder.mkdir()
    objects = build(package, core, "float", folder)
    ours = {call.function.removeprefix("panda_"): call for call in calls(package)}
    found: Table = {
        quantity: {"ours": count(package, core, objects, ours[quantity], folder).mean}
        for quantity in QUANTITIES
    }
    for name, quantities in rivals.items():
        for quantity, function in quantities.functions.items():
            code = _float_code(function, folder)
            entry = f"{function.name()}_call"
            text = f"({{ int {entry}(const void *); {entry}(in); }})"
            called = Call(entry, text, "panda_golden_inputs")
            for variant, source in ((name, code), (name + BY_HAND, _by_hand(code))):
                theirs = _compile(package, core, source, variant != name, folder)
                found[quantity][variant] = count(
                    package, core, [*objects, theirs], called, folder
                ).mean
    return found


def _float_code(function: Any, folder: Path) -> str:
    path = write_c(function, folder, casadi_real="float", casadi_int="int")
    sizes = {"outputs": function.numel_out(0), "w": function.sz_w() + 1, "iw": function.sz_iw() + 1}
    wrapper = WRAPPER.format(name=function.name(), **sizes)
    return '#include "golden.h"\n' + path.read_text(encoding="utf-8") + wrapper


def _by_hand(code: str) -> str:
    return re.sub(r"\b(sin|cos|sqrt)\(", r"\1f(", code)


def _compile(package: Generated, core: str, code: str, single: bool, folder: Path) -> Path:
    source = folder / "rival.c"
    source.write_text(code, encoding="utf-8")
    plain = [flag for flag in flags(package, "float") if not flag.startswith("-W")]
    told = [*plain, *machine(core)]
    constants = ["-fsingle-precision-constant"] if single else []
    tests = f"-I{package.folder / 'test'}"
    run(GCC, *told, *constants, tests, "-c", source, "-o", source.with_suffix(".o"))
    return source.with_suffix(".o")
