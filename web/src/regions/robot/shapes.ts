/** Triangles of the solids of a scene. Edges are rounded a little inwards, so that light draws them. */

import { apply, fromRotationVector, type Point, type Transform } from "../../model/kinematics.ts";
import type { Part } from "../../source/messages.ts";

export interface Triangles {
  readonly positions: number[];
  readonly normals: number[];
  readonly indices: number[];
}

/** A point of the outline of a solid of revolution: radius and height, m, and its normal. */
type Outline = readonly (readonly [radius: number, z: number, normal_r: number, normal_z: number])[];

const SEGMENTS = 40;
const ARC_STEPS = 3;
const EDGE_M = 0.004;

/** Returns no triangles, to which parts are added. */
export function noTriangles(): Triangles {
  return { positions: [], normals: [], indices: [] };
}

/** Adds a part, in the frame of its link. */
export function addPart(to: Triangles, part: Part): void {
  const pose = fromRotationVector(part.pose);
  const [first = 0, second = 0, third = 0] = part.size;
  switch (part.kind) {
    case "cylinder":
      return addTurned(to, pose, tapered(first, first, second));
    case "cone":
      return addTurned(to, pose, tapered(first, second, third));
    case "sphere":
      return addTurned(to, pose, [...arc(0, 0, first, -90, 90, 6 * ARC_STEPS)]);
    case "capsule":
      return addTurned(to, pose, [...arc(0, -second / 2, first, -90, 0, 3 * ARC_STEPS), ...arc(0, second / 2, first, 0, 90, 3 * ARC_STEPS)]);
    case "box":
      return addBox(to, pose, [first, second, third]);
  }
}

/** Points of a part of a circle around (r, z), from one angle to another, degrees from the plane of x and y. */
function* arc(r: number, z: number, radius: number, from: number, to: number, steps: number) {
  for (let step = 0; step <= steps; step++) {
    const angle = ((from + ((to - from) * step) / steps) * Math.PI) / 180;
    yield [r + radius * Math.cos(angle), z + radius * Math.sin(angle), Math.cos(angle), Math.sin(angle)] as const;
  }
}

/** Outline of a cylinder or a cone that stands on z, centred, with rounded edges. */
function tapered(bottom: number, top: number, length: number): Outline {
  const half = length / 2;
  const lean = (Math.atan2(bottom - top, length) * 180) / Math.PI;
  const edge = Math.min(EDGE_M, half / 2, Math.max(Math.min(bottom, top) / 2, 0));
  return [
    [0, -half, 0, -1], [bottom - edge, -half, 0, -1],
    ...arc(bottom - edge, -half + edge, edge, -90, lean, ARC_STEPS),
    ...arc(top - edge, half - edge, edge, lean, 90, ARC_STEPS),
    [top - edge, half, 0, 1], [0, half, 0, 1],
  ];
}

function addTurned(to: Triangles, pose: Transform, outline: Outline): void {
  const start = to.positions.length / 3;
  for (let k = 0; k <= SEGMENTS; k++) {
    const [c, s] = [Math.cos((2 * Math.PI * k) / SEGMENTS), Math.sin((2 * Math.PI * k) / SEGMENTS)];
    for (const [r, z, nr, nz] of outline) addPoint(to, pose, [r * c, r * s, z], [nr * c, nr * s, nz]);
  }
  const n = outline.length;
  for (let k = 0; k < SEGMENTS; k++) {
    for (let i = 0; i + 1 < n; i++) {
      const [low, high] = [outline[i]!, outline[i + 1]!];
      if (low[0] === high[0] && low[1] === high[1]) continue;
      const a = start + k * n + i;
      if (low[0] > 0) to.indices.push(a, a + n, a + 1);
      if (high[0] > 0) to.indices.push(a + 1, a + n, a + n + 1);
    }
  }
}

function addBox(to: Triangles, pose: Transform, size: Point): void {
  for (const axis of [0, 1, 2] as const) {
    for (const side of [-1, 1]) {
      const start = to.positions.length / 3;
      const [u, v] = [(axis + 1) % 3, (axis + 2) % 3] as [0 | 1 | 2, 0 | 1 | 2];
      for (const [a, b] of [[-1, -1], [1, -1], [1, 1], [-1, 1]] as const) {
        const point = [0, 0, 0];
        point[axis] = (side * size[axis]) / 2;
        point[u] = (a * size[u]) / 2;
        point[v] = (b * size[v]) / 2;
        const normal = [0, 0, 0];
        normal[axis] = side;
        addPoint(to, pose, point as unknown as Point, normal as unknown as Point);
      }
      const corners = side > 0 ? [0, 1, 2, 0, 2, 3] : [0, 2, 1, 0, 3, 2];
      to.indices.push(...corners.map((corner) => start + corner));
    }
  }
}

function addPoint(to: Triangles, pose: Transform, point: Point, [x, y, z]: Point): void {
  to.positions.push(...apply(pose, point));
  to.normals.push(
    pose[0] * x + pose[1] * y + pose[2] * z,
    pose[3] * x + pose[4] * y + pose[5] * z,
    pose[6] * x + pose[7] * y + pose[8] * z,
  );
}

/** Returns the edges of a box in the frame of its link: pairs of points. */
export function boxEdges(part: Part): Point[] {
  const pose = fromRotationVector(part.pose);
  const corner = (bits: number): Point =>
    apply(pose, [0, 1, 2].map((axis) => ((bits >> axis) & 1 ? 0.5 : -0.5) * (part.size[axis] ?? 0)) as unknown as Point);
  const edges: Point[] = [];
  for (let bits = 0; bits < 8; bits++) {
    for (const axis of [0, 1, 2]) if (((bits >> axis) & 1) === 0) edges.push(corner(bits), corner(bits | (1 << axis)));
  }
  return edges;
}
