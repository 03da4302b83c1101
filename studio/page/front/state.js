// SPDX-License-Identifier: BSD-3-Clause
// What the page shows, and how a link carries it.
import { clamp, unit } from "./vectors.js";

const LISTS = ["q", "n", "place", "springs", "rotors", "position_gain", "damping_gain"];
const NUMBERS = ["speed", "reaction_time", "payload", "body", "horizon"];
const MOTORS = ["bracket", "free", "driven", "servo"];

/** Where the page begins: q, n, body and place of the contact, speed, region, motors and so on. */
export function firstState(content) {
  return cautious(structuredClone(content.start), content);
}

/** Names of the joints whose rotors nobody has stated yet. */
export function unknownRotors(state, content) {
  return content.joints.map((joint, i) => (state.rotors[i] > 0 ? "" : joint.name)).filter((name) => content.unknown_rotors.includes(name));
}

/** A state whose motors drive on without an end as long as a rotor is unknown: the worse case. */
export function cautious(state, content) {
  return unknownRotors(state, content).length > 0 ? { ...state, motors: "driven", reaction_time: null } : state;
}

const short = (x) => String(Number(x.toPrecision(6)));

/** The part of a link after its #: only what differs from where the page begins. */
export function asHash(state, content) {
  const first = firstState(content);
  const parts = Object.entries(state)
    .filter(([name, value]) => JSON.stringify(value) !== JSON.stringify(first[name]))
    .map(([name, value]) => {
      const text = Array.isArray(value) ? value.map(short).join(",") : typeof value === "number" ? short(value) : String(value);
      return `${name}=${encodeURIComponent(text).replaceAll("%2C", ",")}`;
    });
  return parts.join("&");
}

/** The state that a link describes; what it does not say, or says wrongly, is as at the beginning. */
export function fromHash(hash, content) {
  const state = firstState(content);
  new URLSearchParams(hash.replace(/^#/, "")).forEach((text, name) => {
    const value = readValue(name, text, state, content);
    if (value !== undefined) state[name] = value;
  });
  state.n = unit(state.n);
  return cautious(state, content);
}

function readValue(name, text, state, content) {
  if (LISTS.includes(name)) {
    const numbers = text.split(",").map(Number);
    const whole = numbers.length === state[name].length && numbers.every(Number.isFinite);
    const fits = whole && (name !== "n" || numbers.some((x) => x !== 0)) && (!isDrive(name) || numbers.every((x) => x >= 0));
    return fits && (name !== "springs" || numbers.every((x) => x > 0)) ? numbers : undefined;
  }
  if (name === "reaction_time" && text === "null") return null;
  if (NUMBERS.includes(name)) {
    const number = Number(text);
    if (text === "" || !Number.isFinite(number) || number < 0) return undefined;
    if (name === "body") return Number.isInteger(number) && number < content.bodies.length ? number : undefined;
    return (name === "speed" || name === "horizon") && number === 0 ? undefined : number;
  }
  if (name === "region") return content.regions.some((r) => r.name === text) ? text : undefined;
  if (name === "clamped") return text === "true";
  if (name === "motors") return MOTORS.includes(text) ? text : undefined;
  return undefined;
}

const isDrive = (name) => ["springs", "rotors", "position_gain", "damping_gain"].includes(name);

/** Joint angles within their limits. */
export function withinLimits(q, content) {
  return q.map((x, i) => clamp(x, content.joints[i].lower, content.joints[i].upper));
}
