// SPDX-License-Identifier: BSD-3-Clause
// The page: one state, drawn anew whenever it changes.
import { instantiate } from "./package.js";
import { captionOf, headline, sentence, writeBrief, writeNotes, writeNumbers, writeVerdict } from "./answers.js";
import { paint, underPointer } from "./arm.js";
import { cameraOn, orbit, zoomBy } from "./camera.js";
import { controlsOf } from "./controls.js";
import { plotForce } from "./plot.js";
import { asHash, cautious, firstState, fromHash, unknownRotors, withinLimits } from "./state.js";
import { mapStrip } from "./map.js";
import { solverOf } from "./solver.js";
import { designStrip, programStrip, trendStrip } from "./strip.js";
import { add, times, unit } from "./vectors.js";

const QUIET = 140; // ms without a change before what takes longer is done

const byId = (id) => document.getElementById(id);
const fail = (words) => {
  byId("unable").textContent = words;
  byId("unable").hidden = !words;
};

function looksOf() {
  const style = getComputedStyle(document.documentElement);
  const names = ["ground", "ink", "soft", "line", "free", "driven", "servo", "two_mass", "good", "bad", "limit", "arm", "arm-edge", "arm-light", "joint", "arrow", "shadow", "band"];
  return Object.fromEntries(names.map((name) => [name.replace(/-(.)/, (_, c) => c.toUpperCase()), style.getPropertyValue(`--${name}`).trim()]));
}

async function packageOf(base64) {
  const packed = Uint8Array.from(atob(base64), (c) => c.charCodeAt(0));
  return instantiate(await WebAssembly.compile(packed));
}

function start(pkg, content) {
  const solver = solverOf(pkg, content);
  solver.worst = (state) => {
    const n = solver.worstDirection(state);
    return n === null ? null : { n };
  };
  let state = fromHash(location.hash, content);
  let looks = looksOf();
  let found = null, picture = null, plotted = null, band = null, reading = null, kept = null, pending = false, quiet = null;
  const times_ = [];
  const camera = cameraOn(content, solver.scene(state));
  const canvas = byId("arm");

  function changed(what) {
    const change = typeof what === "function" ? what(state) : what;
    if (!change) return;
    state = cautious({ ...state, ...change, q: withinLimits(change.q ?? state.q, content) }, content);
    band = null;
    redraw();
    clearTimeout(quiet);
    quiet = setTimeout(settle, QUIET);
  }

  function redraw() {
    if (pending) return;
    pending = true;
    requestAnimationFrame(() => {
      pending = false;
      draw();
    });
  }

  function draw() {
    const begun = performance.now();
    found = { ...solver.impact(state), speed: state.speed };
    if (found.scene.status === 0) picture = paint(canvas, camera, content, found.scene, state, looks);
    byId("said").textContent = headline(found, state);
    writeBrief(byId("brief"), found);
    writeVerdict(byId("verdict"), found, state);
    writeNumbers(byId("numbers"), found, band, solver.unknown(state));
    writeNotes(byId("notes"), found, state, content, unknownRotors(state, content));
    drawPlot();
    controls.show(state);
    strips.filter((strip) => !strip.idle).forEach((strip) => strip.draw(looks, state, found));
    times_.push(performance.now() - begun);
  }

  function drawPlot() {
    byId("force").style.visibility = found.failed ? "hidden" : "";
    byId("force-caption").textContent = captionOf(found, kept);
    if (found.failed) return;
    plotted = plotForce(byId("force"), found, state, looks, band, reading, kept);
    byId("force").setAttribute("aria-label", `Contact force over time. ${sentence(found, state)}`);
  }

  /* What is done once nothing changes any more: link, words, trend, band. */
  function settle() {
    const hash = asHash(state, content);
    try {
      history.replaceState(null, "", hash ? `#${hash}` : location.pathname + location.search);
    } catch {
      location.replace(`#${hash}`); // some browsers know no history of files
    }
    canvas.setAttribute("aria-label", `${content.robot}. ${sentence(found, state)}`);
    byId("spoken").textContent = sentence(found, state);
    strips.filter((strip) => strip.idle).forEach((strip) => strip.draw(looks, state, found));
    if (!found.failed) {
      const peaks = content.varied.body.map((_, k) => solver.varied(state, found.scene.contact, k)).filter(Number.isFinite);
      peaks.sort((a, b) => a - b);
      const at = (share) => { const x = share * (peaks.length - 1), k = Math.floor(x); return peaks[k] + (x - k) * ((peaks[k + 1] ?? peaks[k]) - peaks[k]); };
      band = peaks.length > 40 ? { low: at(0.025), high: at(0.975) } : null;
      writeNumbers(byId("numbers"), found, band, solver.unknown(state));
      drawPlot();
    }
  }

  const controls = controlsOf(byId("controls"), content, solver, changed);
  const strips = [programStrip(content, changed, solver, fail), trendStrip(content, solver)];
  if (content.designs.length) strips.unshift(designStrip(content, changed));
  if (content.map) strips.unshift(mapStrip(content, changed));
  byId("strip").append(...strips.map((strip) => strip.box));
  watchCanvas();
  watchPlot();
  watchPage();
  if (content.warnings.length) {
    byId("ignored").hidden = false;
    byId("ignored").querySelector("summary").textContent = `What to know of the robot's file (${content.warnings.length})`;
    byId("ignored").querySelector("ul").append(...content.warnings.map((text) => Object.assign(document.createElement("li"), { textContent: text })));
  }
  byId("main").hidden = false;
  draw();
  settle();
  window.softimpact = { content, solver, state: () => state, set: changed, found: () => found, band: () => band, frames: times_, picture: () => picture, draw, settle };

  function watchCanvas() {
    const fingers = new Map();
    let grabbed = null, moved = 0, rim = 1, gap = 0, inside = true;
    const at = (event) => { const box = canvas.getBoundingClientRect(); return [event.clientX - box.left, event.clientY - box.top]; };
    canvas.addEventListener("pointerdown", (event) => {
      fingers.set(event.pointerId, [event.clientX, event.clientY]);
      canvas.setPointerCapture(event.pointerId);
      grabbed = underPointer(picture, ...at(event)) ?? {};
      moved = 0;
      inside = true;
      rim = depthOf(state.n) < 0 ? -1 : 1;
      if (grabbed.arrow) { looks.grabbed = true; canvas.classList.add("aiming"); }
    });
    canvas.addEventListener("pointermove", (event) => {
      if (!fingers.has(event.pointerId)) {
        canvas.classList.toggle("over", Boolean(underPointer(picture, ...at(event))));
        return;
      }
      const [x, y] = fingers.get(event.pointerId);
      const [dx, dy] = [event.clientX - x, event.clientY - y];
      fingers.set(event.pointerId, [event.clientX, event.clientY]);
      moved += Math.hypot(dx, dy);
      if (fingers.size === 2) pinch();
      else if (grabbed.arrow) aimAt(...at(event));
      else if (moved > 5) { orbit(camera, dx, dy); redraw(); }
    });
    const end = (event) => {
      fingers.delete(event.pointerId);
      gap = 0;
      if (event.type === "pointerup" && moved <= 5 && grabbed?.place) changed({ body: grabbed.body, place: grabbed.place });
      looks.grabbed = false;
      canvas.classList.remove("aiming");
      if (fingers.size === 0) grabbed = null;
      redraw();
    };
    canvas.addEventListener("pointerup", end);
    canvas.addEventListener("pointercancel", end);
    canvas.addEventListener("wheel", (event) => { event.preventDefault(); zoomBy(camera, Math.exp(-event.deltaY / 600)); redraw(); }, { passive: false });
    canvas.addEventListener("keydown", (event) => {
      const turn = { ArrowLeft: [14, 0], ArrowRight: [-14, 0], ArrowUp: [0, 14], ArrowDown: [0, -14] }[event.key];
      if (turn) orbit(camera, ...turn);
      else if (event.key === "+" || event.key === "=") zoomBy(camera, 1.15);
      else if (event.key === "-") zoomBy(camera, 1 / 1.15);
      else return;
      event.preventDefault();
      redraw();
    });
    function pinch() {
      const [a, b] = [...fingers.values()];
      const wide = Math.hypot(a[0] - b[0], a[1] - b[1]);
      if (gap) zoomBy(camera, wide / gap);
      gap = wide;
      redraw();
    }
    function depthOf(n) { return n.reduce((sum, x, k) => sum + x * picture.view.toViewer[k], 0); }
    /* The arrow's tip follows the pointer on a ball about the contact point; over its rim it goes behind. */
    function aimAt(x, y) {
      const { view, arrow } = picture;
      let [right, up] = [(x - arrow.from.x) / arrow.size, (arrow.from.y - y) / arrow.size];
      const flat = Math.hypot(right, up);
      if (flat > 1 && inside) rim = -rim; // over the rim
      inside = flat <= 1;
      if (flat > 1) [right, up] = [right / flat, up / flat];
      const deep = rim * Math.sqrt(Math.max(0, 1 - right * right - up * up));
      changed({ n: unit(add(add(times(right, view.right), times(up, view.up)), times(deep, view.toViewer))) });
    }
  }

  function watchPlot() {
    const svg = byId("force");
    svg.addEventListener("pointermove", (event) => { if (!plotted || found.failed) return; reading = plotted.timeAt(event.clientX - svg.getBoundingClientRect().left); drawPlot(); });
    svg.addEventListener("pointerleave", () => { reading = null; if (plotted && !found.failed) drawPlot(); });
  }

  function watchPage() {
    byId("copy").addEventListener("click", async () => {
      settle();
      try {
        await navigator.clipboard.writeText(location.href);
        byId("copy").textContent = "Copied";
      } catch {
        window.prompt("The link to this state:", location.href);
      }
      setTimeout(() => { byId("copy").textContent = "Copy link"; }, 1500);
    });
    byId("keep").addEventListener("click", () => {
      kept = kept || found.failed ? null : found;
      byId("keep").setAttribute("aria-pressed", String(Boolean(kept)));
      byId("keep").textContent = kept ? "Let go" : "Keep to compare";
      drawPlot();
    });
    byId("reset").addEventListener("click", () => changed(firstState(content)));
    window.addEventListener("hashchange", () => changed(fromHash(location.hash, content)));
    window.addEventListener("laid-out", redraw);
    matchMedia("(prefers-color-scheme: dark)").addEventListener("change", () => { looks = looksOf(); draw(); settle(); });
  }
}

(async () => {
  if (typeof WebAssembly !== "object") {
    fail("This page computes in your browser and needs WebAssembly: use a current Firefox, Chrome, Edge or Safari, or allow it.");
    return;
  }
  try {
    start(await packageOf(byId("module").textContent.trim()), JSON.parse(byId("content").textContent));
  } catch (error) {
    fail(`The page cannot start: ${error.message}`);
    throw error;
  }
})();
