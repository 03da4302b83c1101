// SPDX-License-Identifier: BSD-3-Clause
// A map of safe speeds: a click takes the posture and the direction of its place.
import { shown } from "./answers.js";
import { sizeOf } from "./sizes.js";

const SHADES = [[68, 1, 84], [59, 82, 139], [33, 145, 140], [94, 201, 98], [253, 231, 37]]; // viridis

function shade(share) {
  const at = Math.min(Math.max(share, 0), 1) * (SHADES.length - 1);
  const k = Math.min(Math.floor(at), SHADES.length - 2);
  return `rgb(${SHADES[k].map((c, i) => Math.round(c + (at - k) * (SHADES[k + 1][i] - c))).join(",")})`;
}

/** The map of a folder of results. */
export function mapStrip(content, changed) {
  const { axes, place, step, safe_speed: speeds, q, direction } = content.map;
  const box = document.createElement("section");
  box.innerHTML = `<h2>Map: largest safe speed</h2>
    <canvas class="map" tabindex="0" role="application" aria-label="Map of safe speeds; arrow keys go from place to place"></canvas>
    <p class="hint" aria-live="polite"></p>`;
  const [canvas, said] = [box.querySelector("canvas"), box.querySelector("p")];
  const known = speeds.filter((v) => v !== null).sort((a, b) => a - b);
  const [low, high] = [known[Math.floor(0.01 * known.length)], known[Math.floor(0.99 * (known.length - 1))]];
  const ends = [0, 1].map((k) => [Math.min(...place.map((p) => p[k])) - step, Math.max(...place.map((p) => p[k])) + step]);
  let chosen = -1, view = null, last = null;

  function take(k) {
    chosen = k;
    const [a, b] = place[k];
    const safe = speeds[k] === null ? "the tip cannot go so" : `safe up to ${shown(speeds[k])} m/s in the map`;
    said.textContent = `${axes[0]} ${a.toFixed(2)} m, ${axes[1]} ${b.toFixed(2)} m: ${safe}.`;
    draw(last);
    changed(speeds[k] === null ? { q: [...q[k]] } : { q: [...q[k]], n: [...direction[k]] });
  }

  function draw(looks) {
    last = looks;
    const { width, height } = sizeOf(canvas);
    if (!width) return;
    const dense = Math.min(window.devicePixelRatio || 1, 2);
    [canvas.width, canvas.height] = [Math.round(width * dense), Math.round(height * dense)];
    const pen = canvas.getContext("2d");
    pen.setTransform(dense, 0, 0, dense, 0, 0);
    const scale = Math.min((width - 90) / (ends[0][1] - ends[0][0]), (height - 34) / (ends[1][1] - ends[1][0]));
    const x = (a) => 40 + scale * (a - ends[0][0]);
    const y = (b) => height - 26 - scale * (b - ends[1][0]);
    view = { x, y, scale };
    const size = scale * step;
    place.forEach(([a, b], k) => {
      pen.fillStyle = speeds[k] === null ? looks.line : shade((speeds[k] - low) / (high - low || 1));
      pen.fillRect(x(a) - size / 2, y(b) - size / 2, size + 0.5, size + 0.5);
    });
    if (chosen >= 0) {
      const [a, b] = place[chosen];
      pen.lineWidth = 3;
      pen.strokeStyle = looks.arrow;
      pen.strokeRect(x(a) - size / 2, y(b) - size / 2, size, size);
    }
    scaleBar(pen, looks, width, height);
    pen.fillStyle = looks.soft;
    pen.textAlign = "center";
    for (const a of marks(ends[0])) pen.fillText(a, x(a), height - 8);
    pen.textAlign = "right";
    for (const b of marks(ends[1])) pen.fillText(b, 34, y(b) + 4);
    pen.textAlign = "left";
    pen.fillText(`${axes} plane, m`, 2, 11);
  }

  const marks = ([from, to]) => [-1.5, -1, -0.5, 0, 0.5, 1, 1.5].filter((m) => m > from && m < to);

  function scaleBar(pen, looks, width, height) {
    pen.font = "11.5px system-ui, sans-serif";
    for (let k = 0; k < 60; ++k) {
      pen.fillStyle = shade(1 - k / 59);
      pen.fillRect(width - 44, 20 + ((height - 60) * k) / 60, 10, (height - 60) / 60 + 1);
    }
    pen.fillStyle = looks.soft;
    pen.textAlign = "right";
    pen.fillText(`${shown(high, 2)} m/s`, width, 13);
    pen.fillText(shown(low, 2), width, height - 28);
  }

  const nearest = (a, b) => place.reduce((best, p, k) => (Math.hypot(p[0] - a, p[1] - b) < Math.hypot(place[best][0] - a, place[best][1] - b) ? k : best), 0);
  canvas.addEventListener("pointerdown", (event) => {
    const spot = canvas.getBoundingClientRect();
    take(nearest(ends[0][0] + (event.clientX - spot.left - 40) / view.scale, ends[1][0] + (spot.bottom - 26 - event.clientY) / view.scale));
  });
  canvas.addEventListener("keydown", (event) => {
    const way = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, 1], ArrowDown: [0, -1] }[event.key];
    if (!way) return;
    event.preventDefault();
    const [a, b] = place[Math.max(chosen, 0)];
    take(nearest(a + step * way[0], b + step * way[1]));
  });
  said.textContent = "Click a place for its posture and its worst direction.";
  return { box, draw, idle: true };
}
