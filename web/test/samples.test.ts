import assert from "node:assert/strict";
import { test } from "node:test";
import { SampleTable } from "../src/model/samples.ts";
import type { Column, Rows } from "../src/source/rows.ts";
import { random } from "./random.ts";

function rows(ticks: readonly number[], columns: { readonly [name in Column]?: readonly number[] }): Rows {
  const made = Object.entries(columns).map(([name, values]) => [name as Column, Float64Array.from(values)] as const);
  return { run: 1, ticks: Int32Array.from(ticks), columns: new Map(made) };
}

test("rows at the end, before and between", () => {
  const table = new SampleTable();
  table.add(rows([10, 20], { q1: [1, 2] }));
  table.add(rows([30], { q1: [3] }));
  table.add(rows([0], { q1: [0] }));
  table.add(rows([15, 20, 25], { q1: [1.5, 2.25, 2.5] }));
  assert.deepEqual([...table.t], [0, 0.04, 0.06, 0.08, 0.1, 0.12]);
  assert.deepEqual([...table.column("q1")], [0, 1, 1.5, 2.25, 2.5, 3]);
  assert.equal(table.length, 6);
  assert.equal(table.end_s, 0.12);
});

test("of one time the newer row counts, as far as it has columns", () => {
  const table = new SampleTable();
  table.add(rows([0, 1], { q1: [1, 2], speed: [5, 6] }));
  table.add(rows([1, 1, 2], { q1: [3, 4, 7] }));
  assert.deepEqual([...table.column("q1")], [1, 4, 7]);
  assert.deepEqual([...table.column("speed")], [5, 6, NaN]);
  assert.deepEqual([...table.column("fx")], [NaN, NaN, NaN]);
});

test("a value between rows: cubic with speeds, linear without, NaN left out", () => {
  const table = new SampleTable();
  // q = t^3 - t: 0 at 0 s and -0.375 at 0.5 s, speeds 3 t^2 - 1.
  table.add(rows([0, 125], { q1: [0, -0.375], qd1: [-1, -0.25], x: [1, 3], y: [NaN, 2] }));
  table.add(rows([50], { x: [2] }));
  assert.ok(Math.abs(table.value("q1", 0.3) - (0.027 - 0.3)) < 1e-15);
  assert.equal(table.value("q1", 0), 0);
  assert.equal(table.value("q1", 0.5), -0.375);
  assert.equal(table.value("q1", 9), -0.375);
  assert.equal(table.value("q1", -1), 0);
  assert.equal(table.value("x", 0.1), 1.5);
  assert.equal(table.value("y", 0.1), 2);
  assert.ok(Number.isNaN(table.value("z", 0.1)));
  assert.equal(table.joints(0.5)?.[0], -0.375);
  assert.equal(new SampleTable().joints(0), null);
});

test("accelerations and tracking errors follow what is added", () => {
  const table = new SampleTable();
  table.add(rows([0, 10], { qd1: [0, 0.4], q1: [1, 2], qa1: [0.5, 2.5] }));
  assert.deepEqual([...table.column("qdd1")], [0, 10]);
  assert.deepEqual([...table.column("error1")], [0.5, -0.5]);
  table.add(rows([5, 15], { qd1: [0, 0.4], q1: [0, 0], qa1: [1, 2] }));
  assert.deepEqual([...table.column("qdd1")], [0, 0, 20, 0]);
  assert.deepEqual([...table.column("error1")], [0.5, -1, -0.5, -2]);
});

test("nearest row, fine stretches", () => {
  const table = new SampleTable();
  assert.equal(table.nearest(1), -1);
  table.add(rows([0, 10, 11, 12], { q1: [0, 0, 0, 0] }));
  assert.deepEqual([-1, 0.019, 0.021, 0.043, 9].map((t) => table.nearest(t)), [0, 0, 1, 2, 3]);
  assert.equal(table.isFine(0.04, 0.048, 0.004), true);
  assert.equal(table.isFine(0.02, 0.048, 0.004), false);
  assert.equal(table.isFine(0.04, 0.06, 0.004), false);
});

test("a table that begins as another one", () => {
  const old = new SampleTable();
  old.add(rows([0, 10, 20], { q1: [1, 2, 3] }));
  const table = new SampleTable();
  table.begin(old, 0.05);
  table.add(rows([12], { q1: [9] }));
  assert.deepEqual([...table.column("q1")], [1, 2, 9]);
  assert.deepEqual([...old.column("q1")], [1, 2, 3]);
});

test("rows of a source that goes on for hours are forgotten", () => {
  const table = new SampleTable();
  for (let tick = 0; tick < 100_000; tick += 5) {
    table.add(rows([tick, tick + 1, tick + 2, tick + 3, tick + 4], { q1: [tick, tick + 1, tick + 2, tick + 3, tick + 4], qd1: [0, 0, 0, 0, 0] }));
    table.forget(table.end_s - 4);
    assert.ok(table.length <= 2010, String(table.length));
  }
  assert.ok(table.t[0]! <= table.end_s - 4);
  assert.equal(table.value("q1", table.end_s - 4), 98_999);
  assert.equal(table.value("q1", 1), table.column("q1")[0]);
  assert.equal(table.column("qdd1").length, table.length);
});

test("random rows in random order equal a slow table", () => {
  const draw = random(7);
  for (let round = 0; round < 30; round++) {
    const table = new SampleTable();
    const slow = new Map<number, Map<Column, number>>();
    for (let batch = 0; batch < 12; batch++) {
      const first = Math.floor(draw() * 400);
      const step = 1 + Math.floor(draw() * 9);
      const ticks = Array.from({ length: Math.floor(draw() * 50) }, (_, row) => first + row * step);
      const names: Column[] = draw() < 0.3 ? ["q1"] : draw() < 0.5 ? ["q1", "qd1"] : ["q1", "x"];
      const columns = Object.fromEntries(names.map((name) => [name, ticks.map(() => Math.fround(draw()))]));
      table.add(rows(ticks, columns));
      ticks.forEach((tick, row) => {
        const known = slow.get(tick) ?? new Map<Column, number>();
        names.forEach((name) => known.set(name, columns[name]![row]!));
        slow.set(tick, known);
      });
      if (draw() < 0.3) table.column("qdd1");
    }
    const ticks = [...slow.keys()].sort((a, b) => a - b);
    assert.deepEqual([...table.t], ticks.map((tick) => tick / 250));
    for (const name of ["q1", "qd1", "x"] as const) {
      assert.deepEqual([...table.column(name)], ticks.map((tick) => slow.get(tick)!.get(name) ?? NaN));
    }
    const qd = [...table.column("qd1")];
    assert.deepEqual([...table.column("qdd1")], qd.map((v, row) => (row === 0 ? 0 : (v - qd[row - 1]!) / (table.t[row]! - table.t[row - 1]!))));
  }
});

test("thinned curves keep the lowest and highest value of each part", () => {
  const draw = random(3);
  for (let round = 0; round < 8; round++) {
    const table = new SampleTable();
    const ticks = [...new Set(Array.from({ length: 3000 }, () => Math.floor(draw() * 9000)))].sort((a, b) => a - b);
    table.add(rows(ticks, { q1: ticks.map(() => draw() - 0.5), x: ticks.map(() => (draw() < 0.2 ? NaN : draw())) }));
    const from = draw() * 10;
    const to = from + 5 + draw() * 20;
    const columns = 40;
    const curves = table.curves(["q1", "x"], from, to, columns);
    assert.ok(curves.t.length <= 2 * columns + 2);
    for (let i = 1; i < curves.t.length; i++) assert.ok(curves.t[i]! > curves.t[i - 1]!);
    ["q1" as const, "x" as const].forEach((name, series) => {
      const source = [...table.column(name)];
      const width = (to - from) / columns;
      for (let part = 0; part < columns; part++) {
        const isIn = (t: number) => t >= from && t <= to && Math.min(Math.floor((t - from) / width), columns - 1) === part;
        const all = source.filter((value, row) => isIn(table.t[row]!) && !Number.isNaN(value));
        const kept = [...curves.values[series]!].filter((value, point) => isIn(curves.t[point]!) && !Number.isNaN(value));
        if (all.length === 0) continue;
        assert.equal(Math.max(...kept), Math.max(...all));
        assert.equal(Math.min(...kept), Math.min(...all));
      }
    });
  }
});

test("few rows are drawn as they are, with one on either side", () => {
  const table = new SampleTable();
  table.add(rows([0, 25, 50, 75, 100], { q1: [0, 1, 2, 3, 4] }));
  const curves = table.curves(["q1"], 0.15, 0.25, 100);
  assert.deepEqual([...curves.t], [0.1, 0.2, 0.3]);
  assert.deepEqual([...curves.values[0]!], [1, 2, 3]);
  assert.deepEqual(table.range(["q1"], 0.15, 0.25), [1, 3]);
  assert.equal(table.range(["x"], 0, 1), null);
});

test("100,000 rows in small parts take less than quadratic time", () => {
  const table = new SampleTable();
  const names: Column[] = ["q1", "q2", "q3", "q4", "q5", "q6", "qd1", "qd2", "qd3", "qd4", "qd5", "qd6", "x", "y", "z"];
  const columns = Object.fromEntries(names.map((name) => [name, Array.from({ length: 100 }, (_, row) => row)]));
  const before = process.cpuUsage().user;
  for (let part = 0; part < 1000; part++) table.add(rows(Array.from({ length: 100 }, (_, row) => part * 100 + row), columns));
  const spent_s = (process.cpuUsage().user - before) / 1e6;
  assert.equal(table.length, 100_000);
  assert.equal(table.value("q1", 123.004), (123.004 * 250) % 100);
  // Copying everything with each part would move 12 GB.
  assert.ok(spent_s < 2, `${spent_s} s`);
});
