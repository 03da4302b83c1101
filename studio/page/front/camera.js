// SPDX-License-Identifier: BSD-3-Clause
// Where the viewer stands: turns about the vertical, tilts, and looks from a distance.
import { partsOf, reachOf } from "./parts.js";
import { clamp, dot, minus } from "./vectors.js";

/** Return a camera that sees an arm and some room around it. */
export function cameraOn(content, scene) {
  const reach = reachOf(content);
  const ends = scene.status === 0 ? partsOf(content, scene, reach).flatMap(({ a, b }) => [a, b]) : [[0, 0, reach]];
  const corners = [Math.min, Math.max].map((most) => [0, 1, 2].map((k) => most(...ends.map((p) => p[k]))));
  const middle = corners[0].map((low, k) => (low + corners[1][k]) / 2);
  const size = Math.max(0.5 * Math.hypot(...minus(corners[1], corners[0])), 0.4 * reach);
  return { target: middle, reach, size, turn: -0.9, tilt: 0.32, zoom: 1 };
}

/** Return what turns points into pixels: [x, y], depth towards the viewer, and pixels a metre. */
export function projection(camera, width, height) {
  const { turn, tilt, target, reach, size, zoom } = camera;
  const right = [-Math.sin(turn), Math.cos(turn), 0];
  const toViewer = [Math.cos(tilt) * Math.cos(turn), Math.cos(tilt) * Math.sin(turn), Math.sin(tilt)];
  const up = [-Math.sin(tilt) * Math.cos(turn), -Math.sin(tilt) * Math.sin(turn), Math.cos(tilt)];
  const distance = 4.2 * reach;
  const focus = (zoom * Math.min(width, height) * distance) / (2.7 * size);
  function flat(point) {
    const from = minus(point, target);
    const depth = dot(from, toViewer);
    const scale = focus / Math.max(distance - depth, 0.2 * reach);
    return { x: width / 2 + scale * dot(from, right), y: height / 2 - scale * dot(from, up), depth, scale };
  }
  return { flat, right, up, toViewer };
}

/** Turn a camera by a way of the pointer [pixels]. */
export function orbit(camera, dx, dy) {
  camera.turn -= dx / 140;
  camera.tilt = clamp(camera.tilt + dy / 140, -1.45, 1.45);
}

export function zoomBy(camera, factor) {
  camera.zoom = clamp(camera.zoom * factor, 0.4, 5);
}
