// SPDX-License-Identifier: BSD-3-Clause
// The answer in words and numbers.

const MOTORS = { free: "motors free from first touch on", driven: "motors that keep their speed", servo: "motors that follow their servo" };

const escaped = (text) => String(text).replace(/[&<>"]/g, (c) => `&#${c.charCodeAt(0)};`);

/** A number with so many digits that count. */
export function shown(x, digits = 3) {
  if (x === null || x === undefined || !Number.isFinite(x)) return "–";
  const size = Math.abs(x);
  if (size >= 1e5 || (size < 1e-3 && size > 0)) return x.toExponential(digits - 1).replace("e+", "e");
  return size >= 10 ** (digits - 1) ? x.toFixed(0) : String(Number(x.toPrecision(digits)));
}

const downwards = (v) => (Math.floor(v * 1000) / 1000).toFixed(3); // a safe speed is not rounded up

/** The sentence that a screen reader hears. */
export function sentence(found, state) {
  if (found.failed) return `No answer: ${found.failed}.`;
  const safe = found.keeping ? `Safe up to ${downwards(found.keeping.speed)} metres a second.` : "No safe speed is known.";
  return `${found.worst.force.toFixed(0)} newtons at ${shown(state.speed)} metres a second, ${(100 * found.share).toFixed(0)} per cent of the ${found.binding.name} limit: ${found.ruling}. ${safe}`;
}

/** What of it stands beside the title. */
export function headline(found, state) {
  return found.failed ? "" : `${found.about.title}, ${state.clamped ? "held" : "free"}; ${shown(state.speed)} m/s`;
}

/** What of it stands over the arm where the rest is out of sight. */
export function writeBrief(place, found) {
  const safe = found.keeping && found.about?.permitted ? `; safe ${downwards(found.keeping.speed)} m/s` : "";
  place.textContent = found.failed ? "no answer here" : `${found.worst.force.toFixed(0)} N${safe}`;
  place.className = `brief${found.ruling === "kept" || found.failed ? "" : " bad"}`;
}

export function writeVerdict(place, found, state) {
  if (found.failed) {
    place.className = "verdict none";
    place.innerHTML = `<span class="big">No answer here</span><p>${reason(found)}</p>`;
    return;
  }
  const kept = found.ruling === "kept";
  const { speed } = found.keeping ?? {};
  place.className = `verdict${kept ? "" : " bad"}`;
  const safe = speed === undefined ? "No safe speed is known" : found.about.permitted ? `Safe up to ${downwards(speed)} m/s` : "Not permitted, whatever the force";
  const words = {
    kept: "keeps the limit",
    exceeded: "exceeds the limit",
    "not permitted": `contact with ${escaped(found.about.title.toLowerCase())} is not permitted, whatever the force; limits are for reference`,
  }[found.ruling];
  const pressed = found.keeping?.pressed ? "; what presses on the held body decides" : "";
  place.innerHTML =
    `<span class="big">${safe}</span>` +
    `<div class="bar"><i style="width:${Math.min(100, 100 * found.share).toFixed(1)}%"></i></div>` +
    `<p><strong>${found.binding.force.toFixed(0)} N</strong> at ${shown(state.speed)} m/s: ${(100 * found.share).toFixed(0)} % of ` +
    `${found.binding.limit.toFixed(0)} N (${found.binding.name}); ${words}.</p>` +
    `<p>Worst with ${MOTORS[found.worst.kind]}${pressed}.</p>`;
}

function reason(found) {
  if (/singular/.test(found.failed)) return "The point cannot move along the arrow alone in this posture. Turn the arrow, or choose another point or posture.";
  return `${escaped(found.failed)[0].toUpperCase()}${escaped(found.failed).slice(1)}.`;
}

/** Cards of the numbers that stand for the robot. */
export function writeNumbers(place, found, band, unknown) {
  if (found.failed && !found.masses) {
    place.innerHTML = "";
    return;
  }
  const { masses: m, keeping, two_body: formula } = found;
  const ok = (status, value, unit = "") => (status === 0 ? `${shown(value)} ${unit}` : "–");
  const rotors = unknown ? "rotors unknown" : "";
  const cards = [
    ["Peak, free to driven", found.ends?.every((e) => e.ok) ? `${found.ends.map((e) => e.force.toFixed(0)).join(" – ")} N` : "–", "largest force of all contacts"],
    ["Band of the peak", band ? `${band.low.toFixed(0)} – ${band.high.toFixed(0)} N` : found.failed ? "–" : "…", "95 of 100 cases"],
    ["Two-body formula", formula.status === 0 ? `${formula.force.toFixed(0)} N` : "–", `ISO/TS 15066; safe ${shown(formula.speed)} m/s`],
    ["Limit of the peak", `${found.region.force_limit.toFixed(0)} N`, found.region.clamped ? `${found.region.quasi_static_limit.toFixed(0)} N from 0.5 s on` : "the body can give way"],
    ["m<sub>c</sub>, mass felt", ok(m.mass_status, m.m_c, "kg"), "at the contact point"],
    ["k<sub>r</sub>, stiffness", m.reduced_status === 0 ? `${shown(m.k_r / 1000)} kN/m` : "–", "behind it"],
    ["m<sub>a</sub>, motors' mass", unknown ? "–" : ok(m.reduced_status, m.m_a, "kg"), rotors || "behind the springs"],
    ["GIAF", unknown ? "–" : ok(m.giaf_status, m.giaf), rotors || "1: rotors do not count"],
    ["GIAF along the arrow", unknown ? "–" : ok(m.directional_status, m.directional_giaf), rotors || "share that is not rotors"],
    ["Margin", keeping && found.about.permitted ? `${shown(keeping.speed / found.speed, 3)} ×` : "–", "safe speed over speed"],
  ];
  if (found.ends?.length === 1) cards[0][0] = "Peak";
  place.innerHTML = `<dl class="numbers">${cards.map(([name, value, small]) => `<div><dt>${name}</dt><dd>${value}<small>${small}</small></dd></div>`).join("")}</dl>`;
}

/** What to know of the answer. */
export function writeNotes(place, found, state, content, unknown) {
  const notes = [];
  const warn = (text) => notes.push(`<li class="warn">${escaped(text)}</li>`);
  const say = (text) => notes.push(`<li>${escaped(text)}</li>`);
  const changed = state.springs.some((k, i) => k !== content.start.springs[i]);
  if (!changed) content.assumed.forEach(say);
  if (unknown.length) say(`Rotor inertia of ${unknown.join(", ")} is unknown: motors are taken to keep their speed without an end, the worse case. Enter it under “Rotor inertia”.`);
  (found.worst?.rates ?? []).forEach((rate, i) => {
    const { name, speed, turns } = content.joints[i];
    if (speed !== null && Math.abs(rate) > speed * 1.0001) warn(`${name} would move at ${shown(Math.abs(rate))}, beyond its limit of ${shown(speed)} ${turns ? "rad/s" : "m/s"}.`);
  });
  state.q.forEach((x, i) => {
    const { name, lower, upper } = content.joints[i];
    if (x < lower - 1e-6 || x > upper + 1e-6) warn(`${name} is beyond its limits.`);
  });
  if (found.bounded) say("The budget of steps ended: what is shown is a bound on the safe side.");
  if (found.worst?.contact > 1) say(`The largest force is in contact ${found.worst.contact}, after a rebound.`);
  if (state.motors !== "bracket" && state.motors !== "driven") say("Only these motors are looked at: a robot that drives on longer hits harder.");
  place.innerHTML = notes.join("");
}

export function captionOf(found, kept) {
  if (found.failed) return "";
  const curves = `Contact force with ${found.ends.map((end) => MOTORS[end.kind]).join(" and ")}${found.lumped ? "; dotted: two masses and a spring, the rung below, which knows nothing of motors" : ""}.`;
  if (!kept) return curves;
  const change = (100 * (found.worst.force - kept.worst.force)) / kept.worst.force;
  const safe = kept.keeping ? `, safe up to ${downwards(kept.keeping.speed)} m/s` : "";
  return `${curves} Dashed: kept, ${kept.worst.force.toFixed(0)} N${safe}; now ${Math.abs(change).toFixed(1)} % ${change > 0 ? "more" : "less"}.`;
}
