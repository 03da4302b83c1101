# SPDX-License-Identifier: BSD-3-Clause
"""A package's files from its templates."""

from __future__ import annotations

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from pathlib import Path
from typing import Any

import jinja2

import softimpact
from softimpact.symbolic import REGIONS, JointKind, Robot, closed_chain
from softimpact.symbolic.body.contact import HERTZ_STIFFNESS

from ..bindings.interface import interface_of
from ..bindings.languages import bindings
from ..expressions import sine, wide_sine
from ..functions import coordinates_of
from ..inputs.defaults import Default
from ..inputs.law_points import MOST_POINTS
from ..inputs.parameters import SCALARS, Parameter, is_elastic
from ..inputs.regions import BuiltIn
from ..inputs.samples import Sample
from ..record.costs import FEW_STEPS, Costs, stored_costs
from ..record.manifest import Real
from ..sources.configuration import ConfigurationSource
from ..sources.function import CSource
from ..sources.impact import ImpactSource
from ..sources.stage import StageSource

TEMPLATES = Path(__file__).parents[1] / "templates"

RUNTIME = Path(__file__).parents[1] / "runtime"
"""C that is the same for every robot but for its prefix, which is ``robot_`` there."""

POINT = "robot_point.c"
"""Of the runtime: contact points that are given at run time."""

MEASURED_SAMPLES = 16384
"""Inputs over which float errors are measured."""


@dataclass(frozen=True, eq=False)
class Package:
    """Everything that the templates show.

    Attributes:
        prefix: of all C names.
        robot: the rigid robot.
        tip: contact frame.
        real: default number type.
        gravity: whose curvature enters K0 [m/s²].
        chain_order: masses of the chain.
        parameters: all, frozen ones too.
        defaults: of each field of the parameter struct.
        functions: all C functions.
        samples: golden inputs.
        tables: golden results of each function by its short name.
        configuration: where a closed chain's motors decide the rest; None if they do not.
        impact: peak forces and safe speeds; None where the robot has none.
        floating: whether a function sets the base free.
        poses: built-in candidates for ``select_configuration``, by name.
        contacts: built-in bodies and covers.
        stages: what its functions share.
    """

    prefix: str
    robot: Robot
    tip: str
    real: Real
    gravity: tuple[float, float, float]
    chain_order: int
    parameters: tuple[Parameter, ...]
    defaults: tuple[Default, ...]
    functions: tuple[CSource, ...]
    samples: tuple[Sample, ...]
    tables: Mapping[str, Sequence[Sequence[float]]]
    configuration: ConfigurationSource | None = None
    impact: ImpactSource | None = None
    floating: bool = False
    poses: Mapping[str, Sequence[float]] = field(default_factory=dict)
    contacts: tuple[BuiltIn, ...] = ()
    stages: tuple[StageSource, ...] = ()

    @property
    def elastic(self) -> bool:
        """Whether every joint has a spring behind its motor."""
        return is_elastic(self.robot)

    @property
    def coordinates(self) -> int:
        """Number of generalised coordinates."""
        return coordinates_of(self.robot)

    @property
    def independent(self) -> list[str]:
        """Names of the joints whose coordinates describe the robot."""
        return [self.robot.joint_names[i] for i in closed_chain(self.robot).independent]

    @property
    def slides(self) -> list[str]:
        """Names of the sliding joints."""
        return [joint.name for joint in self.robot.joints if joint.kind is JointKind.SLIDE]

    @property
    def fields(self) -> list[Parameter]:
        """Fields of the parameter struct: all parameters that are not frozen."""
        return [p for p in self.parameters if p.frozen is None]

    @property
    def has_params(self) -> bool:
        """Whether there is a parameter struct: for fields, or for the motion of impacts."""
        return bool(self.fields) or self.impact is not None

    def fields_of(self, sample: Sample) -> list[tuple[Parameter, Sequence[float]]]:
        """Return the fields with a sample's values."""
        pairs = zip(self.parameters, sample.parameters, strict=True)
        return [(p, values) for p, values in pairs if p.frozen is None]

    @property
    def shown(self) -> CSource:
        """Return the function of the README's example."""
        name = "reduced_model" if self.has("reduced_model") else "reflected_mass"
        return next(source for source in self.functions if source.function.name == name)

    def has(self, function: str) -> bool:
        """Whether the package has a function of this short name."""
        return function in self.tables


@cache
def _environment() -> jinja2.Environment:
    """Return what compiles the templates, each once in a process."""
    environment = jinja2.Environment(
        loader=jinja2.FileSystemLoader(TEMPLATES),
        undefined=jinja2.StrictUndefined,
        autoescape=False,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    environment.filters["number"] = _number
    environment.filters["comment"] = _comment
    return environment


def render(package: Package) -> tuple[dict[str, str], Costs | None]:
    """Return the text of every file but the manifest by its path, and what was measured of it."""
    name, show = package.prefix, Templates(package)
    rendered = sources(package, show)
    for path in ("test/golden.h", "test/golden.c", "test/run_tests.c", "fuzz/fuzz.c", "LICENSE"):
        rendered[path] = show(Path(path).name)
    rendered |= bindings(interface_of(rendered[f"include/{name}.h"], name), show)
    compiled = sorted(path for path in rendered if path.startswith("src/") and path.endswith(".c"))
    rendered["CMakeLists.txt"] = show("CMakeLists.txt", sources=compiled)
    costs = stored_costs(name, rendered)
    rendered["README.md"] = show("README.md", costs=costs, few_steps=FEW_STEPS)
    return dict(sorted(rendered.items())), costs


def sources(package: Package, show: Templates) -> dict[str, str]:
    """Return the text of every header and source that a program needs, by its path."""
    name = package.prefix
    files = {
        f"include/{name}.h": show("header.h"),
        f"include/{name}_config.h": show("config.h"),
        f"src/{name}_internal.h": show("internal.h"),
        f"src/{name}_common.c": show("common.c"),
        f"src/{name}_sines.c": show("sines.c"),
    }
    internal = []
    if package.impact:
        internal = [package.impact.links, package.impact.joint_frames]
    for source in [*package.functions, *filter(None, internal)]:
        files[f"src/{source.name}.c"] = show("function.c", f=source)
    for stage in package.stages:
        files[f"src/{stage.name}.c"] = show("stage.c", f=stage)
    if package.impact:
        files[f"src/{name}_model.c"] = show("model.c")
        files |= runtime(name, without=() if package.impact.joint_frames else (POINT,))
    if package.poses:
        files[f"src/{name}_candidates.c"] = show("candidates.c")
    if package.contacts:
        files[f"src/{name}_contacts.c"] = show("contacts.c")
    if package.configuration:
        files[f"src/{name}_configuration.c"] = show("configuration.c", c=package.configuration)
    return files


class Templates:
    """A package's templates, which are shown by the name of what they make."""

    def __init__(self, package: Package) -> None:
        name = package.prefix
        self.context: dict[str, Any] = {
            "package": package,
            "name": name,
            "NAME": name.upper(),
            "robot": package.robot,
            "n": package.robot.n,
            "version": softimpact.__version__,
            "scalars": SCALARS,
            "sine": sine,
            "wide": wide_sine,
            "regions": list(REGIONS.values()),
            "hertz_stiffness": HERTZ_STIFFNESS,
            "most_law_points": MOST_POINTS,
            "measured": MEASURED_SAMPLES,
            "layout": 0,
        }
        self.context["layout"] = interface_of(self("header.h"), name).fingerprint()

    def __call__(self, template: str, **more: Any) -> str:
        """Return the text of a template."""
        return _environment().get_template(f"{template}.jinja").render(self.context, **more)


def runtime(name: str, without: Collection[str] = ()) -> dict[str, str]:
    """Return the runtime's sources for a package by path, but for some."""
    known = (path for path in RUNTIME.iterdir() if path.name not in without)
    sources = sorted(path for path in known if path.suffix in (".c", ".h"))
    return {
        f"src/{_renamed(path.name, name)}": _renamed(path.read_text(encoding="utf-8"), name)
        for path in sources
    }


def _renamed(text: str, name: str) -> str:
    """Return the runtime's text with a package's prefix."""
    return text.replace("ROBOT_", f"{name.upper()}_").replace("robot_", f"{name}_")


def _number(value: float) -> str:
    """Return the shortest decimal that reads back as the same double."""
    return repr(float(value) + 0.0)


def _comment(text: str) -> str:
    """Return a name from a model file as it may stand in a C comment."""
    return " ".join(text.replace("*/", "* /").replace("/*", "/ *").split())
