# SPDX-License-Identifier: BSD-3-Clause
"""A package whose functions call what several of them compute."""

from __future__ import annotations

from dataclasses import replace

from ..functions import Symbols, stages_of
from ..sharing.split import split_all
from ..sources.function import CSource
from ..sources.stage import StageSource
from .render import Package


def with_stages(package: Package, symbols: Symbols) -> Package:
    """Return a package whose functions call what several of them hold.

    Args:
        package: whose functions compute everything on their own.
        symbols: over which they are.
    """
    impact = package.impact
    internal = [impact.links, impact.joint_frames] if impact else []
    sources = {f.function.name: f for f in [*package.functions, *filter(None, internal)]}
    stages = stages_of(symbols)
    at_q = list(stages.uses_at(symbols.q))
    uses = {
        name: [*at_q, *(u for q in f.function.elsewhere for u in stages.uses_at(q))]
        for name, f in sources.items()
    }
    graphs = {name: f.function.plain for name, f in sources.items()}
    splits = split_all(graphs, uses, stages.values, len(symbols.inputs))
    called = {stage.name: stage for split in splits.values() for stage in split.calls}

    def shared(source: CSource) -> CSource:
        split = splits[source.function.name]
        graph = source.function.with_reciprocals(split.graph)
        return replace(source, split=replace(split, graph=graph)) if split.calls else source

    if impact:
        frames = impact.joint_frames and shared(impact.joint_frames)
        impact = replace(impact, links=shared(impact.links), joint_frames=frames)
    return replace(
        package,
        functions=tuple(map(shared, package.functions)),
        impact=impact,
        stages=tuple(
            StageSource(package.prefix, package.parameters, called[name]) for name in sorted(called)
        ),
    )
