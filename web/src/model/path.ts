/** The path of the TCP: its points, speeds and lines, which part belongs to a line, and what of it is at a pixel. */

import type { Scene, Six } from "../source/messages.ts";
import type { Column } from "../source/rows.ts";
import { tcpFrame } from "./kinematics.ts";
import type { Run } from "./run.ts";

const JOINTS = ["q1", "q2", "q3", "q4", "q5", "q6"] as const satisfies readonly Column[];

/** Points in the order of time. Stretch i goes from point i to point i + 1. */
export interface Path {
  readonly t: Float64Array;
  /** x, y, z of each point in the base frame, m. */
  readonly xyz: Float32Array;
  /** Speed of the TCP at each point, m/s. */
  readonly speed: Float32Array;
  /** Line of the main thread in each stretch. */
  readonly line: Uint32Array;
  /** Stretches that are none: the TCP was set anew there, or rows are missing. */
  readonly jumps: Uint8Array;
  readonly speed_max: number;
}

/** A path that a robot cannot have moved in the time between two rows, m beyond its speed. */
const JUMP_M = 0.002;

/** Returns the path of a run from `from_s` on; from the joints where a source has no poses. */
export function pathOf(run: Run, scene: Pick<Scene, "dh" | "tcp">, from_s = 0): Path {
  const { samples } = run;
  const first = from_s > 0 ? firstAtOrAfter(samples.t, from_s) : 0;
  const t = samples.t.slice(first);
  const n = t.length;
  const xyz = new Float32Array(3 * n);
  const [x, y, z, ...q] = (["x", "y", "z", ...JOINTS] as const).map((name) => samples.column(name));
  for (let i = 0; i < n; i++) {
    const row = first + i;
    if (Number.isNaN(x![row]!)) {
      const tcp = tcpFrame(scene, q.map((joint) => joint[row]!) as unknown as Six);
      xyz.set([tcp[9], tcp[10], tcp[11]], 3 * i);
    } else {
      xyz[3 * i] = x![row]!;
      xyz[3 * i + 1] = y![row]!;
      xyz[3 * i + 2] = z![row]!;
    }
  }
  const speed = speeds(t, xyz, samples.column("speed").subarray(first));
  let speed_max = 0;
  for (const value of speed) if (value > speed_max) speed_max = value;
  return { t, xyz, speed, line: linesOf(run, t), jumps: jumpsOf(t, xyz, speed), speed_max };
}

/** Returns the part of a path after a time. */
export function after(path: Path, t: number): Path {
  const first = Math.max(0, firstAtOrAfter(path.t, t) - 1);
  return {
    t: path.t.subarray(first), xyz: path.xyz.subarray(3 * first), speed: path.speed.subarray(first),
    line: path.line.subarray(first), jumps: path.jumps.subarray(first), speed_max: path.speed_max,
  };
}

/** Returns the number of the first time that is not before `t`. */
function firstAtOrAfter(times: Float64Array, t: number): number {
  let low = 0;
  let high = times.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle]! < t) low = middle + 1;
    else high = middle;
  }
  return low;
}

/** Distance of two points, m. */
function gap(xyz: Float32Array, i: number, k: number): number {
  const [x, y, z] = [xyz[3 * k]! - xyz[3 * i]!, xyz[3 * k + 1]! - xyz[3 * i + 1]!, xyz[3 * k + 2]! - xyz[3 * i + 2]!];
  return Math.sqrt(x * x + y * y + z * z);
}

/** Speeds as the source gives them; where it gives none, from the points. */
function speeds(t: Float64Array, xyz: Float32Array, given: Float64Array): Float32Array {
  const speed = new Float32Array(t.length);
  for (let i = 0; i < t.length; i++) {
    if (!Number.isNaN(given[i]!)) speed[i] = given[i]!;
    else if (i + 1 < t.length) speed[i] = gap(xyz, i, i + 1) / (t[i + 1]! - t[i]!);
    else speed[i] = speed[i - 1] ?? 0;
  }
  return speed;
}

function jumpsOf(t: Float64Array, xyz: Float32Array, speed: Float32Array): Uint8Array {
  const jumps = new Uint8Array(Math.max(0, t.length - 1));
  for (let i = 0; i < jumps.length; i++) {
    const longest = JUMP_M + 2 * Math.max(speed[i]!, speed[i + 1]!) * (t[i + 1]! - t[i]!);
    if (!(gap(xyz, i, i + 1) <= longest)) jumps[i] = 1;
  }
  return jumps;
}

function linesOf(run: Run, t: Float64Array): Uint32Array {
  const line = new Uint32Array(Math.max(0, t.length - 1));
  const main = run.lines.get("main") ?? run.lines.values().next().value;
  if (main === undefined) return line;
  let span = -1;
  for (let i = 0; i < line.length; i++) {
    // A stretch belongs to the line in its middle: rows lie on the changes of the line.
    const middle = (t[i]! + t[i + 1]!) / 2;
    while (span + 1 < main.t.length && main.t[span + 1]! <= middle) span++;
    line[i] = main.line[span] ?? 0;
  }
  return line;
}

/** A run of stretches: from point `from` to point `to`. */
export interface PathPart { readonly from: number; readonly to: number }

/** Returns the parts of a path in a line, each as long as possible, without jumps. */
export function partsOf(path: Path, line: number): PathPart[] {
  const parts: PathPart[] = [];
  let from = -1;
  for (let i = 0; i <= path.line.length; i++) {
    const isIn = i < path.line.length && path.line[i] === line && path.jumps[i] === 0;
    if (isIn && from < 0) from = i;
    if (!isIn && from >= 0) {
      parts.push({ from, to: i });
      from = -1;
    }
  }
  return parts;
}

/** Returns the line at a time, and 0 outside of the path. */
export function lineAt(path: Path, t: number): number {
  const next = firstAtOrAfter(path.t, t + 1e-9);
  return path.line[Math.min(next - 1, path.line.length - 1)] ?? 0;
}

/** Returns the time at which a line first ran, if it did. */
export function firstVisit(run: Run, line: number): number | null {
  let first: number | null = null;
  for (const thread of run.lines.values()) {
    const index = thread.line.indexOf(line);
    if (index >= 0 && (first === null || thread.t[index]! < first)) first = thread.t[index]!;
  }
  return first;
}

// ---------------------------------------------------------------- drawing

/** How far a drawn path may be from the points, m and as a share of the scale of speeds: less than a pixel and a shade. */
const OFF_M = 0.0001;
const OFF_SHARE = 0.02;
/** Stretches that become one at most. */
const MERGED_MAX = 128;

/**
 * Returns pairs of points between which a path, or parts of it, is a straight line of evenly changing speed: far fewer
 * than it has stretches, as robots move straight or wait most of the time.
 */
export function straights(path: Path, speed_end: number, parts: readonly PathPart[] = [{ from: 0, to: path.jumps.length }]): number[] {
  const pairs: number[] = [];
  for (const { from, to } of parts) {
    let first = from;
    while (first < to) {
      if (path.jumps[first] === 1) {
        first++;
        continue;
      }
      const last = lastStraight(path, first, to, speed_end);
      if (gap(path.xyz, first, last) > 0) pairs.push(first, last);
      first = last;
    }
  }
  return pairs;
}

/** Returns the last point up to which a path is straight from one on: looked for in steps that double, then between. */
function lastStraight(path: Path, first: number, to: number, speed_end: number): number {
  let end = first + 1;
  while (end < to && end - first < MERGED_MAX && path.jumps[end] === 0) end++;
  let length = 1;
  while (first + 2 * length <= end && isStraight(path, first, first + 2 * length, speed_end)) length *= 2;
  let good = first + length;
  let bad = Math.min(first + 2 * length, end + 1);
  while (bad - good > 1) {
    const middle = (good + bad) >> 1;
    if (isStraight(path, first, middle, speed_end)) good = middle;
    else bad = middle;
  }
  return good;
}

/** Whether all points from one to another lie on the line between them, in space and speed. */
function isStraight({ xyz, speed }: Path, first: number, last: number, speed_end: number): boolean {
  const [x, y, z] = [xyz[3 * first]!, xyz[3 * first + 1]!, xyz[3 * first + 2]!];
  const [dx, dy, dz] = [xyz[3 * last]! - x, xyz[3 * last + 1]! - y, xyz[3 * last + 2]! - z];
  const square = dx * dx + dy * dy + dz * dz;
  for (let i = first + 1; i < last; i++) {
    const [px, py, pz] = [xyz[3 * i]! - x, xyz[3 * i + 1]! - y, xyz[3 * i + 2]! - z];
    const share = square > 0 ? Math.min(1, Math.max(0, (px * dx + py * dy + pz * dz) / square)) : 0;
    const [ox, oy, oz] = [px - share * dx, py - share * dy, pz - share * dz];
    if (ox * ox + oy * oy + oz * oz > OFF_M * OFF_M) return false;
    const even = speed[first]! + share * (speed[last]! - speed[first]!);
    if (square > 0 && Math.abs(speed[i]! - even) > OFF_SHARE * speed_end) return false;
  }
  return true;
}

// ---------------------------------------------------------------- colours

/** Viridis at equal distances: lightness grows from one end to the other, for readers of any colour vision. */
const VIRIDIS: readonly Rgb[] = [
  [68, 1, 84], [72, 36, 117], [65, 68, 135], [53, 95, 141], [42, 120, 142], [33, 145, 140], [34, 168, 132], [68, 191, 112],
  [122, 209, 81], [189, 223, 38], [253, 231, 37],
];
/** The part of it that stands out 3:1 from the background; the fastest is the farthest from it. */
const USED = { light: [0.52, 0], dark: [0.46, 1] } as const;

export type Rgb = readonly [number, number, number];

/** Returns the colour of a share of the largest speed, 0 to 255 each. */
export function speedColour(share: number, isDark: boolean): Rgb {
  const [slow, fast] = isDark ? USED.dark : USED.light;
  const at = (slow + (fast - slow) * Math.min(1, Math.max(0, share))) * (VIRIDIS.length - 1);
  const low = Math.min(Math.floor(at), VIRIDIS.length - 2);
  const [a, b] = [VIRIDIS[low]!, VIRIDIS[low + 1]!];
  const mix = (k: 0 | 1 | 2) => Math.round(a[k] + (b[k] - a[k]) * (at - low));
  return [mix(0), mix(1), mix(2)];
}

/** Returns the end of the scale of speeds: the next 1, 2, 2.5 or 5 times a power of ten, m/s. */
export function scaleEnd(speed_max: number): number {
  if (!(speed_max > 1e-6)) return 0.1;
  const power = 10 ** Math.floor(Math.log10(speed_max));
  return power * [1, 2, 2.5, 5, 10].find((step) => step * power >= speed_max * (1 - 1e-6))!;
}

// ---------------------------------------------------------------- picking

/** Returns x and y of each point on the screen, pixels; NaN behind the camera. `matrix`: column by column, as of WebGL. */
export function project(xyz: Float32Array, matrix: ArrayLike<number>, width: number, height: number): Float32Array {
  const screen = new Float32Array((xyz.length / 3) * 2);
  const [m0, m1, , m3, m4, m5, , m7, m8, m9, , m11, m12, m13, , m15] = Array.from(matrix) as unknown as readonly number[];
  for (let i = 0, k = 0; i < xyz.length; i += 3, k += 2) {
    const [x, y, z] = [xyz[i]!, xyz[i + 1]!, xyz[i + 2]!];
    const w = m3! * x + m7! * y + m11! * z + m15!;
    screen[k] = w > 0 ? (0.5 + (0.5 * (m0! * x + m4! * y + m8! * z + m12!)) / w) * width : NaN;
    screen[k + 1] = w > 0 ? (0.5 - (0.5 * (m1! * x + m5! * y + m9! * z + m13!)) / w) * height : NaN;
  }
  return screen;
}

export interface Picked {
  readonly t: number;
  /** Number of the stretch. */
  readonly stretch: number;
  readonly distance_px: number;
}

/** Returns the moment of the path nearest to a pixel, if one is near; of passes as near as each other that of the time nearest to `near_s`. */
export function pick(path: Path, screen: Float32Array, x: number, y: number, tolerance_px: number, near_s: number): Picked | null {
  let best: Picked | null = null;
  let least = tolerance_px;
  for (let i = 0; i < path.jumps.length; i++) {
    if (path.jumps[i] === 1) continue;
    const [ax, ay] = [screen[2 * i]! - x, screen[2 * i + 1]! - y];
    const [bx, by] = [screen[2 * i + 2]! - screen[2 * i]!, screen[2 * i + 3]! - screen[2 * i + 1]!];
    const square = bx * bx + by * by;
    const along = square > 0 ? Math.min(1, Math.max(0, -(ax * bx + ay * by) / square)) : 0;
    const off = Math.hypot(ax + along * bx, ay + along * by);
    if (!(off <= least + SAME_PX)) continue;
    const t = path.t[i]! + along * (path.t[i + 1]! - path.t[i]!);
    if (best === null || off < least - SAME_PX || Math.abs(t - near_s) < Math.abs(best.t - near_s)) {
      best = { t, stretch: i, distance_px: off };
      least = Math.min(least, off);
    }
  }
  return best !== null && best.distance_px <= tolerance_px ? best : null;
}

/** Passes over one place differ by this at most on the screen, pixels. */
const SAME_PX = 1.5;
