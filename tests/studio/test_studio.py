# SPDX-License-Identifier: BSD-3-Clause
"""``softimpact studio``: the page says what Python says, in a real browser, wide and narrow."""

from __future__ import annotations

import json
import re
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from browser import Tab, browser
from command_line import run

from softimpact.simulate import Approach, ImpactHistory, bracket, simulate_impact
from softimpact.simulate.band import impact_band
from softimpact.simulate.tolerances import Tolerances
from softimpact.simulate.trajectory import passes, trajectory
from softimpact.symbolic import (
    REGIONS,
    Contact,
    ImpactModel,
    Motors,
    analyse,
    drives,
    frame_pose,
    limits_of,
    load_robot,
    two_body,
    with_load,
)
from softimpact.symbolic.impact.two_body import moving_mass

ROOT = Path(__file__).parents[2]
STUDY = ROOT / "robots" / "studies" / "panda_24_poses.toml"
PANDA = load_robot("panda")
MOST_BYTES = 3_000_000
FRAME = 16.0
"""Most time of a picture [ms], of which a screen shows 60 a second."""

SIZES = {"wide": (1440, 900), "narrow": (390, 844)}

Q9 = [-1.22, 0.84, 0.72, -2.41, 0.79, 1.97, -2.04]
SITUATIONS: dict[str, dict[str, Any]] = {
    "chest": {"q": Q9, "n": [0, 1, 0], "speed": 0.5},
    "hand, free": {"q": Q9, "n": [0.6, 0, -0.8], "region": "hand", "clamped": False,
                   "springs": [1e5] * 7, "reaction_time": 0.05},
    "forearm, payload": {"q": Q9, "n": [0, 1, 0], "body": 4, "place": [0, 0.05, -0.1],
                         "region": "upper_arm", "payload": 3.0, "springs": [1e4] * 7},
    "driven, never released": {"q": Q9, "n": [0, 1, 0], "motors": "driven", "reaction_time": None,
                               "springs": [3e3] * 7, "speed": 0.1},
}  # fmt: skip


def model_of(state: dict[str, Any]) -> ImpactModel:
    robot = PANDA if not state["payload"] else with_load(PANDA, "hand_tcp", state["payload"])
    x, y, z = state["place"]
    carrier = next(
        name
        for name, frame in robot.frames.items()
        if frame.joint == state["body"] and not np.any(frame.placement.translation)
        and np.allclose(frame.placement.rotation, np.eye(3))
    )  # fmt: skip
    tip = robot.frame(f"{carrier}@{x},{y},{z}").name
    stiff = drives(robot, joint_stiffness=state["springs"], rotor_inertia=state["rotors"])
    return ImpactModel(robot, tip, stiff)


@pytest.fixture(scope="module")
def page(tmp_path_factory: pytest.TempPathFactory) -> Path:
    pytest.importorskip("ziglang")
    out = tmp_path_factory.mktemp("studio") / "page"
    outcome = run("studio", STUDY, "--out", out)
    assert outcome.code == 0, outcome
    assert outcome.out == f"wrote {(out / 'index.html').resolve()}\n"
    return out / "index.html"


@pytest.fixture(scope="module")
def chromium() -> Iterator[Tab]:
    with browser() as tab:
        yield tab


@pytest.fixture(params=SIZES)
def tab(request: pytest.FixtureRequest, chromium: Tab, page: Path) -> Iterator[Tab]:
    yield from shown(request.param, chromium, page)


@pytest.fixture
def wide(chromium: Tab, page: Path) -> Iterator[Tab]:
    yield from shown("wide", chromium, page)


def shown(size: str, chromium: Tab, page: Path) -> Iterator[Tab]:
    width, height = SIZES[size]
    chromium.open("about:blank", width, height)
    chromium.open(page.as_uri(), width, height, mobile=size == "narrow")
    chromium.wait_for("window.softimpact")
    yield chromium
    assert chromium.errors == []


def set_to(tab: Tab, **change: Any) -> dict[str, Any]:
    """Change the page's state as its controls do; return the whole."""
    found = tab.ask(
        f"(softimpact.set({json.dumps(change)}), softimpact.draw(), softimpact.state())"
    )
    assert isinstance(found, dict)
    return found


@pytest.mark.slow
def test_file_stands_alone_and_is_small(page: Path) -> None:
    text = page.read_text(encoding="utf-8")
    assert len(text.encode()) < MOST_BYTES
    assert not re.search(
        r"""(src|href)=["'](?!#)|@import|\bfetch\(|https?://(?!www\.w3\.org)""", text
    )
    assert sorted(path.name for path in page.parent.iterdir()) == ["index.html", "results.json"]


WORDS_MEET = """(() => {
  const texts = [...document.querySelectorAll("#force text")];
  const boxes = texts.map((e) => [e.textContent, e.getBBox()]);
  const meet = ([, a], [, b]) => a.x < b.x + b.width && b.x < a.x + a.width
    && a.y + 4 < b.y + b.height && b.y + 4 < a.y + a.height;
  const met = (a, i) => boxes.slice(i + 1).filter((b) => meet(a, b));
  return boxes.flatMap((a, i) => met(a, i).map((b) => [a[0], b[0]]));
})()"""


@pytest.mark.slow
@pytest.mark.parametrize("speed", [0.3, 0.5, 0.6, 0.8])
def test_words_of_the_plot_do_not_meet(tab: Tab, speed: float) -> None:
    set_to(tab, speed=speed)
    assert tab.ask(WORDS_MEET) == []


@pytest.mark.slow
@pytest.mark.parametrize("name", SITUATIONS)
def test_numbers_are_pythons(wide: Tab, name: str) -> None:
    compare(wide, name)


@pytest.mark.slow
def test_numbers_are_the_same_on_a_telephone(chromium: Tab, page: Path) -> None:
    for tab in shown("narrow", chromium, page):
        compare(tab, "chest")


BRIEF = 3e-4
"""Time [s] in which a damper's push rises to c v, with which the package begins at once."""


def compare(tab: Tab, name: str) -> None:
    tab.ask("softimpact.set(softimpact.content.start)")
    state = set_to(tab, **SITUATIONS[name])
    found = tab.ask("softimpact.found()")
    model = model_of(state)
    figures = analyse(model, state["q"], state["n"])
    place = np.array(frame_pose(model.robot, model.tip, state["q"]).position).ravel()
    assert found["scene"]["contact"] == pytest.approx(place.tolist(), abs=1e-12)
    assert found["masses"]["m_c"] == pytest.approx(figures.m_c, rel=1e-9)
    assert found["masses"]["k_r"] == pytest.approx(figures.k_r, rel=1e-9)
    assert found["masses"]["m_a"] == pytest.approx(figures.m_a, rel=1e-9)
    assert figures.giaf is None or found["masses"]["giaf"] == pytest.approx(figures.giaf, rel=1e-9)
    along = figures.directional_giaf
    assert along is None or found["masses"]["directional_giaf"] == pytest.approx(along, rel=1e-9)

    region = REGIONS[state["region"]]
    formula = two_body(region, state["clamped"], float(moving_mass(PANDA)), state["payload"])
    assert found["two_body"]["force"] == pytest.approx(float(formula.force(state["speed"])))

    approach = Approach(state["q"], state["n"], state["speed"])
    two = simulate_impact(
        model, approach, Contact(region, state["clamped"]), "two_mass", horizon=0.5
    )
    assert found["lumped"]["force"] == pytest.approx(two.peak, rel=2e-3)

    reaction = np.inf if state["reaction_time"] is None else state["reaction_time"]
    contact = Contact(region, state["clamped"])
    limits = limits_of(region, state["clamped"])
    pressing = limits.quasi_static.force if limits.quasi_static else np.inf
    kinds = {"bracket": ("free", "driven")}.get(state["motors"], (state["motors"],))
    shares = []
    for kind, end in zip(kinds, found["ends"], strict=True):

        def at(speed: float, kind: Any = kind) -> ImpactHistory:
            approach = Approach(state["q"], state["n"], speed)
            motors = Motors(kind, reaction_time=reaction)
            return simulate_impact(model, approach, contact, motors=motors, horizon=0.5)

        history = at(state["speed"])
        assert end["kind"] == kind
        assert end["force"] == pytest.approx(history.peak, rel=2e-3)
        assert end["pressing"] == pytest.approx(history.pressing or 0.0, abs=2e-3 * history.peak)
        count = end["count"]
        forces = np.interp(history.time, end["time"][:count], end["over_time"][:count])
        seen = history.time < end["time"][count - 1]
        off, begun = np.abs(forces - history.force)[seen], history.time[seen] > BRIEF
        assert off[begun].max() < 0.02 * history.peak
        assert off[~begun].max() <= 1.01 * region.damping * state["speed"]
        safe = [at(factor * found["keeping"]["speed"]) for factor in (1, 1.03)]
        shares.append(
            [max(h.peak / limits.transient.force, (h.pressing or 0) / pressing) for h in safe]
        )
    kept, exceeded = np.max(shares, axis=0)
    assert kept <= 1 < exceeded
    assert found["share"] == pytest.approx(found["binding"]["force"] / found["binding"]["limit"])


@pytest.mark.slow
def test_band_is_pythons_but_for_the_links(wide: Tab) -> None:
    state = set_to(wide, **SITUATIONS["chest"])
    wide.ask("softimpact.settle()")
    shown = wide.ask("softimpact.band()")
    model = model_of(state)
    contact = Contact(REGIONS["chest"])
    ends, _ = bracket(model, None, Motors())
    band = impact_band(
        model, Approach(state["q"], state["n"], state["speed"]), contact,
        [end for end in ends.values() if isinstance(end, Motors)], limits_of(contact.region, True),
        tolerances=replace(Tolerances(), links=0.0), samples=300,
    ).peak  # fmt: skip
    assert shown["low"] == pytest.approx(band.low, rel=0.05)
    assert shown["high"] == pytest.approx(band.high, rel=0.05)


@pytest.mark.slow
def test_dragging_aims_and_a_click_chooses_a_link(tab: Tab) -> None:
    set_to(tab, q=Q9, n=[0, 1, 0])
    box = tab.ask("(({x, y}) => [x, y])(document.getElementById('arm').getBoundingClientRect())")
    arrow = tab.ask("softimpact.picture().arrow")
    x, y = box[0] + arrow["to"]["x"], box[1] + arrow["to"]["y"]
    tab.mouse("mousePressed", x, y)
    for k in range(1, 9):
        tab.mouse("mouseMoved", x + 2 * k, y + 3 * k)
    tab.mouse("mouseReleased", x + 16, y + 24)
    n = tab.ask("softimpact.state().n")
    assert np.linalg.norm(n) == pytest.approx(1)
    assert 0.03 < np.linalg.norm(np.array(n) - [0, 1, 0]) < 1
    tab.ask("softimpact.draw()")
    tip = tab.ask("softimpact.picture().arrow.to")
    assert 16 * (tip["x"] + box[0] - x) + 24 * (tip["y"] + box[1] - y) > 0

    nearest = tab.ask(
        "(({p, r, body, local}) => ({p, r, body, local}))(softimpact.picture().solids.at(-1))"
    )
    p, r = nearest["p"], nearest["r"]
    tab.click(box[0] + (p["x"] + r["x"]) / 2, box[1] + (p["y"] + r["y"]) / 2)
    state = tab.ask("softimpact.state()")
    assert state["body"] == nearest["body"]
    assert state["place"] == pytest.approx(np.mean(nearest["local"], axis=0).tolist(), abs=1e-3)


@pytest.mark.slow
def test_pictures_are_quick_enough_while_dragging(tab: Tab) -> None:
    found = tab.ask(
        """(() => {
          const page = softimpact;
          page.frames.length = 0;
          for (let k = 0; k < 150; ++k) {
            const q = [...page.state().q];
            q[1] += 0.002 * Math.sin(k / 9);
            page.set({ q });
            page.draw();
          }
          return [...page.frames].sort((a, b) => a - b)[30]; // others may need the processor, too
        })()"""
    )
    assert found < FRAME


@pytest.mark.slow
def test_motors_drive_on_as_long_as_a_rotor_is_unknown(
    chromium: Tab, tmp_path_factory: pytest.TempPathFactory
) -> None:
    folder = tmp_path_factory.mktemp("unknown")  # of the RR, MSM's paper prints none
    outcome = run("studio", "rr", "--out", folder / "page")
    assert outcome.code == 0, outcome
    chromium.open("about:blank", 800, 600)
    chromium.open((folder / "page" / "index.html").as_uri() + "#motors=free", 800, 600)
    chromium.wait_for("window.softimpact")
    for kind in ("free", "bracket", "servo"):
        state = set_to(chromium, motors=kind, reaction_time=0.01)
        assert (state["motors"], state["reaction_time"]) == ("driven", None)
    assert "is unknown" in chromium.ask("document.getElementById('notes').textContent")
    n = len(state["q"])
    assert set_to(chromium, rotors=[0.1] * n)["motors"] == "driven"
    assert set_to(chromium, motors="bracket")["motors"] == "bracket"
    assert chromium.errors == []


@pytest.mark.slow
def test_self_motion_holds_the_end(wide: Tab) -> None:
    set_to(wide, q=Q9)
    found = wide.ask(f"softimpact.solver.slide({json.dumps(Q9)}, 0.7)")
    assert found["done"] == pytest.approx(0.7)
    before, after = (frame_pose(PANDA, "hand_tcp", q) for q in (Q9, found["posture"]))
    assert np.abs(np.array(before.position - after.position)).max() < 1e-8
    assert np.abs(np.array(before.rotation - after.rotation)).max() < 1e-8
    assert np.linalg.norm(np.array(found["posture"]) - Q9) > 0.5
    far = wide.ask(f"softimpact.solver.slide({json.dumps(Q9)}, 20)")
    lower, upper = PANDA.limits
    assert (lower <= far["posture"]).all()
    assert (far["posture"] <= upper).all()


@pytest.mark.slow
def test_link_carries_the_state(wide: Tab, page: Path) -> None:
    state = set_to(wide, **SITUATIONS["hand, free"])
    wide.ask("softimpact.settle()")
    link = wide.ask("location.href")
    assert "region=hand" in link
    wide.ask("softimpact.set(softimpact.content.start)")
    wide.call("Page.navigate", url="about:blank")
    wide.call("Page.navigate", url=link)
    wide.wait_for("window.softimpact")
    again = wide.ask("softimpact.state()")
    assert {k: v for k, v in again.items() if k not in ("q", "n")} == {
        k: v for k, v in state.items() if k not in ("q", "n")
    }
    assert again["q"] == pytest.approx(state["q"], abs=1e-5)
    assert again["n"] == pytest.approx(state["n"], abs=1e-5)
    wide.call("Page.navigate", url="about:blank")
    wide.call("Page.navigate", url=f"{page.as_uri()}#q=1,2&speed=-3&region=nose&body=99&n=0,0,0")
    wide.wait_for("window.softimpact")
    assert wide.ask("softimpact.state()") == wide.ask("softimpact.content.start")


@pytest.mark.slow
def test_nothing_is_wider_than_the_screen_and_all_is_named(tab: Tab) -> None:
    assert tab.ask("document.documentElement.scrollWidth <= innerWidth")
    nameless = tab.ask(
        """[...document.querySelectorAll("input, select, button, canvas, svg[role]")].filter((e) =>
          !e.hidden && !e.getAttribute("aria-label") && !e.labels?.length && !e.textContent.trim())
          .map((e) => e.outerHTML)"""
    )
    assert nameless == []
    tab.ask("softimpact.settle()")
    said = tab.ask("document.getElementById('spoken').textContent")
    assert re.search(r"\d+ newtons at .* per cent of the .* limit: \w+", said)


@pytest.mark.slow
def test_motions_are_scrubbed_as_the_point_moves(wide: Tab, tmp_path: Path) -> None:
    t = np.linspace(0, 1, 11)
    q = Q9 + np.outer(np.sin(t), [0.5, 0.2, 0.1, 0.3, 0, 0.1, 0])
    path = tmp_path / "motion.csv"
    names = ",".join(("t", *PANDA.joint_names))
    np.savetxt(path, np.column_stack([t, q]), delimiter=",", header=names, comments="")
    give(wide, path)
    wide.wait_for("!document.querySelector('.play').hidden")
    moment = """(() => { const r = document.querySelector(".play input"); r.value = 5;
        r.dispatchEvent(new Event("input")); return softimpact.state(); })()"""
    state = wide.ask(moment)
    assert state["q"] == pytest.approx(q[5].tolist())
    J = np.array(ImpactModel(PANDA, "hand_tcp", drives(PANDA)).jacobian(q[5]))
    v = J @ passes(trajectory(t, q)).velocity[5]
    assert state["speed"] == pytest.approx(float(np.linalg.norm(v)), rel=1e-6)
    assert state["n"] == pytest.approx((v / np.linalg.norm(v)).tolist(), abs=1e-6)
    for text, said in {
        "x,y\n1,2\n3,4\n": "has no column 't'",
        f"{names}\n0,{'0,' * 6}0\n0,{'0,' * 6}0\n": "t must rise",
        f"{names}\n0,{'90,' * 6}0\n1,{'0,' * 6}0\n": "look like degrees",
        f"t,joint1\n{'0,0' * 2}\n1,0\n": "no column for joint 'joint2'",
        "": "needs a line of names",
    }.items():
        path.write_text(text)
        give(wide, path)
        wide.wait_for(f"document.getElementById('unable').textContent.includes({json.dumps(said)})")


def give(tab: Tab, path: Path) -> None:
    """Choose a file in the page's file input."""
    tree = tab.call("DOM.getDocument")
    node = tab.call("DOM.querySelector", nodeId=tree["root"]["nodeId"], selector="input[type=file]")
    tab.call("DOM.setFileInputFiles", files=[str(path)], nodeId=node["nodeId"])


@pytest.mark.slow
def test_a_browser_without_webassembly_is_told_so(chromium: Tab, page: Path) -> None:
    without = chromium.call(
        "Page.addScriptToEvaluateOnNewDocument", source="delete window.WebAssembly"
    )
    chromium.open("about:blank", 800, 600)
    chromium.open(page.as_uri(), 800, 600)
    chromium.wait_for("!document.getElementById('unable').hidden")
    assert "needs WebAssembly" in chromium.ask("document.getElementById('unable').textContent")
    chromium.call("Page.removeScriptToEvaluateOnNewDocument", **without)
    assert chromium.errors == []
