import assert from "node:assert/strict";
import { test } from "node:test";
import { addPart, boxEdges, noTriangles, type Triangles } from "../src/regions/robot/shapes.ts";
import type { Part, Six } from "../src/source/messages.ts";

function triangles(kind: Part["kind"], size: readonly number[], pose: Six = [0, 0, 0, 0, 0, 0]): Triangles {
  const made = noTriangles();
  addPart(made, { link: 0, kind, size, pose, role: "housing" });
  return made;
}

function extent({ positions }: Triangles): number[] {
  return [0, 1, 2].flatMap((axis) => {
    const values = positions.filter((_, index) => index % 3 === axis);
    return [Math.min(...values), Math.max(...values)].map((value) => Math.round(1e6 * value) / 1e6 + 0);
  });
}

/** Six times the volume that the triangles enclose is the sum of their triple products; positive if they face outwards. */
function volume({ positions, indices }: Triangles): number {
  let sum = 0;
  for (let i = 0; i < indices.length; i += 3) {
    const [a, b, c] = [0, 1, 2].map((corner) => positions.slice(3 * indices[i + corner]!, 3 * indices[i + corner]! + 3)) as [number[], number[], number[]];
    sum += a[0]! * (b[1]! * c[2]! - b[2]! * c[1]!) + a[1]! * (b[2]! * c[0]! - b[0]! * c[2]!) + a[2]! * (b[0]! * c[1]! - b[1]! * c[0]!);
  }
  return sum / 6;
}

const within = (found: number, wanted: number, share: number) => assert.ok(Math.abs(found - wanted) <= share * wanted, `${found} for ${wanted}`);

test("solids have their extents, and face outwards with about their volume", () => {
  const cylinder = triangles("cylinder", [0.1, 0.4]);
  assert.deepEqual(extent(cylinder), [-0.1, 0.1, -0.1, 0.1, -0.2, 0.2]);
  within(volume(cylinder), Math.PI * 0.1 ** 2 * 0.4, 0.01);
  const cone = triangles("cone", [0.1, 0.05, 0.3]);
  assert.deepEqual(extent(cone).slice(4), [-0.15, 0.15]);
  within(volume(cone), (Math.PI * 0.3 * (0.1 ** 2 + 0.1 * 0.05 + 0.05 ** 2)) / 3, 0.05);
  within(volume(triangles("sphere", [0.1])), (4 / 3) * Math.PI * 0.001, 0.02);
  const capsule = triangles("capsule", [0.1, 0.4]);
  assert.deepEqual(extent(capsule).slice(4), [-0.3, 0.3]);
  within(volume(capsule), Math.PI * 0.1 ** 2 * 0.4 + (4 / 3) * Math.PI * 0.001, 0.02);
  const box = triangles("box", [0.1, 0.2, 0.3]);
  assert.deepEqual(extent(box), [-0.05, 0.05, -0.1, 0.1, -0.15, 0.15]);
  within(volume(box), 0.006, 1e-9);
});

test("a flat disc and a pointed cone keep their form", () => {
  assert.deepEqual(extent(triangles("cylinder", [0.03, 0.001])).slice(4), [-0.0005, 0.0005]);
  assert.ok(triangles("cone", [0.1, 0, 0.2]).positions.every(Number.isFinite));
});

test("normals are of length 1 and turn with the pose", () => {
  const { normals } = triangles("box", [0.1, 0.2, 0.3], [1, 2, 3, 0, 0, Math.PI / 4]);
  for (let i = 0; i < normals.length; i += 3) within(Math.hypot(...normals.slice(i, i + 3)), 1, 1e-9);
  within(Math.abs(normals[0]!), Math.SQRT1_2, 1e-9);
});

test("a pose moves a solid in the frame of its link", () => {
  // A quarter turn about x lays the cylinder along -y.
  assert.deepEqual(extent(triangles("cylinder", [0.1, 0.4], [1, 0, 0, Math.PI / 2, 0, 0])), [0.9, 1.1, -0.2, 0.2, -0.1, 0.1]);
});

test("a box has twelve edges", () => {
  const edges = boxEdges({ link: 0, kind: "box", size: [2, 2, 2], pose: [0, 0, 0, 0, 0, 0], role: "thing" });
  assert.equal(edges.length, 24);
  for (let i = 0; i < 24; i += 2) assert.equal(edges[i]!.filter((value, axis) => value !== edges[i + 1]![axis]).length, 1);
});
