/* SPDX-License-Identifier: BSD-3-Clause */
/* What a report does in a browser: arms that turn, tables that sort. */
"use strict";

function drawArm(svg) {
  const { points, hits, faint } = JSON.parse(svg.dataset.arm);
  const every = points.concat(hits.map((hit) => hit.place), [[0, 0, 0]], ...faint);
  const middle = [0, 1, 2].map((k) => {
    const values = every.map((p) => p[k]);
    return (Math.min(...values) + Math.max(...values)) / 2;
  });
  const reach = Math.max(...every.map((p) => Math.hypot(...p.map((x, k) => x - middle[k]))), 0.1);
  let turn = 0.9, tilt = 0.35;

  function flat(p) { /* turned about the vertical, then tilted; the page's y points down */
    const [x, y, z] = p.map((value, k) => (value - middle[k]) / (1.25 * reach));
    const right = Math.cos(turn) * x + Math.sin(turn) * y;
    const deep = Math.cos(turn) * y - Math.sin(turn) * x;
    return [right, -(Math.cos(tilt) * z + Math.sin(tilt) * deep)];
  }
  function line(a, b, colour, width) {
    const [[x1, y1], [x2, y2]] = [flat(a), flat(b)];
    return `<line x1="${x1}" y1="${y1}" x2="${x2}" y2="${y2}" stroke="${colour}" ` +
      `stroke-width="${width}" stroke-linecap="round"/>`;
  }
  function dot(p, colour, radius) {
    const [x, y] = flat(p);
    return `<circle cx="${x}" cy="${y}" r="${radius}" fill="${colour}"/>`;
  }
  function arrow(a, b, colour) { /* into a dot at b */
    const [[x1, y1], [x2, y2]] = [flat(a), flat(b)];
    const length = Math.hypot(x2 - x1, y2 - y1);
    if (length < 0.15) return line(a, b, colour, 0.022); /* seen from behind */
    const [u, v] = [(x2 - x1) / length, (y2 - y1) / length];
    const [x, y] = [x2 - 0.05 * u, y2 - 0.05 * v];
    const side = (k) => `${x - 0.1 * u - 0.045 * k * v},${y - 0.1 * v + 0.045 * k * u}`;
    return `<line x1="${x1}" y1="${y1}" x2="${x - 0.08 * u}" y2="${y - 0.08 * v}" stroke="${colour}" ` +
      `stroke-width="0.022"/><polygon points="${x},${y} ${side(1)} ${side(-1)}" fill="${colour}"/>`;
  }
  function chain(places, colour, width) {
    return places.slice(1).map((p, i) => line(places[i], p, colour, width)).join("");
  }
  function drawn(hit) {
    const colour = hit.share > 1 ? "#d55e00" : hit.share > 0.5 ? "#009e73" : "#0072b2";
    const [x, y] = flat(hit.place);
    const back = hit.direction && hit.direction.map((d, k) => hit.place[k] - 0.45 * reach * d);
    const [side, anchor] = x > 0.55 ? [-0.07, "end"] : [0.07, "start"];
    return (back ? arrow(back, hit.place, colour) : "") + dot(hit.place, colour, 0.045) +
      `<text x="${x + side}" y="${y - 0.05}" text-anchor="${anchor}" font-size="0.09" fill="#1a1a1a" stroke="#fff" ` +
      `stroke-width="0.025" paint-order="stroke">${Math.round(100 * hit.share)} %</text>`;
  }
  function paint() {
    const ground = reach * 0.25;
    let picture = line([-ground, 0, 0], [ground, 0, 0], "#b8b8b8", 0.012);
    picture += line([0, -ground, 0], [0, ground, 0], "#b8b8b8", 0.012);
    for (const other of faint) picture += chain(other, "#d0d0d0", 0.02);
    picture += chain(points, "#5c5c5c", 0.035);
    for (const p of points) picture += dot(p, "#1a1a1a", 0.022);
    svg.innerHTML = picture + hits.map(drawn).join("");
  }
  let last = null;
  svg.addEventListener("pointerdown", (event) => { last = event; svg.setPointerCapture(event.pointerId); });
  svg.addEventListener("pointermove", (event) => {
    if (!last) return;
    turn -= (event.clientX - last.clientX) / 120;
    tilt = Math.min(1.5, Math.max(-1.5, tilt + (event.clientY - last.clientY) / 120));
    last = event;
    paint();
  });
  for (const end of ["pointerup", "pointercancel"]) svg.addEventListener(end, () => { last = null; });
  svg.tabIndex = 0;
  svg.addEventListener("keydown", (event) => {
    const step = { ArrowLeft: [0.1, 0], ArrowRight: [-0.1, 0], ArrowUp: [0, -0.1], ArrowDown: [0, 0.1] }[event.key];
    if (!step) return;
    turn += step[0];
    tilt = Math.min(1.5, Math.max(-1.5, tilt + step[1]));
    event.preventDefault();
    paint();
  });
  paint();
}

function makeSortable(table) {
  const body = table.tBodies[0];
  table.querySelectorAll("th").forEach((head, column) => {
    head.addEventListener("click", () => {
      const rises = head.getAttribute("aria-sort") !== "ascending";
      table.querySelectorAll("th").forEach((other) => other.removeAttribute("aria-sort"));
      head.setAttribute("aria-sort", rises ? "ascending" : "descending");
      const value = (row) => {
        const cell = row.cells[column];
        return "value" in cell.dataset ? Number(cell.dataset.value) : cell.textContent;
      };
      const order = (a, b) => (a < b ? -1 : a > b ? 1 : 0);
      [...body.rows]
        .sort((a, b) => (rises ? 1 : -1) * order(value(a), value(b)))
        .forEach((row) => body.append(row));
    });
  });
}

document.querySelectorAll("svg.arm").forEach(drawArm);
document.querySelectorAll("table.sortable").forEach(makeSortable);
