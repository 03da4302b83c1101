// SPDX-License-Identifier: BSD-3-Clause
// The form: builds it once, tells what changes, and shows a state.
import { angles, clamp, minus, add, times, dot, length, towards } from "./vectors.js";
import { shown } from "./answers.js";

const SOFTEST = 300, STIFFEST = 1e6; // N·m/rad

/** A slider with a number beside it. `read` takes it from a state, `write` returns what changes. */
function slider(name, label, { low, high, step, read, write, logarithmic = false, digits = 3, places = 4, title = "" }) {
  const row = document.createElement("div");
  row.className = "row";
  const [first, last] = logarithmic ? [Math.log10(low), Math.log10(high)] : [low, high];
  const fine = logarithmic ? 0.01 : step;
  row.innerHTML =
    `<label for="${name}" title="${title || label}">${label}</label>` +
    `<input type="range" id="${name}" min="${first}" max="${last}" step="${fine}">` +
    `<input type="number" id="${name}-number" aria-label="${label}" min="${low}" step="any">`;
  const [range, number] = row.querySelectorAll("input");
  const value = () => (logarithmic ? Number((10 ** Number(range.value)).toPrecision(3)) : Number(range.value));
  return {
    row,
    watch(changed) {
      range.addEventListener("input", () => changed(write(value())));
      number.addEventListener("change", () => {
        const given = Number(number.value);
        if (number.value !== "" && Number.isFinite(given) && given >= low) changed(write(given));
      });
    },
    show(state) {
      const now = read(state);
      row.hidden = now === undefined;
      if (row.hidden) return;
      if (document.activeElement !== range) range.value = logarithmic ? Math.log10(Math.max(now, low)) : now;
      range.setAttribute("aria-valuetext", shown(now, digits));
      if (document.activeElement !== number) number.value = logarithmic ? shown(now, digits + 1) : Number(now.toFixed(places));
    },
  };
}

function group(title, parts, { folded = false } = {}) {
  const box = document.createElement(folded ? "details" : "fieldset");
  const head = document.createElement(folded ? "summary" : "legend");
  head.textContent = title;
  box.append(head, ...parts.map((part) => part.row));
  return { box, parts };
}

function choices(label, options, { read, write }) {
  const row = document.createElement("div");
  row.className = "row wide";
  row.innerHTML = `<span class="label">${label}</span><span class="choices" role="group" aria-label="${label}"></span>`;
  const buttons = options.map(([value, words, title]) => {
    const button = document.createElement("button");
    Object.assign(button, { type: "button", textContent: words, title: title ?? "" });
    row.lastChild.append(button);
    return { value, button };
  });
  return {
    row,
    watch: (changed) => buttons.forEach(({ value, button }) => button.addEventListener("click", () => changed(write(value)))),
    show(state) {
      const now = read(state);
      buttons.forEach(({ value, button }) => {
        if (now === null) button.removeAttribute("aria-pressed");
        else button.setAttribute("aria-pressed", String(value === now));
      });
    },
  };
}

function picker(name, label, options, { read, write }) {
  const row = document.createElement("div");
  row.className = "row wide";
  row.innerHTML = `<label for="${name}">${label}</label><select id="${name}"></select>`;
  const select = row.lastChild;
  select.append(...options.map(([value, words]) => new Option(words, value)));
  return {
    row,
    watch: (changed) => select.addEventListener("change", () => changed(write(select.value))),
    show: (state) => { select.value = read(state); },
  };
}

function check(name, label, { read, write }) {
  const row = document.createElement("label");
  row.className = "check";
  row.innerHTML = `<input type="checkbox" id="${name}"> ${label}`;
  const box = row.firstChild;
  return {
    row,
    watch: (changed) => box.addEventListener("change", () => changed(write(box.checked))),
    show: (state) => { box.checked = read(state); },
  };
}

const all = (content, value) => content.joints.map(() => value);
const mean = (values) => Math.exp(values.reduce((sum, x) => sum + Math.log(Math.max(x, 1e-9)), 0) / values.length);

/* Where on its link's straight part a contact point is: share, and the part; null off every part. */
function along(content, { body, place }) {
  for (const [a, b] of content.bodies[body].parts) {
    const way = minus(b, a);
    const share = clamp(dot(minus(place, a), way) / dot(way, way), 0, 1);
    if (length(minus(place, add(a, times(share, way)))) < 2e-3) return { share, a, b };
  }
  return null;
}

function whereParts(content, solver) {
  const named = content.points.map((point, k) => [`p${k}`, point.name]);
  const links = content.bodies
    .map(({ parts }, body) => ({ parts, body }))
    .filter(({ parts }) => parts.length)
    .map(({ body }) => [`l${body}`, `link of ${content.joints[body].name}`]);
  const same = (a, b) => length(minus(a, b)) < 1e-6;
  return [
    picker("point", "Point", [...named, ...links, ["", "a point of the arm"]], {
      read: (s) => {
        const k = content.points.findIndex((point) => point.body === s.body && same(point.place, s.place));
        return k >= 0 ? `p${k}` : along(content, s) ? `l${s.body}` : "";
      },
      write: (value) => {
        const k = Number(value.slice(1));
        if (value === "") return {};
        if (value[0] === "p") return { body: content.points[k].body, place: [...content.points[k].place] };
        const [a, b] = content.bodies[k].parts[0];
        return { body: k, place: add(a, times(0.5, minus(b, a))) };
      },
    }),
    slider("along", "Along the link", {
      low: 0, high: 1, step: 0.01, read: (s) => along(content, s)?.share,
      write: (share) => (s) => {
        const at = along(content, s);
        return at ? { place: add(at.a, times(share, minus(at.b, at.a))) } : {};
      },
    }),
    choices("Direction", [["1,0,0", "+x"], ["-1,0,0", "−x"], ["0,1,0", "+y"], ["0,-1,0", "−y"], ["0,0,1", "+z"], ["0,0,-1", "−z"], ["worst", "worst", "The direction of the largest force at this speed"]], {
      read: (s) => s.n.map((x) => Math.round(x * 1e6) / 1e6 + 0).join(","),
      write: (value) => (value === "worst" ? (s) => solver.worst(s) : { n: value.split(",").map(Number) }),
    }),
    slider("azimuth", "Azimuth, °", { low: -180, high: 180, step: 1, places: 1, read: (s) => angles(s.n)[0], write: (a) => (s) => ({ n: towards(a, angles(s.n)[1]) }) }),
    slider("elevation", "Elevation, °", { low: -90, high: 90, step: 1, places: 1, read: (s) => angles(s.n)[1], write: (e) => (s) => ({ n: towards(angles(s.n)[0], clamp(e, -89.9, 89.9)) }) }),
  ];
}

function postureParts(content, solver) {
  const set = (values, i, x) => values.map((old, k) => (k === i ? x : old));
  const joints = content.joints.map((joint, i) =>
    slider(`q${i}`, joint.name, {
      low: joint.lower, high: joint.upper, step: 0.001, title: `${joint.name}, ${joint.turns ? "rad" : "m"}`,
      read: (s) => s.q[i], write: (x) => (s) => ({ q: set(s.q, i, x) }),
    }),
  );
  const parts = [...joints];
  if (content.postures.length > 1) {
    parts.unshift(picker("posture", "Posture", [["", "own"], ...content.postures.map(({ name }, k) => [String(k), name])], {
      read: (s) => { const k = content.postures.findIndex(({ q }) => q.every((x, i) => Math.abs(x - s.q[i]) < 1e-6)); return k < 0 ? "" : String(k); },
      write: (k) => (k === "" ? {} : { q: [...content.postures[Number(k)].q] }),
    }));
  }
  if (content.joints.length > 6) parts.push(selfMotion(solver));
  return parts;
}

/* Slides along the self-motion from where it was taken up; let go, it is in the middle again. */
function selfMotion(solver) {
  const part = slider("self", "Self-motion", { low: -2, high: 2, step: 0.01, read: () => 0, write: (x) => x, title: "Moves the arm while its end stays where it is, rad" });
  part.row.lastChild.remove();
  part.row.classList.add("wide");
  const range = part.row.querySelector("input");
  let from = null;
  part.watch = (changed) => {
    range.addEventListener("input", () => changed((s) => {
      from ??= s.q;
      return { q: solver.slide(from, Number(range.value)).posture };
    }));
    range.addEventListener("change", () => { from = null; range.value = 0; });
    range.addEventListener("blur", () => { from = null; range.value = 0; });
  };
  part.show = () => {};
  return part;
}

function motorParts(content) {
  const servo = (name, label, high) =>
    slider(name, label, { low: 0, high, step: high / 1000, read: (s) => (s.motors === "servo" ? s[name][0] : undefined), write: (k) => ({ [name]: all(content, k) }) });
  return [
    choices("They", [["bracket", "free or driven", "The worse of both ends: what to take where nobody knows"], ["free", "are free"], ["driven", "drive on"], ["servo", "servo"]], { read: (s) => s.motors, write: (motors) => ({ motors }) }),
    slider("reaction", "Reaction, ms", { title: "From first touch until motors are released", low: 0, high: 200, step: 1, read: (s) => (s.reaction_time === null || s.motors === "free" ? undefined : 1e3 * s.reaction_time), write: (ms) => ({ reaction_time: ms / 1e3 }) }),
    check("never", "never released", { read: (s) => s.reaction_time === null, write: (on) => ({ reaction_time: on ? null : 0.02 }) }),
    servo("position_gain", "K<sub>p</sub>, N·m/rad", 1e4),
    servo("damping_gain", "K<sub>d</sub>, N·m·s/rad", 300),
  ];
}

function hardwareParts(content) {
  const springs = { low: SOFTEST, high: STIFFEST, logarithmic: true };
  const parts = [];
  if (content.elastic) parts.push(slider("springs", "k<sub>s</sub>, N·m/rad", { ...springs, title: "Stiffness of all joints", read: (s) => mean(s.springs), write: (k) => ({ springs: all(content, k) }) }));
  parts.push(slider("payload", "Payload, kg", { low: 0, high: Math.max(1, Math.round(content.moving_mass / 3)), step: 0.05, title: "Point mass at the end of the arm", read: (s) => s.payload, write: (payload) => ({ payload }) }));
  return parts;
}

function eachJoint(content, name, label, options) {
  return content.joints.map((joint, i) =>
    slider(`${name}${i}`, joint.name, { ...options, title: `${label} of ${joint.name}`, read: (s) => s[name][i], write: (x) => (s) => ({ [name]: s[name].map((old, k) => (k === i ? x : old)) }) }),
  );
}

/** Build the form; `changed` takes what changes, or a function of the state that returns it. */
export function controlsOf(form, content, solver, changed) {
  const regions = content.regions.map((r) => [r.name, r.permitted ? r.title : `${r.title} (not permitted)`]);
  const groups = [
    group("What is hit", [
      picker("region", "Body region", regions, { read: (s) => s.region, write: (region) => ({ region }) }),
      check("clamped", "held against something rigid", { read: (s) => s.clamped, write: (clamped) => ({ clamped }) }),
      slider("speed", "Speed, m/s", { low: 0.01, high: 2.5, step: 0.01, read: (s) => s.speed, write: (speed) => ({ speed }) }),
    ]),
    group("Where and which way", whereParts(content, solver)),
    group("Posture", postureParts(content, solver)),
    group("Motors in an impact", motorParts(content)),
    group("Hardware", hardwareParts(content)),
  ];
  if (content.elastic) groups.push(group("Joint stiffness, each (N·m/rad)", eachJoint(content, "springs", "Stiffness", { low: SOFTEST, high: STIFFEST, logarithmic: true }), { folded: true }));
  const inertia = { low: 0.001, high: 10, logarithmic: true };
  const together = slider("rotors", "all", { ...inertia, title: "Reflected rotor inertia of all joints", read: (s) => s.rotors.reduce((a, b) => a + b) / s.rotors.length, write: (b) => ({ rotors: all(content, b) }) });
  groups.push(group("Rotor inertia (kg·m²)", [together, ...eachJoint(content, "rotors", "Reflected rotor inertia", inertia)], { folded: !content.unknown_rotors.length }));
  form.append(...groups.map(({ box }) => box));
  const parts = groups.flatMap((g) => g.parts);
  parts.forEach((part) => part.watch(changed));
  form.addEventListener("submit", (event) => event.preventDefault());
  return { show: (state) => parts.forEach((part) => part.show(state)) };
}
