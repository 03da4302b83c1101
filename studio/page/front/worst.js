// SPDX-License-Identifier: BSD-3-Clause
// The direction of the largest force at a speed: looked for among many, then around the best.
import { unit } from "./vectors.js";

const LOOKED_AT = 150;
const ROUNDS = 7;

/** What changes of a state for its worst direction; null where no direction has an answer. */
export function worstDirection(solver, state) {
  const force = (n) => {
    const found = solver.impact({ ...state, n });
    return found.failed ? -1 : found.worst.force;
  };
  let best = { n: state.n, force: force(state.n) };
  const look = (n) => {
    const found = { n, force: force(n) };
    if (found.force > best.force) best = found;
  };
  for (let k = 0; k < LOOKED_AT; ++k) { // half a ball: forces are the same both ways
    const z = (k + 0.5) / LOOKED_AT;
    const around = k * Math.PI * (3 - Math.sqrt(5));
    look([Math.cos(around) * Math.sqrt(1 - z * z), Math.sin(around) * Math.sqrt(1 - z * z), z]);
  }
  for (let round = 0, wide = 0.15; round < ROUNDS; ++round, wide /= 2) {
    const centre = best.n;
    for (let k = 0; k < 8; ++k) {
      const [c, s] = [Math.cos((k * Math.PI) / 4) * wide, Math.sin((k * Math.PI) / 4) * wide];
      const aside = unit(Math.abs(centre[2]) < 0.9 ? [centre[1], -centre[0], 0] : [0, centre[2], -centre[1]]);
      const third = [centre[1] * aside[2] - centre[2] * aside[1], centre[2] * aside[0] - centre[0] * aside[2], centre[0] * aside[1] - centre[1] * aside[0]];
      look(unit(centre.map((x, i) => x + c * aside[i] + s * third[i])));
    }
  }
  return best.force > 0 ? { n: best.n } : null;
}
