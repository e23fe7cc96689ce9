import assert from "node:assert/strict";
import { test } from "node:test";
import { readRows } from "../src/source/rows.ts";

test("a frame with a column of floats and one of lines", () => {
  const bytes = new Uint8Array(64);
  const view = new DataView(bytes.buffer);
  bytes.set([0x45, 0x53, 0x43, 0x31]);
  [7, 100, 10, 3].forEach((value, index) => view.setUint32(4 + 4 * index, value, true));
  view.setUint16(20, 2, true);
  bytes.set([0, 1, 2, 19], 24); // f32 q1; u16 speed
  [0.5, -1, 2].forEach((value, index) => view.setFloat32(32 + 4 * index, value, true));
  [1, 2, 3].forEach((value, index) => view.setUint16(48 + 2 * index, value, true));
  const rows = readRows(bytes.buffer);
  assert.equal(rows.run, 7);
  assert.deepEqual([...rows.ticks], [100, 110, 120]);
  assert.deepEqual([...(rows.columns.get("q1") ?? [])], [0.5, -1, 2]);
  assert.deepEqual([...(rows.columns.get("speed") ?? [])], [1, 2, 3]);
});

test("other bytes are refused", () => {
  assert.throws(() => readRows(new ArrayBuffer(10)), /no frame of rows/);
  assert.throws(() => readRows(new ArrayBuffer(100)), /no frame of rows/);
});
