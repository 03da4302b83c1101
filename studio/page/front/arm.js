// SPDX-License-Identifier: BSD-3-Clause
// The arm as capsules on a canvas, and what of it is under the pointer.
import { projection } from "./camera.js";
import { partsOf } from "./parts.js";
import { sizeOf } from "./sizes.js";
import { add, minus, times } from "./vectors.js";

const ARROW = 0.3; // of the reach
const HANDLE = 15; // pixels around the arrow's tip that grab it

/** Paint everything; returns the picture's parts as they lie on the canvas, for `underPointer`. */
export function paint(canvas, camera, content, scene, state, looks) {
  const { width, height } = sizeOf(canvas);
  const dense = Math.min(window.devicePixelRatio || 1, 2);
  if (canvas.width !== Math.round(width * dense) || canvas.height !== Math.round(height * dense)) {
    canvas.width = Math.round(width * dense);
    canvas.height = Math.round(height * dense);
  }
  const pen = canvas.getContext("2d");
  pen.setTransform(dense, 0, 0, dense, 0, 0);
  pen.clearRect(0, 0, width, height);
  const view = projection(camera, width, height);
  const parts = partsOf(content, scene, camera.reach);
  paintGround(pen, view, camera.reach, looks);
  paintShadow(pen, view, parts, looks);
  const joints = content.bodies.map((_, body) => jointOf(scene.poses[body], body, camera.reach, content));
  const solids = [...parts, ...joints]
    .map((part) => ({ ...part, p: view.flat(part.a), r: view.flat(part.b) }))
    .sort((one, other) => one.p.depth + one.r.depth - other.p.depth - other.r.depth);
  solids.forEach((solid) => (solid.joint ? paintJoint : paintPart)(pen, solid, looks, state.body));
  const arrow = paintArrow(pen, view, scene.contact, state, camera.reach, looks);
  paintAxes(pen, view, camera, width, height, looks);
  return { view, solids: solids.filter((solid) => solid.body >= 0 && !solid.joint), arrow };
}

function jointOf(pose, body, reach, content) {
  const size = reach * (0.058 - (0.024 * body) / content.bodies.length);
  const axis = [pose[2], pose[5], pose[8]];
  const origin = pose.slice(9, 12);
  return { joint: true, body, a: minus(origin, times(size, axis)), b: add(origin, times(size, axis)), from: size, to: size };
}

function paintGround(pen, view, reach, looks) {
  const cell = reach < 0.5 ? 0.1 : 0.25;
  const count = Math.ceil((1.15 * reach) / cell);
  pen.lineWidth = 1;
  for (let k = -count; k <= count; ++k) {
    const span = Math.sqrt(Math.max(0, count * count - k * k)) * cell;
    for (const [a, b] of [[[k * cell, -span, 0], [k * cell, span, 0]], [[-span, k * cell, 0], [span, k * cell, 0]]]) {
      const [p, r] = [view.flat(a), view.flat(b)];
      pen.strokeStyle = looks.line;
      pen.globalAlpha = k === 0 ? 0.9 : 0.45;
      stroke(pen, p, r);
    }
  }
  pen.globalAlpha = 1;
}

function paintShadow(pen, view, parts, looks) {
  if (view.toViewer[2] < 0) return; // seen from below
  pen.strokeStyle = looks.shadow;
  pen.lineCap = "round";
  parts.forEach(({ a, b, to }) => {
    const [p, r] = [view.flat([a[0], a[1], 0]), view.flat([b[0], b[1], 0])];
    pen.lineWidth = 2 * to * r.scale;
    stroke(pen, p, r);
  });
}

function stroke(pen, p, r) {
  pen.beginPath();
  pen.moveTo(p.x, p.y);
  pen.lineTo(r.x, r.y);
  pen.stroke();
}

/* The outline of a cone with round ends. */
function outline(pen, p, r, wide, slim) {
  const along = Math.atan2(r.y - p.y, r.x - p.x);
  const apart = Math.hypot(r.x - p.x, r.y - p.y);
  const lean = apart > Math.abs(wide - slim) ? Math.acos((wide - slim) / apart) : 0;
  pen.beginPath();
  if (lean === 0) {
    const [c, radius] = wide > slim ? [p, wide] : [r, slim];
    pen.arc(c.x, c.y, radius, 0, 2 * Math.PI);
  } else {
    pen.arc(p.x, p.y, wide, along + lean, along - lean);
    pen.arc(r.x, r.y, slim, along - lean, along + lean);
  }
  pen.closePath();
}

function paintPart(pen, { p, r, from, to, body }, looks, chosen) {
  const [wide, slim] = [from * p.scale, to * r.scale];
  outline(pen, p, r, wide, slim);
  const across = Math.atan2(r.y - p.y, r.x - p.x) + Math.PI / 2;
  const sign = Math.sin(across) > 0 ? -1 : 1; // light comes from above
  const [x, y] = [sign * Math.cos(across) * wide, sign * Math.sin(across) * wide];
  const shade = pen.createLinearGradient(p.x + x, p.y + y, p.x - x, p.y - y);
  shade.addColorStop(0, looks.arm);
  shade.addColorStop(0.3, looks.armLight);
  shade.addColorStop(0.65, looks.arm);
  shade.addColorStop(1, looks.armEdge);
  pen.fillStyle = shade;
  pen.fill();
  pen.lineWidth = body === chosen ? 2 : 1;
  pen.strokeStyle = body === chosen ? looks.arrow : looks.armEdge;
  pen.stroke();
}

function paintJoint(pen, { p, r, from }, looks) {
  const radius = 0.92 * from * ((p.scale + r.scale) / 2);
  const near = p.depth > r.depth ? p : r;
  outline(pen, p, r, radius, radius);
  const shade = pen.createLinearGradient(p.x, p.y - radius, p.x, p.y + radius);
  shade.addColorStop(0, looks.arm);
  shade.addColorStop(1, looks.armEdge);
  pen.fillStyle = shade;
  pen.fill();
  pen.lineWidth = 1;
  pen.strokeStyle = looks.armEdge;
  pen.stroke();
  pen.beginPath();
  pen.arc(near.x, near.y, 0.55 * radius, 0, 2 * Math.PI);
  pen.fillStyle = looks.joint;
  pen.globalAlpha = 0.5;
  pen.fill();
  pen.globalAlpha = 1;
}

/* The arrow ends in the contact point: what is hit is there, and the arm moves towards it. */
function paintArrow(pen, view, contact, state, reach, looks) {
  const from = view.flat(contact);
  const tip = add(contact, times(ARROW * reach, state.n));
  const to = view.flat(tip);
  const along = Math.atan2(to.y - from.y, to.x - from.x);
  const apart = Math.hypot(to.x - from.x, to.y - from.y);
  const head = Math.min(18, 0.6 * apart + 6);
  pen.strokeStyle = looks.arrow;
  pen.fillStyle = looks.arrow;
  pen.lineCap = "round";
  pen.lineWidth = 4;
  stroke(pen, from, { x: to.x - 0.7 * head * Math.cos(along), y: to.y - 0.7 * head * Math.sin(along) });
  pen.beginPath();
  pen.moveTo(to.x, to.y);
  for (const side of [2.65, -2.65]) {
    pen.lineTo(to.x + head * Math.cos(along + side), to.y + head * Math.sin(along + side));
  }
  pen.closePath();
  pen.fill();
  pen.beginPath();
  pen.arc(to.x, to.y, HANDLE, 0, 2 * Math.PI);
  pen.globalAlpha = looks.grabbed ? 0.35 : 0.16;
  pen.fill();
  pen.globalAlpha = 1;
  pen.beginPath();
  pen.arc(from.x, from.y, 6, 0, 2 * Math.PI);
  pen.fill();
  pen.lineWidth = 2;
  pen.strokeStyle = looks.ground;
  pen.stroke();
  return { from, to, size: ARROW * reach * from.scale };
}

function paintAxes(pen, view, camera, width, height, looks) {
  const corner = { x: 40, y: height - 40 };
  pen.font = "600 12px system-ui, sans-serif";
  pen.textAlign = "center";
  pen.textBaseline = "middle";
  [[1, 0, 0], [0, 1, 0], [0, 0, 1]].forEach((axis, k) => {
    const [x, y] = [view.right, view.up].map((side) => side[k]);
    pen.strokeStyle = looks.soft;
    pen.fillStyle = looks.soft;
    pen.lineWidth = 1.5;
    stroke(pen, corner, { x: corner.x + 22 * x, y: corner.y - 22 * y });
    if (Math.hypot(x, y) > 0.2) pen.fillText("xyz"[k], corner.x + 31 * x, corner.y - 31 * y);
  });
}

/** What is at a pixel: the arrow's tip, or a link and where on it, or nothing. */
export function underPointer(picture, x, y) {
  const { to } = picture.arrow;
  if (Math.hypot(to.x - x, to.y - y) < HANDLE + 3) return { arrow: true };
  let best = null; // the last painted one, which covers the others
  picture.solids.forEach((solid) => {
    const { p, r } = solid;
    const [dx, dy] = [r.x - p.x, r.y - p.y];
    const share = Math.min(1, Math.max(0, ((x - p.x) * dx + (y - p.y) * dy) / (dx * dx + dy * dy || 1)));
    const away = Math.hypot(p.x + share * dx - x, p.y + share * dy - y);
    const thick = Math.max((solid.from + share * (solid.to - solid.from)) * p.scale, 10);
    if (away < thick) best = { body: solid.body, share, local: solid.local };
  });
  if (!best) return null;
  const [a, b] = best.local;
  return { body: best.body, place: a.map((_, k) => a[k] + best.share * (b[k] - a[k])) };
}
