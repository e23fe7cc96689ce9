import assert from "node:assert/strict";
import { test } from "node:test";
import { gzipSync } from "node:zlib";
import { readSweep, type Column, type Role, type Sweep } from "../src/sweep/data.ts";
import { axisOf, binned, nearestRow, roundBins, shown, shownValue } from "../src/sweep/numbers.ts";
import { State } from "../src/sweep/state.ts";

const HEAD = { title: "t", command: "", run_command: "", version: "1", seed: 0, runs: 6, failed: 2, interval: null, cycle_s: null, lines: [], rows: 6, kinds_left_out: 0 };
const ENTRY = { page: "", disturbances: [] };
const SMALLEST = { page: "", command: "" };

function column(name: string, role: Role, values: readonly number[], labels: readonly string[] | null = null): Column {
  return { name, role, labels, values: role === "run" ? Int32Array.from(values) : labels !== null || role === "kind" ? Int16Array.from(values) : Float32Array.from(values) };
}

function sweep(given: Partial<Sweep> = {}): Sweep {
  return {
    ...HEAD, format: 1, holding: [4, 1], failing: [2, 1], nearest: [{ ...ENTRY, run: 3, property: "p", margin: 0.1 }],
    kinds: [
      { number: 1, title: "second", text: "", story: [], smallest: SMALLEST, region: "", count: 1, runs: [{ ...ENTRY, run: 40 }] },
      { number: 0, title: "first", text: "", story: [], smallest: SMALLEST, region: "", count: 1, runs: [{ ...ENTRY, run: 20 }] },
    ],
    columns: [
      column("run", "run", [1, 3, 20, 30, 40, 50]), column("kind", "kind", [-1, -1, 0, -1, 1, -1]), column("x", "varied", [0, 1, 2, 3, 4, NaN]),
      column("how", "varied", [0, 1, 0, 1, 0, 1], ["slow", "fast"]), column("time_s", "time", [10, 10, 11, 12, 13, 14]),
    ],
    ...given,
  };
}

test("data is read back, and what is no data is refused", async () => {
  const columns = [{ name: "run", role: "run", type: "i32" }, { name: "x", role: "varied", type: "f32" }, { name: "how", role: "varied", type: "i16", labels: ["a", "b"] }];
  const pack = (head: object, body: Buffer) => {
    const text = Buffer.from(JSON.stringify(head));
    const size = Buffer.alloc(4);
    size.writeUInt32LE(text.length);
    return new Uint8Array(gzipSync(Buffer.concat([size, text, body])));
  };
  const body = Buffer.alloc(3 * 10);
  [7, 8, 9].forEach((run, row) => body.writeInt32LE(run, 4 * row));
  [0.5, NaN, -1].forEach((x, row) => body.writeFloatLE(x, 12 + 4 * row));
  [1, 0, 1].forEach((how, row) => body.writeInt16LE(how, 24 + 2 * row));
  const found = await readSweep(pack({ ...HEAD, format: 1, rows: 3, columns }, body));
  assert.deepEqual(found.columns.map(({ values }) => [...values]), [[7, 8, 9], [0.5, NaN, -1], [1, 0, 1]]);
  assert.equal(shownValue(found.columns[2]!, 0), "b");
  await assert.rejects(readSweep(pack({ ...HEAD, format: 1, rows: 4, columns }, body)), /ends in column x/);
  await assert.rejects(readSweep(pack({ ...HEAD, format: 2, rows: 3, columns }, body)), /format 2/);
  await assert.rejects(readSweep(new Uint8Array(gzipSync(Buffer.from("ab")))), /no sweep/);
  await assert.rejects(readSweep(new Uint8Array([1, 2, 3])), /damaged/);
});

test("bins have round edges and count every finite value once, by the share that is shown", () => {
  const found = binned(sweep({ holding: [4, 8] }), sweep().columns[4]!, 4);
  assert.deepEqual(found, { edges: [10, 11, 12, 13, 14, 15], holding: [16, 0, 8, 0, 8], failing: [0, 1, 0, 1, 0] });
  const labels = binned(sweep(), sweep().columns[3]!);
  assert.deepEqual(labels, { edges: [-0.5, 0.5, 1.5], holding: [1, 3], failing: [2, 0] });
  assert.equal(binned(sweep(), sweep().columns[2]!).holding.reduce((sum, count) => sum + count), 3);
});

test("bins hold the ends whatever the numbers are", () => {
  for (const [least, most] of [[0, 1], [-3.7, 12.2], [1e-9, 2e-9], [1e12, 1e12 + 1e7], [5, 5], [0, 0], [-1e-30, 1e30]] as const) {
    const { first, step, many } = roundBins([least, most], 40);
    assert.ok(first <= least && first + step * many > most - step * 1e-6 && many >= 1 && many <= 60, `${least} ${most}: ${first} ${step} ${many}`);
  }
});

test("an axis of numbers has room around them, one of labels a place for each", () => {
  const { least, most } = axisOf(column("x", "varied", [0, 10, NaN, Infinity]));
  assert.deepEqual([least, most], [-0.3, 10.3]);
  const same = axisOf(column("x", "varied", [5, 5]));
  assert.ok(same.least < 5 && same.most > 5);
  assert.deepEqual([axisOf(sweep().columns[3]!).least, axisOf(sweep().columns[3]!).most], [-0.5, 1.5]);
});

test("the nearest point is found within reach, a failing one first", () => {
  assert.equal(nearestRow([0, 3, 30], [0, 0, 0], [-1, 0, -1], [1, 0]), 1);
  assert.equal(nearestRow([0, 9, 30], [0, 0, 0], [-1, 0, -1], [1, 0]), 0);
  assert.equal(nearestRow([0, 9, 30], [0, 0, 0], [-1, 0, -1], [60, 0]), -1);
});

test("numbers are short", () => {
  assert.deepEqual([0.1 + 0.2, 12345.678, NaN, Infinity, 1e-7, -0.25].map(shown), ["0.3", "12345.7", "–", "∞", "1e-7", "-0.25"]);
});

test("failing runs are gone through in both directions, and a run is chosen by its number", () => {
  const state = new State(sweep());
  assert.deepEqual([state.chosen.value], [null]);
  state.step(1);
  assert.equal(state.chosen.value?.kind?.title, "first");
  state.step(1);
  assert.deepEqual([state.chosen.value?.run, state.colourOf(state.row.value)], [40, 0]);
  state.step(1);
  assert.equal(state.chosen.value?.run, 40);
  state.step(-1);
  assert.deepEqual([state.chosen.value?.run, state.colourOf(state.row.value)], [20, 1]);
  state.choose(3);
  assert.deepEqual([state.chosen.value?.kind, state.chosen.value?.shown?.run, state.colourOf(state.row.value)], [null, 3, -1]);
  state.choose(4);
  assert.deepEqual([state.chosen.value, state.missing.value], [null, 4]);
  state.step(-1);
  assert.equal(state.chosen.value?.run, 40);
});

test("what is varied and what it leads to is shown first", () => {
  const state = new State(sweep());
  assert.deepEqual([state.across.value.name, state.up.value.name, state.histogram.value.name, state.colouring.value], ["x", "time_s", "time_s", "kind"]);
});
