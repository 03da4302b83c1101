// SPDX-License-Identifier: BSD-3-Clause
// Plots as SVG.
import { sizeOf } from "./sizes.js";

const WORDS = { free: "motors free", driven: "motors drive on", servo: "servo", two_mass: "two masses" };

/** A few round numbers from 0 to at least `most`. */
export function ticksTo(most, count = 4) {
  const rough = most / count;
  const power = 10 ** Math.floor(Math.log10(rough || 1));
  const step = [1, 2, 2.5, 5, 10].map((k) => k * power).find((k) => k >= rough * 0.999);
  const last = Math.ceil(most / step - 1e-9);
  return Array.from({ length: last + 1 }, (_, k) => Number((k * step).toPrecision(6)));
}

const tag = (name, attributes, text = "") =>
  `<${name} ${Object.entries(attributes).map(([k, v]) => `${k}="${v}"`).join(" ")}>${text}</${name}>`;

/** Force over time of each end of what motors may do, and the limits. */
export function plotForce(svg, found, state, looks, band, at, kept) {
  const { width, height } = sizeOf(svg);
  const box = { left: 44, right: width - 8, top: 20, bottom: height - 30 };
  const ends = found.ends.filter((end) => end.ok);
  const drawn = found.lumped ? [...ends, found.lumped] : ends;
  const last = Math.max(0.02, ...[...drawn, ...(kept ? [kept.worst] : [])].map(lastPressed)) * 1.08;
  const times = ticksTo(1e3 * Math.min(last, state.horizon), 5);
  const { force_limit: limit, quasi_static_limit: pressed } = found.region;
  const top = Math.max(...drawn.map((end) => end.force), band?.high ?? 0, kept?.worst.force ?? 0);
  const showLimit = limit < 2.2 * top;
  const forces = ticksTo(1.06 * Math.max(top, showLimit ? limit : 0), 5);
  const [long, high] = [times.at(-1), forces.at(-1)];
  const x = (ms) => box.left + ((box.right - box.left) * ms) / long;
  const y = (N) => box.bottom - ((box.bottom - box.top) * N) / high;
  const parts = [];
  const taken = []; // heights of words on the right
  forces.forEach((N) => {
    parts.push(tag("line", { x1: box.left, x2: box.right, y1: y(N), y2: y(N), stroke: looks.line, "stroke-width": N ? 0.6 : 1 }));
    parts.push(tag("text", { x: box.left - 6, y: y(N) + 4, "text-anchor": "end", class: "tick" }, N));
  });
  times.forEach((ms) => parts.push(tag("text", { x: x(ms), y: box.bottom + 16, "text-anchor": "middle", class: "tick" }, ms)));
  parts.push(tag("text", { x: box.left - 42, y: 10, class: "tick" }, "force, N"));
  parts.push(tag("text", { x: box.right, y: box.bottom + 28, "text-anchor": "end", class: "tick" }, "time since first touch, ms"));
  if (band) {
    parts.push(tag("rect", { x: box.left, width: box.right - box.left, y: y(Math.min(band.high, high)), height: y(band.low) - y(Math.min(band.high, high)), fill: looks.band }));
    const under = showLimit && Math.abs(y(band.low) - 10 - y(limit)) < 16 ? 13 : -5;
    taken.push(y(band.low) + under);
    parts.push(tag("text", { x: box.right - 4, y: y(band.low) + under, "text-anchor": "end", class: "tick" }, "peak in 95 of 100 cases"));
  }
  const released = 1e3 * (state.reaction_time ?? Infinity);
  if (released > 0 && released < long && ends.some((end) => end.kind !== "free")) {
    parts.push(tag("line", { x1: x(released), x2: x(released), y1: box.top, y2: box.bottom, stroke: looks.soft, "stroke-dasharray": "2 4" }));
    parts.push(tag("text", { x: Math.max(x(released), box.left + 52), y: box.top - 6, "text-anchor": "middle", class: "tick" }, "motors released"));
  }
  if (showLimit) taken.push(y(limit) - 5, y(limit) + 9); // and the line
  if (showLimit) parts.push(limitLine(box, y(limit), looks, `limit ${limit.toFixed(0)} N`));
  if (state.clamped && long > 499 && pressed < high) parts.push(limitLine(box, y(pressed), looks, `from 500 ms on ${pressed.toFixed(0)} N`, "start"));
  if (kept) parts.push(curve(kept.worst, x, y, long, looks.soft, "5 3"));
  [...drawn].reverse().forEach((end) => parts.push(curve(end, x, y, long, looks[end.kind], end.kind === "two_mass" ? "1.5 3.5" : "none")));
  parts.push(...labels(drawn, x, y, box, looks, long, taken));
  if (at !== null) parts.push(...reading(ends, at, box, x, y, long, looks));
  svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
  svg.innerHTML = parts.join("");
  return { timeAt: (px) => Math.min(long, Math.max(0, ((px - box.left) / (box.right - box.left)) * long)) };
}

function limitLine(box, at, looks, words, end = "end") {
  return (
    tag("line", { x1: box.left, x2: box.right, y1: at, y2: at, stroke: looks.limit, "stroke-width": 1.4, "stroke-dasharray": "6 4" }) +
    tag("text", { x: end === "end" ? box.right - 4 : box.left + 5, y: at - 5, "text-anchor": end, "font-weight": 600 }, words)
  );
}

function lastPressed({ time, over_time: force, count, force: peak }) {
  for (let k = count - 1; k >= 0; --k) if (force[k] > 0.01 * peak) return time[k];
  return 0;
}

function curve({ time, over_time: force, count }, x, y, long, colour, dashes = "none") {
  let path = "";
  for (let k = 0; k < count && 1e3 * time[Math.max(k - 1, 0)] <= long; ++k) {
    path += `${k ? "L" : "M"}${x(Math.min(1e3 * time[k], long)).toFixed(1)} ${y(force[k]).toFixed(1)}`;
  }
  return tag("path", { d: path, fill: "none", stroke: colour, "stroke-width": 2.2, "stroke-linejoin": "round", "stroke-dasharray": dashes });
}

/* A dot at each peak; its words are in the corner that forces leave free, beside what else stands there. */
function labels(ends, x, y, box, looks, long, taken) {
  let at = box.top;
  return [...ends].sort((a, b) => b.force - a.force).map((end) => {
    do at += 15;
    while (taken.some((other) => Math.abs(at - other) < 14));
    const words = `${WORDS[end.kind]}: ${end.force.toFixed(0)} N`;
    return (
      tag("circle", { cx: x(Math.min(1e3 * end.peak_time, long)), cy: y(end.force), r: 4, fill: looks[end.kind] }) +
      tag("text", { x: box.right - 4, y: at, "text-anchor": "end", style: `fill:${looks[end.kind]};font-weight:600` }, words)
    );
  });
}

function reading(ends, ms, box, x, y, long, looks) {
  const values = ends.map((end) => forceAt(end, ms / 1e3));
  const words = `${ms.toFixed(1)} ms: ${values.map((f) => `${f.toFixed(0)} N`).join(" / ")}`;
  const flip = x(ms) > (box.left + box.right) / 2;
  return [
    tag("line", { x1: x(ms), x2: x(ms), y1: box.top, y2: box.bottom, stroke: looks.soft }),
    ...values.map((f, k) => tag("circle", { cx: x(ms), cy: y(f), r: 3.4, fill: looks[ends[k].kind] })),
    tag("text", { x: x(ms) + (flip ? -6 : 6), y: box.top - 6, "text-anchor": flip ? "end" : "start" }, words),
  ];
}

/** Force at a moment, linear between those that were kept. */
export function forceAt({ time, over_time: force, count }, t) {
  let k = 1;
  while (k < count - 1 && time[k] < t) ++k;
  const share = (t - time[k - 1]) / (time[k] - time[k - 1] || 1);
  return force[k - 1] + Math.min(1, Math.max(0, share)) * (force[k] - force[k - 1]);
}

/** A curve of safe speeds over something, with the present one marked; `points` are [x, y or null]. */
export function plotTrend(svg, points, now, looks, { logarithmic, label, unit }) {
  const { width, height } = sizeOf(svg);
  const box = { left: 40, right: width - 10, top: 22, bottom: height - 28 };
  const speeds = ticksTo(1.05 * Math.max(0.01, ...points.map(([, v]) => v ?? 0)), 3);
  const scaled = logarithmic ? Math.log10 : (value) => value;
  const [low, high] = [points[0][0], points.at(-1)[0]].map(scaled);
  const x = (value) => box.left + ((box.right - box.left) * (scaled(value) - low)) / (high - low);
  const y = (v) => box.bottom - ((box.bottom - box.top) * v) / speeds.at(-1);
  const marks = logarithmic ? points.map(([value]) => value).filter((value) => /^1e?0*$/.test(String(value))) : ticksTo(points.at(-1)[0], 4).filter((value) => value <= points.at(-1)[0] * 1.001);
  const parts = speeds.map(
    (v) =>
      tag("line", { x1: box.left, x2: box.right, y1: y(v), y2: y(v), stroke: looks.line, "stroke-width": 0.6 }) +
      tag("text", { x: box.left - 5, y: y(v) + 4, "text-anchor": "end", class: "tick" }, v),
  );
  marks.forEach((value) => parts.push(tag("text", { x: x(value), y: box.bottom + 14, "text-anchor": "middle", class: "tick" }, logarithmic ? value.toLocaleString("en") : value)));
  parts.push(tag("text", { x: box.right, y: box.bottom + 26, "text-anchor": "end", class: "tick" }, `${label}, ${unit}`));
  parts.push(tag("text", { x: 2, y: 9, class: "tick" }, "safe speed, m/s"));
  const path = points.filter(([, v]) => v !== null).map(([value, v], k) => `${k ? "L" : "M"}${x(value).toFixed(1)} ${y(v).toFixed(1)}`);
  parts.push(tag("path", { d: path.join(""), fill: "none", stroke: looks.driven, "stroke-width": 2.2 }));
  if (now && now[1] !== null && now[0] >= points[0][0] && now[0] <= points.at(-1)[0]) {
    parts.push(tag("circle", { cx: x(now[0]), cy: y(now[1]), r: 4.5, fill: looks.arrow }));
  }
  svg.setAttribute("viewBox", `0 0 ${width} ${height}`);
  svg.innerHTML = parts.join("");
}
