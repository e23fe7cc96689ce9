import assert from "node:assert/strict";
import { test } from "node:test";
import { Details } from "../src/model/detail.ts";
import { Run } from "../src/model/run.ts";
import { axisTicks, TimeView } from "../src/model/view.ts";

test("a view shows the whole run while it grows, or the last minute of what goes on by itself", () => {
  const view = new TimeView();
  view.extend(4, false);
  assert.deepEqual(view.range.value, [0, 4]);
  view.extend(100, false);
  assert.deepEqual(view.range.value, [0, 100]);
  view.extend(100, true);
  assert.deepEqual(view.range.value, [40, 100]);
  view.extend(0, false);
  assert.deepEqual(view.range.value, [0, 0.02]);
});

test("zooming keeps the time under the pointer, within the run", () => {
  const view = new TimeView();
  view.extend(100, false);
  view.zoom(20, 0.5);
  assert.deepEqual(view.range.value, [10, 60]);
  view.zoom(10, 0.5);
  assert.deepEqual(view.range.value, [10, 35]);
  view.pan(-1);
  assert.deepEqual(view.range.value, [0, 25]);
  view.pan(9);
  assert.deepEqual(view.range.value, [75, 100]);
  view.zoom(80, 100);
  assert.deepEqual([view.range.value, view.isWhole.value], [[0, 100], true]);
  view.zoom(50, 1e-9);
  const [from, to] = view.range.value;
  assert.ok(Math.abs(to - from - 0.02) < 1e-9 && from < 50 && to > 50);
});

test("revealing moves only where it must", () => {
  const view = new TimeView();
  view.extend(100, false);
  view.show(20, 30);
  view.reveal(25);
  assert.deepEqual(view.range.value, [20, 30]);
  view.reveal(31);
  assert.deepEqual(view.range.value, [30, 40]);
  view.reveal(5);
  assert.deepEqual(view.range.value, [4, 14]);
});

test("a zoomed view of a shorter run stays within it", () => {
  const view = new TimeView();
  view.extend(100, false);
  view.show(80, 90);
  view.extend(50, false);
  assert.deepEqual(view.range.value, [40, 50]);
});

test("selecting", () => {
  const view = new TimeView();
  view.extend(10, false);
  view.select(7, 3);
  assert.deepEqual(view.selected.value, [3, 7]);
  view.select(9, 20);
  assert.deepEqual(view.selected.value, [9, 10]);
  view.select(4, 4.001);
  assert.equal(view.selected.value, null);
});

test("ticks of an axis", () => {
  assert.deepEqual(axisTicks(0, 10, 5), { at: [0, 2, 4, 6, 8, 10], decimals: 0 });
  assert.deepEqual(axisTicks(1.03, 1.09, 3), { at: [1.04, 1.06, 1.08], decimals: 2 });
  assert.deepEqual(axisTicks(3, 3, 3), { at: [], decimals: 0 });
});

function coarse(end_s: number): Run {
  const run = new Run(1, 1, {});
  const ticks = Int32Array.from({ length: end_s * 25 + 1 }, (_, row) => 10 * row);
  run.takeRows({ run: 1, ticks, columns: new Map([["q1", new Float64Array(ticks.length)]]) });
  return run;
}

function fine(run: Run, from_s: number, to_s: number): void {
  const ticks = Int32Array.from({ length: Math.round((to_s - from_s) * 250) + 1 }, (_, row) => Math.round(from_s * 250) + row);
  run.takeRows({ run: 1, ticks, columns: new Map([["q1", new Float64Array(ticks.length)]]) });
}

test("detail is asked for once, of what is looked at closely", async () => {
  const run = coarse(60);
  const asked: (readonly number[])[] = [];
  const details = new Details(async (from, to, step) => {
    asked.push([from, to, step]);
    fine(run, from, to);
  });
  await details.want(run, [0, 60], 1000, null);
  assert.deepEqual(asked, []);
  await details.want(run, [9, 15], 1000, null);
  assert.deepEqual(asked, [[8, 16, 0.004]]);
  await details.want(run, [9, 15], 1000, null);
  await details.want(run, [7, 17], 1000, null);
  assert.deepEqual(asked.slice(1), [[6, 8, 0.004]]);
  await details.want(run, [7, 17], 1000, null);
  assert.deepEqual(asked.slice(2), [[16, 18, 0.004]]);
});

test("detail a second ahead of playback comes first", async () => {
  const run = coarse(60);
  const asked: (readonly number[])[] = [];
  const details = new Details(async (from, to) => {
    asked.push([from, to]);
    fine(run, from, to);
  });
  await details.want(run, [0, 60], 1000, 3.2);
  await details.want(run, [0, 60], 1000, 3.2);
  await details.want(run, [0, 60], 1000, 3.9);
  assert.deepEqual(asked, [[2, 6]]);
});

test("of a run that grows only whole blocks are asked for, and of one that refuses nothing twice", async () => {
  const run = coarse(7);
  const asked: (readonly number[])[] = [];
  const details = new Details(async (from, to) => {
    asked.push([from, to]);
    throw new Error("refused");
  });
  await details.want(run, [5, 7], 1000, null);
  assert.deepEqual(asked, [[4, 6]]);
  await details.want(run, [5, 7], 1000, null);
  assert.equal(asked.length, 1);
  const six = [0, 0, 0, 0, 0, 0] as const;
  run.take({ type: "run_ended", run: 1, state: "finished", moment: { t: 7, line: 0, joints: six, tcp_pose: six, globals: [], signals: {}, threads: [] } });
  await details.want(run, [5, 7], 1000, null);
  assert.deepEqual(asked.slice(1), [[6, 7]]);
  await details.want(coarse(7), [0, 1], 1000, null);
  assert.deepEqual(asked.slice(2), [[0, 2]]);
});

test("one answer is waited for at a time", { timeout: 5000 }, async () => {
  const run = coarse(60);
  let answer = () => {};
  let count = 0;
  const details = new Details(() => {
    count++;
    return new Promise((resolve) => (answer = resolve));
  });
  const first = details.want(run, [0, 4], 1000, null);
  await details.want(run, [10, 14], 1000, null);
  assert.equal(count, 1);
  answer();
  await first;
  void details.want(run, [10, 14], 1000, null);
  assert.equal(count, 2);
});
