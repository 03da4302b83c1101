// SPDX-License-Identifier: BSD-3-Clause
// Vectors of three numbers.

export const add = (a, b) => [a[0] + b[0], a[1] + b[1], a[2] + b[2]];
export const minus = (a, b) => [a[0] - b[0], a[1] - b[1], a[2] - b[2]];
export const times = (k, a) => [k * a[0], k * a[1], k * a[2]];
export const dot = (a, b) => a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
export const length = (a) => Math.hypot(...a);
export const unit = (a) => times(1 / (length(a) || 1), a);
export const clamp = (x, low, high) => Math.min(high, Math.max(low, x));

/** A point of a joint's frame in the base's axes; `pose` is a rotation row by row, then an origin. */
export function placed(pose, p) {
  return [0, 1, 2].map((k) => pose[9 + k] + pose[3 * k] * p[0] + pose[3 * k + 1] * p[1] + pose[3 * k + 2] * p[2]);
}

/** Direction from azimuth and elevation in degrees, and back. */
export function towards(azimuth, elevation) {
  const [a, e] = [azimuth, elevation].map((x) => (x * Math.PI) / 180);
  return [Math.cos(e) * Math.cos(a), Math.cos(e) * Math.sin(a), Math.sin(e)];
}

export function angles(n) {
  const flat = Math.hypot(n[0], n[1]);
  const azimuth = flat > 1e-9 ? Math.atan2(n[1], n[0]) : 0;
  return [azimuth, Math.atan2(n[2], flat)].map((x) => (x * 180) / Math.PI);
}
