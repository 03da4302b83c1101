# SPDX-License-Identifier: BSD-3-Clause
"""Packages as WebAssembly, run in Node: the same numbers as the native library."""

from __future__ import annotations

import json
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from compiled_impacts import BOUNDED, FREE_OR_DRIVEN, OK, PARTS, Impacts, Motion, impacts
from compiled_packages import Generated, missing, run, tool
from sharing import once

from softimpact.codegen import wasm
from softimpact.codegen.errors import NoCrossCompiler, UnknownDeclaration
from softimpact.codegen.inputs.parameters import SCALARS
from softimpact.codegen.inputs.samples import Sample, draw_samples

ASK = """
import {{ readFileSync }} from "node:fs";
import {{ load }} from "{glue}";
const robot = await load(readFileSync("{module}"));
const ask = ({{ call, given, region, p }}) => {{
  const more = {{}};
  if (p) more.p = {{ ...robot.default_params(), ...p }};
  if (region) more.region = robot.body_region(region);
  try {{ return robot[call]({{ ...given, ...more }}); }} catch (error) {{ return String(error); }}
}};
console.log(JSON.stringify(JSON.parse(readFileSync("{questions}")).map(ask)));
"""


@pytest.fixture(scope="module")
def ask(shared_folder: Path, tmp_path_factory: pytest.TempPathFactory) -> Callable[..., Any]:
    """Return answers in Node, of a package that is compiled once."""
    node = tool("node")

    def ask(package: Generated, questions: list[dict[str, Any]]) -> Any:
        module = shared_folder / "wasm" / f"{package.manifest.name}.wasm"
        try:
            once(module, lambda path: path.write_bytes(wasm.web_assembly(package.folder)))
        except NoCrossCompiler as error:
            missing(str(error))
        folder = tmp_path_factory.mktemp("node")
        (folder / "questions.json").write_text(json.dumps(questions))
        script = ASK.format(glue=wasm.GLUE, module=module, questions=folder / "questions.json")
        (folder / "ask.mjs").write_text(script)
        return json.loads(run(node, folder / "ask.mjs"))

    return ask


def fields(package: Generated, sample: Sample) -> dict[str, Any]:
    pairs = zip(package.parameters, sample.parameters, strict=True)
    return {p.name: list(values) if p.shape else values[0] for p, values in pairs}


@pytest.mark.slow
@pytest.mark.parametrize("name", ["panda", "rmin"])
def test_functions_say_what_the_native_ones_say(
    package: Callable[[str], Generated], ask: Callable[..., Any], name: str
) -> None:
    generated = package(name)
    native = generated.load("double")
    samples = draw_samples(generated.robot, generated.parameters, 4, seed=7)
    asked = [(f, sample) for f in generated.functions for sample in samples]
    questions = []
    for function, sample in asked:
        given: dict[str, Any] = {"q": list(sample.q)}
        given |= {"n": list(sample.n)} if function.direction else {}
        known = dict(zip(SCALARS, sample.scalars, strict=True))
        scalars = {scalar.name: known[scalar] for scalar in function.scalars}
        p = fields(generated, sample) if function.parameters else None
        questions.append({"call": function.name, "given": {**given, **scalars}, "p": p})
    for (function, sample), found in zip(asked, ask(generated, questions), strict=True):
        status, outputs = native.call(function, sample)
        assert found["status"] == status
        if status == OK:
            for output, right in zip(function.outputs, outputs, strict=True):
                scale = max(1e-300, float(np.max(abs(right))))
                assert np.max(abs(np.array(found[output.name]) - right)) <= 1e-9 * scale


@pytest.mark.slow
def test_impacts_say_what_the_native_ones_say(
    package: Callable[[str], Generated], ask: Callable[..., Any]
) -> None:
    panda = package("panda")
    native = Impacts(panda, "double")
    cases = impacts(panda, 6, seed=5)
    questions = []
    for case in cases:
        p = {**fields(panda, case.sample), "motors": FREE_OR_DRIVEN, "horizon": 0.1, "steps": 4000}
        given = {"q": list(case.sample.q), "n": list(case.sample.n), "limit": 200.0}
        region = {"part": PARTS.index(case.region.name), "clamped": 1}
        questions.append({"call": "safe_speed", "given": given, "region": region, "p": p})
    for case, found in zip(cases, ask(panda, questions), strict=True):
        chosen = native.region(case.region.name, clamped=True)
        motion = Motion(FREE_OR_DRIVEN, 0.02, 0.1, 4000)
        status, right = native.call("safe_speed", case.sample, 200.0, chosen, motion)
        assert found["status"] == status
        if status in (OK, BOUNDED):
            assert [found["speed"], found["force"]] == pytest.approx(right, rel=1e-6)


@pytest.mark.slow
def test_wrong_arguments_are_said(
    package: Callable[[str], Generated], ask: Callable[..., Any]
) -> None:
    q, n = [0.0] * 7, [1.0, 0.0, 0.0]
    said = ask(
        package("panda"),
        [
            {"call": "reflected_mass", "given": {"q": q, "m": 1}},
            {"call": "reflected_mass", "given": {"q": [1.0], "n": n}},
            {"call": "reflected_mass", "given": {"q": q}},
            {"call": "reflected_mass", "given": {"q": q, "n": [0.0] * 3}},
            {"call": "peak_force", "given": {"q": q, "n": n, "speed": "fast"}},
            {"call": "status_text", "given": {"status": 0}},
        ],
    )
    assert said == [
        "TypeError: reflected_mass takes no m",
        "TypeError: q must hold 7 numbers, not 1",
        {"status": 1},
        {"status": 3},
        "TypeError: speed must be a number, not fast",
        "ok",
    ]


def test_without_zig_it_says_how_to_get_it(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(wasm, "find_spec", lambda _: None)
    with pytest.raises(NoCrossCompiler, match="pip install ziglang"):
        wasm.web_assembly("generated/panda")


def test_a_folder_without_a_package_is_refused(tmp_path: Path) -> None:
    pytest.importorskip("ziglang")
    with pytest.raises(UnknownDeclaration, match="not the header of a generated package"):
        wasm.web_assembly(tmp_path)
