# SPDX-License-Identifier: BSD-3-Clause
"""Builds the documentation site offline: python docs/site/build.py [--out DIR].

Pages are the Markdown files of docs/, the README, the change log and the numbered examples.
Formulas become MathML, so that the site needs no script from elsewhere. Warnings are errors.
"""

from __future__ import annotations

import argparse
import ast
import re
import shutil
import subprocess
import sys
from collections.abc import Iterator
from importlib import import_module
from pathlib import Path

from latex2mathml.converter import convert

from softimpact.studio.page.opened import opened
from softimpact.studio.page.write import page_of

SITE = Path(__file__).resolve().parent
DOCS = SITE.parent
ROOT = DOCS.parent
PACKAGES = ("softimpact", "softimpact.symbolic", "softimpact.simulate", "softimpact.optimize",
            "softimpact.codegen", "softimpact.batch")  # fmt: skip
"""Whose public names the reference shows."""

MORE = ("softimpact.simulate.program", "softimpact.simulate.zones",
        "softimpact.simulate.trajectory", "softimpact.optimize.impact.speed_factor")  # fmt: skip
"""Modules whose public names are shown, too."""

FENCES = re.compile(r"(^ *```.*?^ *```$|`[^`\n]+`)", re.DOTALL | re.MULTILINE)
DISPLAY = re.compile(r"\$\$(.+?)\$\$", re.DOTALL)
INLINE = re.compile(r"(?<![\\\w$])\$(?!\s)([^$\n]+?)(?<!\s)\$(?!\d)")
LINK = re.compile(r"\[([^\]\[]*)\]\((?!\w+:|#)([^)#\s]+)(#[^)\s]*)?\)")

FROM_ROOT = {
    "README.md": "index.md",
    "CHANGELOG.md": "changelog.md",
    "CONTRIBUTING.md": "contributing.md",
}
"""Pages of the root folder, and what the site calls them."""


TRIED = "panda.html"
"""The interactive page on the site."""


def with_formulas(text: str) -> str:
    """Return Markdown with its formulas as MathML, code left alone."""
    parts = FENCES.split(text)
    for i in range(0, len(parts), 2):
        block = DISPLAY.sub(lambda m: f"\n\n<div>{_mathml(m[1], 'block')}</div>\n\n", parts[i])
        parts[i] = INLINE.sub(lambda m: _mathml(m[1], "inline"), block)
    return "".join(parts)


def _mathml(formula: str, display: str) -> str:
    text: str = convert(" ".join(formula.split()), display=display)
    return text.replace("\n", " ").replace("_", "&#95;").replace("*", "&#42;")


def page(path: Path) -> str:
    """Return a page of docs/ without its licence line."""
    text = re.sub(r"^<!-- SPDX.*?-->\n", "", path.read_text(encoding="utf-8"))
    return with_formulas(LINK.sub(lambda link: _linked(link, path.parent), text))


def from_root(name: str) -> str:
    """Return a page of the root folder."""
    text = (ROOT / name).read_text(encoding="utf-8")
    return with_formulas(LINK.sub(lambda link: _linked(link, ROOT), text))


def _linked(link: re.Match[str], folder: Path) -> str:
    """Return a link to a page of the site or, what the repository alone has, as words."""
    words, target, rest = link[1], link[2], link[3] or ""
    place = (folder / target).resolve()
    if not place.is_relative_to(ROOT):
        return link[0]
    if place.parent == ROOT and place.name in FROM_ROOT:
        return f"[{words}]({FROM_ROOT[place.name]}{rest})"
    if place.is_relative_to(DOCS):
        return f"[{words}]({place.relative_to(DOCS).as_posix()}{rest})"
    return f"{words} (`{place.relative_to(ROOT).as_posix()}` in the repository)"


def example(path: Path) -> tuple[str, str]:
    """Return the title and the page of an example: its docstring, then its code."""
    text = path.read_text(encoding="utf-8")
    module = ast.parse(text)
    words = (ast.get_docstring(module) or "").replace("``", "`")
    title, _, rest = words.partition("\n")
    number, name = path.stem.split("_", 1)
    title = f"{int(number)}. {title.rstrip('.')}"
    code = "\n".join(text.splitlines()[module.body[0].end_lineno or 0 :]).strip()
    run = f"`examples/{path.name}` in the repository."
    picture = f"![{title}](images/example_{name}.png)\n\n"
    shown = picture if (DOCS / "images" / f"example_{name}.png").is_file() else ""
    return title, f"# {title}\n\n{rest.strip()}\n\n{shown}{run}\n\n```python\n{code}\n```\n"


def reference() -> Iterator[str]:
    """Yield the blocks of the page on Python."""
    yield "# Python"
    yield (
        "What the command line can do, a function does. Names of the packages are imported from "
        "there; `softimpact` itself has the ones that most people need."
    )
    seen: set[object] = set()
    for name in (*PACKAGES, *MORE):
        module = import_module(name)
        yield f"## {name}"
        yield (module.__doc__ or "").strip().partition("\n\n")[0]
        for own in _public(module, name):
            home = getattr(module, own)
            where = getattr(home, "__module__", name)
            if not callable(home) or not str(where).startswith("softimpact"):
                continue
            if home in seen:
                continue
            seen.add(home)
            if name == "softimpact":
                yield f"- `{own}`, see `{where}`"
                seen.discard(home)
            else:
                yield f"::: {where}.{home.__name__}"


def _public(module: object, name: str) -> list[str]:
    listed = getattr(module, "__all__", None)
    if listed is not None:
        return list(listed)
    own = vars(module).items()
    return [key for key, value in own
            if not key.startswith("_") and getattr(value, "__module__", None) == name]  # fmt: skip


def assemble(folder: Path) -> None:
    """Write all pages and the configuration."""
    shutil.rmtree(folder, ignore_errors=True)
    pages = folder / "pages"
    pages.mkdir(parents=True)
    shutil.copytree(DOCS / "images", pages / "images")
    for path in DOCS.glob("*.md"):
        (pages / path.name).write_text(page(path), encoding="utf-8")
    for own, name in FROM_ROOT.items():
        (pages / name).write_text(from_root(own), encoding="utf-8")
    entries = []
    for path in sorted((ROOT / "examples").glob("[0-9]*.py")):
        title, text = example(path)
        name = f"example_{path.stem}.md"
        (pages / name).write_text(text, encoding="utf-8")
        short = f"{title.partition('.')[0]}. {path.stem[3:].replace('_', ' ')}"
        entries.append(f'{{ "{short}" = "{name}" }}')
    (pages / "api.md").write_text("\n\n".join(reference()) + "\n", encoding="utf-8")
    settings = (SITE / "zensical.toml").read_text(encoding="utf-8")
    settings = settings.replace("EXAMPLES", f"[{', '.join(entries)}]")
    settings = settings.replace("SOURCES", (ROOT / "src").as_posix())
    (folder / "zensical.toml").write_text(settings, encoding="utf-8")


def try_it(pages: Path) -> None:
    """Write the interactive page of a study beside the page that explains it, and lead there."""
    study = ROOT / "robots" / "studies" / "panda_24_poses.toml"
    (pages / TRIED).write_text(page_of(opened(str(study))), encoding="utf-8")
    text = (pages / "studio.md").read_text(encoding="utf-8")
    before, picture, after = text.partition("![The page")
    led = f"**[Try it]({TRIED})**: the Panda in its 24 poses.\n\n"
    (pages / "studio.md").write_text(before + led + picture + after, encoding="utf-8")


def main() -> int:
    """Build the site; return an exit code."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=ROOT / "build" / "site")
    folder = parser.parse_args().out
    assemble(folder)
    try_it(folder / "pages")
    command = [sys.executable, "-m", "zensical", "build", "--strict", "--clean"]
    done = subprocess.run(command, cwd=folder, check=False)
    if done.returncode == 0:
        print(f"wrote {folder / 'html' / 'index.html'}")
    return done.returncode


if __name__ == "__main__":
    sys.exit(main())
