/** Reads the triangles of an STL file, binary or text. Everything that it says of itself is compared with its size. */

import type { MeshBudget } from "./mesh_limits.ts";

const HEAD = 84;
const FACET = 50;

/** Corners of triangles, x, y and z of each; every nine numbers are a triangle, and normals follow from them. Throws an Error. */
export function readStl(bytes: ArrayBuffer, budget: MeshBudget): Float32Array {
  const view = new DataView(bytes);
  const count = bytes.byteLength >= HEAD ? view.getUint32(80, true) : -1;
  // Binary files may begin with `solid` as well: their size tells them.
  if (count >= 0 && HEAD + FACET * count === bytes.byteLength) return binary(view, count, budget);
  const head = new TextDecoder().decode(bytes.slice(0, 5));
  if (head === "solid") return text(new TextDecoder().decode(bytes), budget);
  throw new Error(count < 0 ? `it has ${bytes.byteLength} bytes` : `it says that it has ${count} triangles, which are ${HEAD + FACET * count} bytes; it has ${bytes.byteLength}`);
}

function binary(view: DataView, count: number, budget: MeshBudget): Float32Array {
  budget.takeTriangles(count);
  const found = new Float32Array(9 * count);
  for (let facet = 0; facet < count; facet++) {
    // The normal comes first: 12 bytes.
    for (let number = 0; number < 9; number++) found[9 * facet + number] = view.getFloat32(HEAD + FACET * facet + 12 + 4 * number, true);
  }
  return checked(found);
}

const VERTEX = /\bvertex[ \t\r\n]{1,64}([-+.\deE]{1,40})[ \t]{1,64}([-+.\deE]{1,40})[ \t]{1,64}([-+.\deE]{1,40})(?![-+.\deE])/g;

function text(words: string, budget: MeshBudget): Float32Array {
  const found: number[] = [];
  for (const [, x, y, z] of words.matchAll(VERTEX)) {
    if (found.length % 9 === 0) budget.takeTriangles(1);
    found.push(Number(x), Number(y), Number(z));
  }
  if (found.length % 9 !== 0) throw new Error("it ends within a triangle");
  return checked(Float32Array.from(found));
}

function checked(found: Float32Array): Float32Array {
  const wrong = found.findIndex((value) => !Number.isFinite(value));
  if (wrong >= 0) throw new Error(`triangle ${1 + Math.floor(wrong / 9)} has a corner that is no place`);
  return found;
}
