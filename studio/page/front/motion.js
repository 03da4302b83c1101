// SPDX-License-Identifier: BSD-3-Clause
// A motion from a CSV file: a column t [s] and one for each joint [rad, m].

const MOST = 2000; // samples that are kept

export function readMotion(text, joints) {
  const lines = text.replace(/^\uFEFF/, "").split(/\r?\n/).filter((line) => line.trim() && !line.startsWith("#"));
  if (lines.length < 3) throw new Error("needs a line of names and two samples at least");
  const mark = [",", ";", "\t"].reduce((a, b) => (lines[0].split(b).length > lines[0].split(a).length ? b : a));
  const names = lines[0].split(mark).map((name) => name.trim().replace(/^"|"$/g, ""));
  const at = names.indexOf("t");
  if (at < 0) throw new Error(`has no column 't' in its first line; needs t, ${joints.map((j) => j.name).join(", ")}`);
  const columns = joints.map(({ name }) => {
    const k = names.indexOf(name);
    if (k < 0) throw new Error(`has no column for joint '${name}'`);
    return k;
  });
  const rows = lines.slice(1).map((line, k) => {
    const numbers = line.split(mark).map(Number);
    if (![at, ...columns].every((c) => Number.isFinite(numbers[c]))) throw new Error(`sample ${k + 1} holds no finite number`);
    return numbers;
  });
  const t = rows.map((row) => row[at]);
  const q = rows.map((row) => columns.map((c) => row[c]));
  t.forEach((x, k) => {
    if (k > 0 && !(x > t[k - 1])) throw new Error(`t must rise, but goes from ${t[k - 1]} to ${x} s at sample ${k + 1}`);
  });
  joints.forEach(({ name, turns }, i) => {
    if (turns && q.some((row) => Math.abs(row[i]) > 4 * Math.PI)) throw new Error(`joint '${name}' goes far beyond its limits: angles are to be in radians, and look like degrees`);
  });
  const dq = t.map((_, k) => rates(t, q, k));
  const every = Math.ceil(t.length / MOST);
  const kept = (values) => values.filter((_, k) => k % every === 0);
  return { t: kept(t), q: kept(q), dq: kept(dq) };
}

/* Joint velocities by differences of second order, as NumPy's gradient has them. */
function rates(t, q, k) {
  if (k === 0 || k === t.length - 1) {
    const [a, b] = k === 0 ? [0, 1] : [k - 1, k];
    return q[a].map((x, i) => (q[b][i] - x) / (t[b] - t[a]));
  }
  const [before, after] = [t[k] - t[k - 1], t[k + 1] - t[k]];
  return q[k].map((x, i) => {
    const [low, high] = [(x - q[k - 1][i]) / before, (q[k + 1][i] - x) / after];
    return (after * low + before * high) / (before + after);
  });
}
