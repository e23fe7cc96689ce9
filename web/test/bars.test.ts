import assert from "node:assert/strict";
import { test } from "node:test";
import { after, atOrAfter, bars, levelSteps, marks } from "../src/model/bars.ts";
import { random } from "./random.ts";

test("places in ascending times", () => {
  assert.deepEqual([0, 1, 1.5, 3, 4].map((t) => after([1, 1, 3], t)), [0, 2, 2, 3, 3]);
  assert.deepEqual([0, 1, 1.5, 3, 4].map((t) => atOrAfter([1, 1, 3], t)), [0, 0, 2, 2, 3]);
});

test("wide spans are drawn as they are, cut at the edges", () => {
  const end = [10, 20, 30];
  const found = bars({ start: [0, 10, 20], end: (index) => end[index]! }, 5, 25, 200);
  assert.deepEqual(found, [
    { x0: 0, x1: 50, index: 0, count: 1 },
    { x0: 50, x1: 150, index: 1, count: 1 },
    { x0: 150, x1: 200, index: 2, count: 1 },
  ]);
});

test("spans of one column are one bar, and a wide one that begins there is its own", () => {
  const start = [0, 5, 5.1, 5.2, 5.3];
  const end = [5, 5.1, 5.2, 5.3, 10];
  const found = bars({ start, end: (index) => end[index]! }, 0, 10, 10);
  assert.deepEqual(found, [
    { x0: 0, x1: 5, index: 0, count: 1 },
    { x0: 5, x1: 6, index: 1, count: 3 },
    { x0: 5.3, x1: 10, index: 4, count: 1 },
  ]);
});

test("no span gets lost, whatever the zoom", () => {
  const draw = random(11);
  for (let round = 0; round < 300; round++) {
    const start = [0];
    const count = 1 + Math.floor(draw() * 400);
    while (start.length < count) start.push(start.at(-1)! + (draw() < 0.8 ? 0.004 * Math.ceil(3 * draw()) : 2 * draw()));
    const gaps = start.map(() => draw() < 0.3);
    const end = (index: number) => (gaps[index] ? (start[index]! + (start[index + 1] ?? start[index]! + 1)) / 2 : (start[index + 1] ?? start[index]! + 1));
    const last = end(start.length - 1);
    const from = draw() * last;
    const to = from + 0.02 + draw() * last;
    const width = 50 + Math.floor(300 * draw());
    const found = bars({ start, end }, from, to, width);
    const seen = start.map(() => 0);
    for (const { index, count: several } of found) for (let other = index; other < index + several; other++) seen[other]!++;
    start.forEach((t, index) => {
      const isIn = t <= to && end(index) > from;
      if (isIn) assert.equal(seen[index], 1, `span ${index} of ${round}`);
      else if (end(index) < from - 1e-9 || t > to + 1e-9) assert.equal(seen[index], 0, `span ${index} of ${round}`);
    });
    for (const { x0, x1 } of found) assert.ok(x0 >= 0 && x1 <= width + 1e-9 && x1 - x0 >= 1 - 1e-9);
    assert.ok(found.length <= 2 * width + 2);
  }
});

test("levels: one step for each column, with all that happened in it", () => {
  const { first, steps } = levelSteps([0, 1, 1.1, 1.2, 5], [0, 1, 7, 2, 3], 0.5, 10.5, 10);
  assert.equal(first, 0);
  assert.deepEqual(steps, [
    { x: 0.5, before: 0, after: 2, low: 0, high: 7, count: 3 },
    { x: 4.5, before: 2, after: 3, low: 2, high: 3, count: 1 },
  ]);
});

test("levels of random changes: the last one counts, each is in one step", () => {
  const draw = random(5);
  for (let round = 0; round < 100; round++) {
    const times = [0];
    while (times.length < 200) times.push(times.at(-1)! + 0.004 + draw() * 0.1);
    const levels = times.map(() => Math.floor(9 * draw()));
    const [from, to] = [draw() * 5, 6 + 5 * draw()];
    const { first, steps } = levelSteps(times, levels, from, to, 60);
    assert.equal(first, levels[after(times, from) - 1]);
    assert.equal(steps.reduce((sum, step) => sum + step.count, 0), times.filter((t) => t > from && t <= to).length);
    assert.equal(steps.at(-1)?.after ?? first, levels[after(times, to) - 1]);
    steps.forEach((step, index) => assert.equal(step.before, steps[index - 1]?.after ?? first));
  }
});

test("marks near each other are one of the heaviest kind, which is drawn last", () => {
  const weights = [1, 9, 1, 2];
  const found = marks([1, 1.2, 1.3, 8], (index) => weights[index]!, 0, 10, 100, 5);
  assert.deepEqual(found.map(({ index, count }) => [index, count]), [[3, 1], [1, 3]]);
  assert.ok(Math.abs(found[1]!.x - 12) < 1e-9);
  assert.deepEqual(marks([1, 9], () => 0, 2, 8, 100, 5), []);
});
