// SPDX-License-Identifier: BSD-3-Clause
// Below the arm: a program to scrub through, designs to click, and what a safe speed depends on.
import { shown } from "./answers.js";
import { plotTrend } from "./plot.js";
import { readMotion } from "./motion.js";
import { sizeOf } from "./sizes.js";

function section(title, html) {
  const box = document.createElement("section");
  box.innerHTML = `<h2>${title}</h2>${html}`;
  return box;
}

const apart = (a, b) => Math.hypot(...a.map((x, i) => x - b[i]));

/** A program: scrubbing sets posture, direction and speed as the contact point really moves. */
export function programStrip(content, changed, solver, fail) {
  let motion = content.motion;
  const box = section(
    "Program",
    `<div class="play"><button type="button" aria-label="Play">▶</button>
     <input type="range" min="0" value="0" step="1" aria-label="Moment of the program"><output></output></div>
     <p class="hint"><label class="file" tabindex="0">Open a motion (CSV)<input type="file" accept=".csv,text/csv" hidden></label> <span></span></p>`,
  );
  const [button, range, output, file, said] = ["button", ".play input", "output", "input[type=file]", ".hint span"].map((q) => box.querySelector(q));
  let timer = null;
  function go(k) {
    range.value = k;
    output.textContent = `${motion.t[k].toFixed(2)} s`;
    range.setAttribute("aria-valuetext", output.textContent);
    changed((state) => {
      const at = { ...state, q: motion.q[k] };
      const aim = solver.aim(at, motion.dq[k]);
      said.textContent = aim ? "" : "The contact point rests at this moment.";
      return aim ? { q: [...motion.q[k]], n: aim.n, speed: aim.speed } : { q: [...motion.q[k]] };
    });
  }
  function stop() {
    clearInterval(timer);
    timer = null;
    button.textContent = "▶";
    button.setAttribute("aria-label", "Play");
  }
  function show() {
    box.querySelector(".play").hidden = !motion;
    if (!motion) return;
    range.max = motion.t.length - 1;
    const away = motion.q.map((q) => apart(q, content.start.q));
    range.value = away.indexOf(Math.min(...away));
    output.textContent = `${motion.t[Number(range.value)].toFixed(2)} s`;
  }
  button.addEventListener("click", () => {
    if (timer) return stop();
    button.textContent = "❚❚";
    button.setAttribute("aria-label", "Pause");
    const begun = performance.now() - 1e3 * (motion.t[Number(range.value)] - motion.t[0]);
    timer = setInterval(() => {
      const t = motion.t[0] + (performance.now() - begun) / 1e3;
      const k = motion.t.findIndex((x) => x >= t);
      if (k < 0) return stop();
      return go(k);
    }, 33);
  });
  range.addEventListener("input", () => { stop(); go(Number(range.value)); });
  box.querySelector(".file").addEventListener("keydown", (e) => { if (e.key === "Enter" || e.key === " ") file.click(); });
  file.addEventListener("change", async () => {
    try {
      motion = readMotion(await file.files[0].text(), content.joints);
      show();
      go(0);
      fail("");
    } catch (error) {
      fail(`${file.files[0].name}: ${error.message}`);
    }
    file.value = "";
  });
  show();
  return { box, draw: () => {} };
}

/** The designs of a folder of results, force over deflection; clicking one takes its springs and posture. */
export function designStrip(content, changed) {
  const fronts = [...new Set(content.designs.map((d) => d.front))];
  const known = content.designs.filter((d) => d.deflection !== null && d.force !== null);
  const box = section(
    fronts.length > 1 ? "Designs: Pareto fronts" : "Designs",
    `<svg class="plot points" role="group" aria-label="Designs by force and deflection"></svg><p class="hint"></p>`,
  );
  const [svg, said] = [box.querySelector("svg"), box.querySelector("p")];
  const take = (design) => {
    said.textContent = `${design.front}, ${design.name}: ${shown(design.force)} N with ${shown(1e3 * design.deflection)} mm of deflection.`;
    changed({ q: [...design.q], springs: [...design.springs] });
  };
  function draw(looks, state) {
    const { width, height } = sizeOf(svg);
    if (!known.length || !width) return;
    const colours = [looks.driven, looks.free, looks.good, looks.soft];
    const bends = known.map((d) => 1e3 * Math.max(d.deflection, 1e-6));
    const ends = [0.8 * Math.min(...bends), 1.25 * Math.max(...bends)].map(Math.log10);
    const xs = [0.01, 0.03, 0.1, 0.3, 1, 3, 10, 30, 100].filter((mm) => Math.log10(mm) >= ends[0] && Math.log10(mm) <= ends[1]);
    const forces = known.map((d) => d.force);
    const [least, most] = [Math.min(...forces), Math.max(...forces)];
    const pad = Math.max(0.08 * (most - least), 0.01 * most);
    const box = { left: 46, right: width - 10, top: 18, bottom: height - 28 };
    const x = (mm) => box.left + ((box.right - box.left) * (Math.log10(Math.max(mm, 1e-3)) - ends[0])) / (ends[1] - ends[0]);
    const y = (N) => box.bottom - ((box.bottom - box.top) * (N - least + pad)) / (most - least + 2 * pad);
    const marks = [least, (least + most) / 2, most];
    const text = (px, py, words, anchor = "start") => `<text class="tick" x="${px}" y="${py}" text-anchor="${anchor}">${words}</text>`;
    const isTaken = (d) => d.springs.every((k, i) => Math.abs(k / state.springs[i] - 1) < 1e-5) && d.q.every((q, i) => Math.abs(q - state.q[i]) < 1e-5);
    svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
    svg.innerHTML =
      marks.map((N) => `<line x1="${box.left}" x2="${box.right}" y1="${y(N)}" y2="${y(N)}" stroke="${looks.line}" stroke-width=".6"/>${text(box.left - 5, y(N) + 4, N.toFixed(0), "end")}`).join("") +
      xs.map((mm) => text(x(mm), box.bottom + 14, mm, "middle")).join("") +
      text(box.right, box.bottom + 26, "deflection, mm", "end") + text(2, 10, "worst force, N") +
      fronts.map((front, k) => text(box.left + 70 + k * 78, 10, `<tspan fill="${colours[k % 4]}">●</tspan> ${front}`)).join("") +
      known.map((d, k) => `<circle tabindex="0" role="button" data-k="${k}" aria-label="${d.front}: ${shown(d.force)} newtons, ${shown(1e3 * d.deflection)} millimetres" cx="${x(1e3 * d.deflection)}" cy="${y(d.force)}" r="${isTaken(d) ? 7.5 : 5}" fill="${colours[fronts.indexOf(d.front) % 4]}" stroke="${isTaken(d) ? looks.limit : "none"}" stroke-width="2"/>`).join("");
  }
  const pick = (event) => { const k = event.target.dataset?.k; if (k !== undefined) take(known[Number(k)]); };
  svg.addEventListener("click", pick);
  svg.addEventListener("keydown", (event) => { if (event.key === "Enter" || event.key === " ") { event.preventDefault(); pick(event); } });
  if (!known.length) svg.remove();
  const others = content.designs.filter((d) => !known.includes(d));
  others.forEach((design) => {
    const button = Object.assign(document.createElement("button"), { type: "button", textContent: design.name });
    button.addEventListener("click", () => changed({ q: [...design.q], springs: [...design.springs] }));
    box.append(button);
  });
  said.textContent = known.length ? "Click a design to see its springs and posture." : "Postures of the robust design:";
  return { box, draw };
}

const range = (low, high, count, logarithmic) =>
  Array.from({ length: count }, (_, k) => (logarithmic ? low * (high / low) ** (k / (count - 1)) : low + ((high - low) * k) / (count - 1)));

/** Safe speed over one number, the rest as it is. */
export function trendStrip(content, solver) {
  const over = {
    reaction: { label: "motors released after", unit: "ms", values: range(0, 100, 26), now: (s) => (s.reaction_time === null ? Infinity : 1e3 * s.reaction_time), at: (s, ms) => ({ ...s, reaction_time: ms / 1e3 }) },
    springs: { label: "joint stiffness of all", unit: "N·m/rad", logarithmic: true, values: range(300, 1e6, 29, true), now: (s) => (s.springs.every((k) => Math.abs(k / s.springs[0] - 1) < 1e-6) ? s.springs[0] : null), at: (s, k) => ({ ...s, springs: s.springs.map(() => k) }) },
    payload: { label: "payload", unit: "kg", values: range(0, Math.max(1, Math.round(content.moving_mass / 3)), 16), now: (s) => s.payload, at: (s, payload) => ({ ...s, payload }) },
  };
  if (!content.elastic) delete over.springs;
  const names = { reaction: "reaction time", springs: "joint stiffness", payload: "payload" };
  const box = section(
    "Safe speed over",
    `<select aria-label="Safe speed over">${Object.keys(over).map((k) => `<option value="${k}">${names[k]}</option>`).join("")}</select>
     <svg class="plot points" role="img" aria-label="Safe speed over one number"></svg>`,
  );
  const [select, svg] = [box.querySelector("select"), box.querySelector("svg")];
  box.querySelector("h2").append(" ", select);
  let last = null;
  function draw(looks, state, found) {
    last = [looks, state, found];
    if (!found.scene?.contact || !sizeOf(svg).width) return;
    if (select.value === "reaction" && solver.unknown(state)) select.value = "payload"; // motors that let go need their rotors
    const how = over[select.value];
    const points = how.values.map((value) => [value, solver.safeSpeed(how.at(state, value), found.scene.contact)]);
    if (points.every(([, v]) => v === null)) { svg.innerHTML = ""; return; }
    const now = how.now(state);
    plotTrend(svg, points, now === null ? null : [now, found.keeping?.speed ?? null], looks, how);
    svg.setAttribute("aria-label", `Safe speed from ${shown(points[0][1])} to ${shown(points.at(-1)[1])} metres a second as ${names[select.value]} goes from ${shown(points[0][0])} to ${shown(points.at(-1)[0])} ${how.unit}`);
  }
  select.addEventListener("change", () => { if (last) draw(...last); });
  return { box, draw, idle: true };
}
