# SPDX-License-Identifier: BSD-3-Clause
"""Instructions, code and stack of a package's functions on a Cortex-M."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

from bound_on_time import bound_of_driven_safe_speed
from compiled_packages import Generated, run
from cross_compiled import BOARD, CORES, GCC, OPTIMISE, build, compile_one, link, run_image

from softimpact.codegen.record.cost_digests import cost_digests
from softimpact.codegen.record.costs import FEW_STEPS, Costs, FunctionCost, Instructions, SharedCost

NODE = re.compile(r'node: \{ title: "([^"]+)" label: "[^"]*\\n(\d+) bytes \((.*?)\)')
EDGE = re.compile(r'edge: \{ sourcename: "([^"]+)" targetname: "([^"]+)"')


@dataclass(frozen=True)
class Call:
    """A call of a function on its golden inputs.

    Attributes:
        function: its name.
        text: the call in C, of an input ``in`` and, for impacts, of a ``region``.
        inputs: name of the array that ``in`` points into.
        region: type of the region; None where there is none.
        rounds: how often each input is repeated.
        case: what is special about it, in a word; none for most.
    """

    function: str
    text: str
    inputs: str
    region: str | None = None
    rounds: int = 200
    case: str = ""

    @property
    def name(self) -> str:
        """The function's name, and the case in brackets."""
        return f"{self.function} ({self.case})" if self.case else self.function

    @property
    def defines(self) -> list[str]:
        """What ``count.c`` needs to know."""
        defines = [f"-DCALL={self.text}", f"-DINPUTS={self.inputs}", f"-DROUNDS={self.rounds}u"]
        if self.region:
            prefix = self.region.removesuffix("_region")
            defines += [f"-DREGION={self.region}", f"-DBODY_REGION={prefix}_body_region"]
        return defines


def calls(package: Generated) -> list[Call]:
    """Return a call of each function of a package; safe speeds are asked for regions' limits."""
    name, n, found = package.manifest.name, package.robot.n, []
    listed = {f.name for f in package.manifest.functions}
    if f"{name}_configuration" in listed:
        text = f"{name}_configuration(*in, NULL, ({name}_real[{n}]){{0}})"
        found.append(Call(f"{name}_configuration", text, f"{name}_golden_motors"))
    for function in package.functions:
        full = f"{name}_{function.name}"
        arguments = ["in->q"]
        arguments += ["in->n"] if function.direction else []
        arguments += [f"in->{scalar.name}" for scalar in function.scalars]
        arguments += ["&in->p"] if function.parameters else []
        if len(function.outputs) > 1:
            arguments.append(f"&({full}_t){{0}}")
        else:
            shape = "".join(f"[{size}]" for size in function.outputs[0].shape)
            zero = "{{0}}" if len(function.outputs[0].shape) == 2 else "{0}"
            arguments.append(f"{'' if shape else '&'}({name}_real{shape}){zero}")
        found.append(Call(full, f"{full}({', '.join(arguments)})", f"{name}_golden_inputs"))
    if package.manifest.impact:
        for short, number in (("peak_force", "in->speed"), ("safe_speed", "region.force_limit")):
            full = f"{name}_{short}"
            text = f"{full}(in->q, in->n, {number}, &region, &in->p, &({full}_t){{0}})%9"  # BOUNDED
            found.append(Call(full, text, f"{name}_golden_impacts", f"{name}_region", rounds=20))
        NAME, full = name.upper(), f"{name}_safe_speed"
        p = (
            f"({name}_params p = in->p; p.motors = {NAME}_MOTORS_DRIVEN; p.steps = {FEW_STEPS};"
            " p.reaction_time = 0.02f; p.horizon = 0.1f;"
        )
        text = f"{p.replace('(', '({', 1)} {text.replace('&in->p', '&p')}; }})"
        region = f"{name}_region"
        found.append(Call(full, text, f"{name}_golden_impacts", region, 20, "driven"))
    if package.manifest.poses:
        full = f"{name}_select_configuration"
        table = f"{name}_candidates, {name.upper()}_CANDIDATES, NULL"
        text = f"{full}({table}, in->n, in->speed, &region, &in->p, &({name}_selection_t){{0}})"
        found.append(Call(full, text, f"{name}_golden_impacts", f"{name}_region", rounds=4))
    return found


def count(
    package: Generated, core: str, objects: Sequence[Path], call: Call, out: Path
) -> Instructions:
    """Count the instructions of a call in a float build."""
    said = run_image(counting(package, core, objects, call, out), core)
    numbers = re.search(r"instructions: (\d+), at most (\d+)", said)
    assert numbers, said
    return Instructions(int(numbers[1]), int(numbers[2]))


def counting(package: Generated, core: str, objects: Sequence[Path], call: Call, out: Path) -> Path:
    """Return the image that counts a call's instructions."""
    counter = compile_one(package, core, "float", out, BOARD / "count.c", *call.defines)
    return link(core, [*objects, counter], out)


def bound(package: Generated, objects: Sequence[Path], call: Call, out: Path) -> int | None:
    """Return how many instructions a call takes at most on an M7; None unless motors drive on."""
    if call.case != "driven":
        return None
    image = counting(package, "m7", objects, call, out)
    return bound_of_driven_safe_speed(package, image, FEW_STEPS)


def measure(package: Generated, folder: Path, known: Sequence[FunctionCost] = ()) -> Costs:
    """Return the costs of all functions of a package.

    Args:
        package: whose sources lie on disk.
        folder: for what is compiled.
        known: costs of functions that are taken over where their sources are still the same.
    """
    texts = {
        str(p.relative_to(package.folder)): p.read_text() for p in package.folder.rglob("*.[ch]")
    }
    digests = cost_digests(package.manifest.name, texts)
    kept = {f.name: f for f in known if f.digest == digests.get(f.function)}
    asked = [call for call in calls(package) if call.name not in kept]
    counts: dict[str, dict[str, Instructions]] = {}
    for core in CORES:
        (folder / core).mkdir()
        objects = build(package, core, "float", folder / core)
        counts[core] = {
            call.name: count(package, core, objects, call, folder / core) for call in asked
        }
    sizes = sizes_of(objects)
    stacks = stacks_of(folder / "m7")
    own = {source.stem for source in package.folder.glob("src/*.c")}
    functions = {
        call.name: kept.get(call.name)
        or FunctionCost(
            call.name,
            counts["m4"][call.name],
            counts["m7"][call.name],
            *sizes[call.function],
            stacks[call.function],
            digests[call.function],
            bound(package, objects, call, folder / "m7"),
        )
        for call in calls(package)
    }
    return Costs(
        compiler=compiler_version(),
        flags=" ".join(OPTIMISE),
        functions=tuple(functions.values()),
        shared=tuple(
            SharedCost(name, *sizes[name], digests[name]) for name in sorted(own - functions.keys())
        ),
    )


def compiler_version() -> str:
    """Return the cross compiler's name and version."""
    return run(GCC, "--version").splitlines()[0]


def sizes_of(objects: Sequence[Path]) -> dict[str, tuple[int, int]]:
    """Return the sizes of code and constants [bytes] of each object by its name."""
    sizes = {}
    for target in objects:
        found = re.findall(r"^\.(text|rodata)\S* +(\d+)", run("arm-none-eabi-size", "-A", target),
                           re.MULTILINE)  # fmt: skip
        text, rodata = (sum(int(n) for kind, n in found if kind == k) for k in ("text", "rodata"))
        sizes[target.stem] = (text, rodata)
    return sizes


def stacks_of(out: Path) -> dict[str, int]:
    """Return the deepest stack [bytes] of each function compiled into a folder.

    The C library's functions count as nothing.
    """
    frames: dict[str, int] = {}
    called: dict[str, set[str]] = {}
    for file in sorted(out.glob("*.ci")):
        text = file.read_text()
        for name, size, kind in NODE.findall(text):
            assert kind == "static", (name, kind)  # no array whose length is not known
            frames[name] = int(size)
        for caller, callee in EDGE.findall(text):
            assert callee != "__indirect_call", caller
            called.setdefault(caller, set()).add(callee)
    return {name: _deepest(name, frames, called, ()) for name in frames}


def _deepest(
    name: str, frames: Mapping[str, int], called: Mapping[str, set[str]], above: tuple[str, ...]
) -> int:
    assert name not in above, f"{name} calls itself"
    below = [_deepest(callee, frames, called, (*above, name)) for callee in called.get(name, ())]
    return frames.get(name, 0) + max(below, default=0)
