// SPDX-License-Identifier: BSD-3-Clause
// The straight parts that an arm is drawn as.
import { length, minus, placed } from "./vectors.js";

/** Return the straight parts of an arm in the base's axes: ends, radii, and the body they are of. */
export function partsOf(content, scene, reach) {
  const slim = (body) => reach * (0.062 - (0.028 * (body + 1)) / content.bodies.length);
  const parts = content.base.map(([a, b]) => ({ body: -1, a, b, from: slim(-1), to: slim(0) }));
  content.bodies.forEach(({ parts: own }, body) => {
    const pose = scene.poses[body];
    own.forEach(([a, b]) => {
      parts.push({ body, a: placed(pose, a), b: placed(pose, b), local: [a, b], from: slim(body), to: slim(body + 1) });
    });
  });
  return parts;
}

/** Length of the arm stretched out, from its parts [m]. */
export function reachOf(content) {
  const parts = [...content.base, ...content.bodies.flatMap((body) => body.parts)];
  return Math.max(parts.reduce((sum, [a, b]) => sum + length(minus(b, a)), 0), 0.1);
}
