// SPDX-License-Identifier: BSD-3-Clause
// What an impact does: asks the robot's C package, and computes nothing itself.
import { unknownRotors } from "./state.js";

/** Kinds of motors by what the page calls them, in C's numbers. */
export const KINDS = { free: 1, driven: 2, servo: 3 };

const NEVER = 1e9; // s; a reaction that comes after every horizon
const ANY_ROTOR = 1; // kg m²; stands in where rotors are unknown and motors drive on: nothing reads it
const STEPS = 8000; // more than a controller has time for
const TIP = 0; // the contact point, which the page moves
const WRITTEN = [0, 9]; // OK and BOUNDED

/** Return functions of a state, which `state.js` describes. */
export function solverOf(pkg, content) {
  const joints = content.joints.length;
  const unknown = (state) => unknownRotors(state, content).length > 0;

  function region(state, scale = {}) {
    const found = content.regions.find((r) => r.name === state.region);
    return {
      ...pkg.body_region({ part: 0, clamped: 0 }),
      stiffness: found.stiffness * (scale.body ?? 1),
      damping: found.damping * (scale.damping ?? 1),
      effective_mass: found.effective_mass,
      hertz_stiffness: found.hertz_stiffness * (scale.law ?? 1),
      law: stiffer(found.law, scale.law ?? 1),
      law_points: found.law?.length ?? 0,
      force_limit: found.transient,
      quasi_static_limit: found.quasi_static,
      clamped: state.clamped ? 1 : 0,
    };
  }

  /* A law's points are depth and force, and the same of the knee. */
  const stiffer = (law, by) => law?.map(([depth, force, ...knee]) => [depth, force * by, knee[0], knee[1] * by]);

  function parameters(state, contact, motors, scale = {}) {
    const scaled = (values, name) => values.map((x, i) => x * (scale[name]?.[i] ?? 1));
    if (unknown(state) && (state.motors !== "driven" || state.reaction_time !== null)) throw new Error("rotors are unknown");
    const rotors = state.rotors.map((b) => (b > 0 || !unknown(state) ? b : ANY_ROTOR));
    const given = {
      ...pkg.default_params(),
      rotor_inertia: scaled(rotors, "rotors"),
      position_gain: gains(state, "position_gain", scale.position_gains),
      damping_gain: gains(state, "damping_gain", scale.damping_gains),
      payload_mass: state.payload,
      payload_com: [0, 0, 0],
      contact,
      moved_by: content.bodies[state.body].moved_by,
      reaction_time: state.reaction_time === null ? NEVER : state.reaction_time * (scale.reaction_time ?? 1),
      horizon: state.horizon,
      motors,
      steps: STEPS,
    };
    return content.elastic ? { ...given, joint_stiffness: scaled(state.springs, "springs") } : given;
  }

  /* Gains count where there is a servo; they would change what stands for the robot, too. */
  function gains(state, name, factor = 1) {
    return state[name].map((k) => (state.motors === "servo" ? k * factor : 0));
  }

  const kindsOf = (state) => (state.motors === "bracket" ? ["free", "driven"] : [state.motors]);
  const choiceOf = (state) => (state.motors === "bracket" ? 0 : KINDS[state.motors]);

  function scene(state) {
    return pkg.scene({ q: state.q, body: state.body, place: state.place });
  }

  /** Everything about the impact of a state. */
  function impact(state) {
    const at = scene(state);
    if (at.status !== 0) return { scene: at, failed: pkg.status_text({ status: at.status }) };
    const { q, n, speed } = state;
    const what = region(state);
    const all = parameters(state, at.contact, choiceOf(state));
    const ends = kindsOf(state).map((kind) => {
      const found = pkg.follow({ q, n, speed, region: what, p: { ...all, motors: KINDS[kind] } });
      return { kind, ...found, ok: WRITTEN.includes(found.status) };
    });
    const lumped = unknown(state) || state.motors === "servo" ? null : pkg.follow_two_masses({ q, n, speed, region: what, p: all });
    const failed = ends.find((end) => !end.ok);
    const keeping = pkg.allowed_speed_at({ q, point: TIP, n, region: what, p: all });
    const worst = ends.reduce((a, b) => (b.ok && (!a || b.force > a.force) ? b : a), null);
    return {
      scene: at,
      region: what,
      ends,
      worst,
      lumped: lumped?.status === 0 ? { kind: "two_mass", ok: true, ...lumped } : null,
      failed: failed && pkg.status_text({ status: failed.status }),
      keeping: WRITTEN.includes(keeping.status) ? keeping : null,
      masses: pkg.masses({ q, n, p: all }),
      two_body: pkg.two_body({ speed, moving_mass: content.moving_mass, region: what, p: all }),
      bounded: ends.some((end) => end.status === 9) || keeping.status === 9,
      ...verdict(state, what, ends, worst),
    };
  }

  /* Which limit is nearest, or furthest exceeded; and whether contact may be designed for at all. */
  function verdict(state, what, ends, worst) {
    const about = content.regions.find((r) => r.name === state.region);
    const used = [{ limit: what.force_limit, force: worst?.force ?? 0, name: `transient ${about.quantity}` }];
    if (state.clamped) {
      const pressing = Math.max(...ends.map((end) => end.pressing ?? 0));
      used.push({ limit: what.quasi_static_limit, force: pressing, name: "quasi-static force" });
    }
    const binding = used.reduce((a, b) => (b.force / b.limit > a.force / a.limit ? b : a));
    const share = binding.force / binding.limit;
    const ruling = !about.permitted ? "not permitted" : share <= 1 ? "kept" : "exceeded";
    return { binding, share, ruling, about };
  }

  /** Peak of the worse end with numbers that vary: row k of what the content has. */
  function varied(state, contact, k) {
    const scale = Object.fromEntries(Object.entries(content.varied).map(([name, rows]) => [name, rows[k]]));
    const what = region(state, scale);
    const peaks = kindsOf(state).map((kind) => {
      const p = parameters(state, contact, KINDS[kind], scale);
      return pkg.peak_force({ q: state.q, n: state.n, speed: state.speed, region: what, p });
    });
    const ok = peaks.every((peak) => WRITTEN.includes(peak.status));
    return ok ? Math.max(...peaks.map((peak) => peak.force)) : NaN;
  }

  /** Safe speed of a state; null where there is none. */
  function safeSpeed(state, contact) {
    const p = parameters(state, contact, choiceOf(state));
    const found = pkg.allowed_speed_at({ q: state.q, point: TIP, n: state.n, region: region(state), p });
    return WRITTEN.includes(found.status) ? found.speed : null;
  }

  /** Direction in which a state's contact point hits hardest; null where none has an answer. */
  function worstDirection(state) {
    const at = scene(state);
    if (at.status !== 0) return null;
    const p = parameters(state, at.contact, choiceOf(state));
    const found = pkg.worst_direction_at({ q: state.q, point: TIP, speed: state.speed, region: region(state), p });
    return WRITTEN.includes(found.status) ? found.n : null;
  }

  /** How the contact point moves at joint velocities: { n, speed }, or null where it rests. */
  function aim(state, dq) {
    const at = scene(state);
    if (at.status !== 0) return null;
    const found = pkg.aim({ q: state.q, dq, p: parameters(state, at.contact, choiceOf(state)) });
    return found.status === 0 ? found : null;
  }

  /** The posture that is some way along the self-motion: { posture, done }. */
  function slide(q, by) {
    const [lower, upper] = ["lower", "upper"].map((end) => content.joints.map((joint) => joint[end]));
    return pkg.slide({ q, by, lower, upper });
  }

  return { joints, unknown, kindsOf, scene, impact, varied, safeSpeed, worstDirection, aim, slide };
}
