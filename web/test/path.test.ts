import assert from "node:assert/strict";
import { test } from "node:test";
import { after, lineAt, partsOf, type Path, pathOf, pick, project, scaleEnd, speedColour, straights } from "../src/model/path.ts";
import { Run } from "../src/model/run.ts";
import type { Column } from "../src/source/rows.ts";

const SCENE = { dh: [], tcp: [0, 0, 0, 0, 0, 0] } as const;

/** A run with a row every 40 ms. */
function runOf(columns: { readonly [name in Column]?: readonly number[] }, lines: readonly (readonly [number, number])[] = [[0, 1]]): Run {
  const run = new Run(1, 1, {});
  const count = columns.x?.length ?? columns.q1!.length;
  run.takeRows({
    run: 1, ticks: Int32Array.from({ length: count }, (_, row) => 10 * row),
    columns: new Map(Object.entries(columns).map(([name, values]) => [name as Column, Float64Array.from(values)])),
  });
  run.take({ type: "lines", run: 1, thread: "main", t: lines.map(([t]) => t), line: lines.map(([, line]) => line) });
  return run;
}

function straight(x: readonly number[], lines?: readonly (readonly [number, number])[], speed?: readonly number[]): Path {
  const zero = x.map(() => 0);
  return pathOf(runOf({ x, y: zero, z: zero, ...(speed === undefined ? {} : { speed }) }, lines), SCENE);
}

const near = (found: number, wanted: number) => assert.ok(Math.abs(found - wanted) < 1e-6, `${found} for ${wanted}`);

test("speeds: as they were sent, else from the points", () => {
  assert.deepEqual([...straight([0, 0.02, 0.04], undefined, [0, 0.5, 0.5]).speed], [0, 0.5, 0.5]);
  const path = straight([0, 0.02, 0.06]);
  [0.5, 1, 1].forEach((wanted, i) => near(path.speed[i]!, wanted));
  near(path.speed_max, 1);
});

test("a point that no speed explains is a jump, such as of a TCP that was set", () => {
  assert.deepEqual([...straight([0, 0.02, 0.3, 0.32], undefined, [0.5, 0.5, 0.5, 0.5]).jumps], [0, 1, 0]);
});

test("points follow from the joints where a source sends no poses", () => {
  const q = (angle: number) => [0, angle];
  const run = runOf({ q1: q(Math.PI / 2), q2: q(0), q3: q(0), q4: q(0), q5: q(0), q6: q(0) });
  const dh = Array.from({ length: 6 }, (_, joint) => ({ a: joint === 1 ? 0.5 : 0, d: 0, alpha: 0 }));
  const path = pathOf(run, { dh, tcp: [0.1, 0, 0, 0, 0, 0] });
  [0.6, 0, 0, 0, 0.6, 0].forEach((wanted, i) => near(path.xyz[i]!, wanted));
});

test("parts of a line: as long as possible, cut by other lines and by jumps", () => {
  const x = [0, 0.01, 0.02, 0.03, 0.04, 0.5, 0.51, 0.52];
  const path = straight(x, [[0, 4], [0.08, 7], [0.12, 4]], x.map(() => 0.25));
  assert.deepEqual([...path.line], [4, 4, 7, 4, 4, 4, 4]);
  assert.deepEqual(partsOf(path, 4), [{ from: 0, to: 2 }, { from: 3, to: 4 }, { from: 5, to: 7 }]);
  assert.deepEqual(partsOf(path, 7), [{ from: 2, to: 3 }]);
  assert.deepEqual(partsOf(path, 9), []);
  assert.equal(lineAt(path, 0.1), 7);
  assert.equal(lineAt(path, 9), 4);
});

test("what is straight and of even speed is drawn as one; corners, changes of speed and jumps are kept", () => {
  const x = [0, 0.01, 0.02, 0.03, 0.04, 0.05, 0.06];
  const even = x.map(() => 0.25);
  assert.deepEqual(straights(straight(x, undefined, even), 1), [0, 6]);
  assert.deepEqual(straights(straight(x, undefined, [0.25, 0.25, 0.25, 0.35, 0.25, 0.25, 0.25]), 1), [0, 2, 2, 3, 3, 4, 4, 6]);
  assert.deepEqual(straights(straight([0, 0.01, 0.02, 0.9, 0.91, 0.92], undefined, even), 1), [0, 2, 3, 5]);
  assert.deepEqual(straights(straight(x, undefined, even), 1, [{ from: 1, to: 3 }]), [1, 3]);
  assert.deepEqual(straights(straight([0.3, 0.3, 0.3, 0.3], undefined, [0, 0, 0, 0]), 1), []);
  // A circle of 0.2 m: every point is nearer than 0.1 mm to what is drawn.
  const turn = Array.from({ length: 500 }, (_, i) => (2 * Math.PI * i) / 500);
  const circle = pathOf(runOf({ x: turn.map((a) => 0.2 * Math.cos(a)), y: turn.map((a) => 0.2 * Math.sin(a)), z: turn.map(() => 0) }), SCENE);
  const pairs = straights(circle, 1);
  assert.ok(pairs.length / 2 < 250 && pairs.length / 2 > 40, String(pairs.length));
  for (let k = 0; k < pairs.length; k += 2) {
    const half = ((pairs[k + 1]! - pairs[k]!) * Math.PI) / 500;
    assert.ok(0.2 * (1 - Math.cos(half)) < 0.000101);
  }
});

test("the rest of a path begins with the stretch in which the time is", () => {
  const rest = after(straight([0, 0.01, 0.02, 0.03], [[0, 3], [0.08, 5]]), 0.1);
  assert.deepEqual([...rest.t].map((t) => Math.round(1000 * t)), [80, 120]);
  assert.deepEqual([...rest.line], [5]);
  near(rest.xyz[0]!, 0.02);
});

test("a trail: only the rows from a time on", () => {
  const path = pathOf(runOf({ x: [0, 1, 2, 3], y: [0, 0, 0, 0], z: [0, 0, 0, 0] }), SCENE, 0.08);
  assert.deepEqual([...path.xyz.filter((_, i) => i % 3 === 0)], [2, 3]);
});

test("colours: lightness goes one way only, and each stands out 3:1 from the background", () => {
  const channel = (value: number) => (value / 255 <= 0.04045 ? value / 255 / 12.92 : ((value / 255 + 0.055) / 1.055) ** 2.4);
  const lightness = (rgb: readonly number[]) => 0.2126 * channel(rgb[0]!) + 0.7152 * channel(rgb[1]!) + 0.0722 * channel(rgb[2]!);
  for (const [isDark, background] of [[false, [233, 237, 241]], [true, [38, 45, 54]]] as const) {
    const found = Array.from({ length: 21 }, (_, step) => lightness(speedColour(step / 20, isDark)));
    found.slice(1).forEach((value, i) => assert.ok(isDark ? value > found[i]! : value < found[i]!, `step ${i}`));
    for (const value of found) {
      const [high, low] = [Math.max(value, lightness(background)), Math.min(value, lightness(background))];
      assert.ok((high + 0.05) / (low + 0.05) >= 3, `${isDark}: ${((high + 0.05) / (low + 0.05)).toFixed(2)}`);
    }
  }
  assert.deepEqual(speedColour(2, true), speedColour(1, true));
});

test("the scale ends at a round number that is not below the largest speed", () => {
  assert.deepEqual([0, 0.07, 0.1, 0.13, 0.23, 0.4, 0.75, 1.9].map(scaleEnd), [0.1, 0.1, 0.1, 0.2, 0.25, 0.5, 1, 2]);
});

/** Looks along -z: x and y from -1 to 1 fill 200 by 100 pixels. */
const FLAT = [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1];

test("points on the screen, and none behind the camera", () => {
  const points = new Float32Array([0, 0, 0, 0.5, 0.5, 0]);
  assert.deepEqual([...project(points, FLAT, 200, 100)], [100, 50, 150, 25]);
  const behind = [...FLAT.slice(0, 15), -1];
  assert.ok(project(points, behind, 200, 100).every(Number.isNaN));
});

test("picking: the nearest moment between rows, within the tolerance", () => {
  const path = straight([0, 0.5], undefined, [12.5, 12.5]);
  const screen = project(path.xyz, FLAT, 200, 100); // from (100, 50) to (150, 50)
  const picked = pick(path, screen, 125, 46, 8, 0)!;
  near(picked.t, 0.02);
  assert.equal(picked.stretch, 0);
  near(picked.distance_px, 4);
  assert.equal(pick(path, screen, 125, 41, 8, 0), null);
  near(pick(path, screen, 155, 50, 8, 0)!.t, 0.04);
});

test("picking: of passes over one place that of the time nearest to the cursor; jumps are no places", () => {
  const path = straight([0, 0.5, 0, 0.5], undefined, [12.5, 12.5, 12.5, 12.5]);
  const screen = project(path.xyz, FLAT, 200, 100);
  assert.deepEqual([0, 0.06, 0.12].map((near_s) => Math.round(1000 * pick(path, screen, 125, 50, 8, near_s)!.t)), [20, 60, 100]);
  const jump = straight([0, 0.5], undefined, [0, 0]);
  assert.equal(pick(jump, project(jump.xyz, FLAT, 200, 100), 125, 50, 8, 0), null);
});
