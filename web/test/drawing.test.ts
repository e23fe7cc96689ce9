import assert from "node:assert/strict";
import { afterEach, beforeEach, mock, test } from "node:test";
import { Studio } from "../src/model/studio.ts";
import { Drawing } from "../src/regions/robot/drawing.ts";
import type { AlarmReport, FromSource, Moment, Scene, Six } from "../src/source/messages.ts";
import type { Column } from "../src/source/rows.ts";
import { NO_ALARM_PARTS } from "./fake.ts";

const ZERO: Six = [0, 0, 0, 0, 0, 0];
const SCENE = {
  type: "scene", robot: "CS66", parts: [], tcp: ZERO, payload_kg: 0, center_of_gravity: [0, 0, 0], mounting: ZERO,
  dh: Array.from({ length: 6 }, () => ({ a: 0, d: 0, alpha: 0 })),
  limits: { position_min: ZERO, position_max: ZERO, speed: ZERO, acceleration: ZERO, tcp_speed: 1, reach: 1 },
} as const satisfies Scene;

const moment = (t: number, joints: Six): Moment => ({ t, line: 1, joints, tcp_pose: [1, 2, 3, 0, 0, 0], globals: [], signals: {}, threads: [] });

/** A page whose source answers nothing by itself. */
class Page {
  readonly sent: { readonly type: string; readonly ask?: number }[] = [];
  readonly studio = new Studio({ start: () => {}, send: (message) => void this.sent.push(message), close: () => {} });
  readonly drawing = new Drawing(this.studio);

  constructor(abilities: readonly ("seek" | "live")[] = ["seek"]) {
    this.studio.linked("open");
    this.studio.message({ type: "hello", protocol: 1, product: "", mode: "live", abilities, title: "" });
    this.studio.message(SCENE);
  }

  /** A run in which joint 1 turns with 1 rad/s, x grows with 0.1 m/s, and each second is a line. */
  run(run: number, until_s: number, turn = 1): void {
    this.studio.message({ type: "run_began", run, version: 0, same_until_s: 0, options: {} });
    this.rows(run, until_s, turn);
    const seconds = Array.from({ length: Math.ceil(until_s) }, (_, second) => second);
    this.studio.message({ type: "lines", run, thread: "main", t: seconds, line: seconds.map((second) => second + 1) });
  }

  rows(run: number, until_s: number, turn = 1): void {
    const t = Array.from({ length: Math.round(until_s / 0.04) + 1 }, (_, row) => row * 0.04);
    const columns = new Map<Column, Float64Array>();
    for (const q of ["q1", "q2", "q3", "q4", "q5", "q6"] as const) columns.set(q, Float64Array.from(t, (time) => (q === "q1" ? turn * time : 0)));
    columns.set("x", Float64Array.from(t, (time) => 0.1 * time));
    for (const name of ["y", "z", "rx", "ry", "rz"] as const) columns.set(name, new Float64Array(t.length));
    this.studio.rows({ run, ticks: Int32Array.from(t, (time) => Math.round(time * 250)), columns });
    this.drawing.refresh();
  }

  end(run: number, t: number, alarm?: AlarmReport): void {
    this.studio.message({ type: "run_ended", run, state: alarm === undefined ? "finished" : "alarm", moment: moment(t, ZERO), ...(alarm === undefined ? {} : { alarm }) });
    this.drawing.refresh();
  }

  /** Answers the newest question for a state. */
  answer(run: number, t: number, joints: Six): void {
    const ask = this.sent.filter(({ type }) => type === "seek").at(-1)!.ask!;
    this.studio.message({ type: "state", ask, run, moment: moment(t, joints) } satisfies FromSource);
  }
}

const settled = () => new Promise((done) => setImmediate(done));

beforeEach(() => mock.timers.enable({ apis: ["setTimeout"] }));
afterEach(() => mock.timers.reset());

test("the arm is between two rows at once, and exact when the source has answered", async () => {
  const page = new Page();
  page.run(1, 4);
  page.end(1, 4);
  page.studio.setCursor(1.02);
  const { t, joints, isExact } = page.drawing.drawn.value;
  assert.deepEqual([t, Math.round(1e9 * joints[0]) / 1e9, isExact], [1.02, 1.02, false]);
  page.answer(1, 0, ZERO); // asked for when the run began
  await settled();
  page.answer(1, 1.02, [1.0200001, 0, 0, 0, 0, 0]);
  await settled();
  assert.deepEqual(page.drawing.drawn.value.joints, [1.0200001, 0, 0, 0, 0, 0]);
  assert.equal(page.drawing.drawn.value.isExact, true);
  assert.deepEqual(page.drawing.tcpPose.value.slice(0, 3), [1, 2, 3]);
});

test("before there is a run the arm is where the options put it", () => {
  const page = new Page();
  page.studio.setOptions({ joints: [1, 2, 3, 4, 5, 6] });
  assert.deepEqual(page.drawing.drawn.value.joints, [1, 2, 3, 4, 5, 6]);
  assert.equal(page.drawing.path.value, null);
});

test("the rest of the run before is stale until the newest is that far", () => {
  const page = new Page();
  page.run(1, 4);
  page.end(1, 4);
  assert.equal(page.drawing.stale.value, null);
  page.run(2, 1);
  assert.equal(page.drawing.path.value!.t.at(-1), 1);
  assert.equal(page.drawing.stale.value!.t.at(-1), 4);
  assert.ok(page.drawing.stale.value!.t[0]! >= 0.96 && page.drawing.stale.value!.t[0]! <= 1);
  page.end(2, 1);
  assert.equal(page.drawing.stale.value, null);
});

test("paths are made once for a frame, however many messages come", () => {
  const page = new Page();
  page.run(1, 1);
  const path = page.drawing.path.value;
  page.studio.message({ type: "progress", run: 1, t: 1 });
  page.studio.message({ type: "progress", run: 1, t: 2 });
  assert.equal(page.drawing.path.value, path);
  page.drawing.refresh();
  assert.notEqual(page.drawing.path.value, path);
});

test("the thick part is that of the line that is pointed at, else of the cursor", () => {
  const page = new Page();
  page.run(1, 4);
  page.end(1, 4);
  page.studio.setCursor(2.5);
  assert.equal(page.drawing.line.value, 3);
  page.studio.point({ t: 0.5, region: "timeline" });
  assert.equal(page.drawing.line.value, 1);
  page.studio.point({ line: 2, region: "program" });
  assert.equal(page.drawing.line.value, 2);
});

test("ghosts: at the time that is pointed at, of a line at its first visit; none where the arm is", () => {
  const page = new Page();
  page.run(1, 4);
  page.end(1, 4);
  page.studio.setCursor(2);
  const hovered = () => page.drawing.ghosts.value.map(({ kind, joints, text }) => [kind, Math.round(1e6 * (joints?.[0] ?? NaN)) / 1e6, text]);
  assert.deepEqual(hovered(), []);
  page.studio.point({ t: 3.5, region: "timeline" });
  assert.deepEqual(hovered(), [["hovered", 3.5, "3.500 s"]]);
  page.studio.point({ line: 2, region: "program" });
  assert.deepEqual(hovered(), [["hovered", 1, "1.000 s"]]);
  page.studio.point({ t: 2, region: "timeline" });
  assert.deepEqual(hovered(), []);
});

test("an alarm about a target shows it: as an arm, or as a frame where only the pose is known", () => {
  const alarm: AlarmReport = { ...NO_ALARM_PARTS, t: 4, line: 2, column: 1, code: "C204", text: "out of range", hints: [], limit: "joint 3: 3.2 rad, limit 3.05 rad" };
  const page = new Page();
  page.run(1, 4);
  page.end(1, 4, { ...alarm, asked_joints: [0, 0, 3.2, 0, 0, 0] });
  assert.deepEqual(page.drawing.ghosts.value, [{ kind: "asked", text: "C204: joint 3: 3.2 rad, limit 3.05 rad", joints: [0, 0, 3.2, 0, 0, 0] }]);
  page.end(1, 4, { ...alarm, asked_pose: [1, 2, 3, 0, 0, 0] });
  assert.deepEqual(page.drawing.ghosts.value[0]!.frame!.slice(9), [1, 2, 3]);
  page.end(1, 4, alarm);
  assert.deepEqual(page.drawing.ghosts.value, []);
});

test("the run that is compared is a second arm at the same time", () => {
  const page = new Page();
  page.run(1, 4);
  page.end(1, 4);
  page.run(2, 4, 0.5);
  page.end(2, 4);
  page.studio.compareBefore();
  page.drawing.refresh();
  page.studio.setCursor(2);
  const [ghost] = page.drawing.ghosts.value;
  assert.deepEqual([ghost!.kind, Math.round(1e6 * ghost!.joints![0]) / 1e6], ["compared", 2]);
  assert.equal(page.drawing.compared.value!.t.length, 101);
});

test("a controller: the arm as it says, the target as a ghost, a trail of the last minute", () => {
  const page = new Page(["live"]);
  page.run(1, 100);
  const controller = { link: "connected", address: "", model: "", firmware: "", serial: "", robot_mode: "", safety_mode: "", task_state: "", program: "", speed_fraction: 1 } as const;
  page.studio.message({ type: "moment", moment: moment(100, [0.5, 0, 0, 0, 0, 0]), controller: { ...controller, target_joints: [0.6, 0, 0, 0, 0, 0] } });
  page.drawing.refresh();
  assert.deepEqual([page.drawing.drawn.value.t, page.drawing.drawn.value.joints[0], page.drawing.drawn.value.isExact], [100, 0.5, true]);
  assert.deepEqual(page.drawing.ghosts.value, [{ kind: "target", joints: [0.6, 0, 0, 0, 0, 0], text: "" }]);
  assert.deepEqual([page.drawing.path.value!.t[0], page.drawing.path.value!.t.at(-1)], [40, 100]);
});
