import assert from "node:assert/strict";
import { test } from "node:test";
import { eventText, indexAt, Lanes, lanesByLine, markKind, marksNear, nextStop, type LevelLane, type MarkLane, type SpanLane } from "../src/model/lanes.ts";
import { Run } from "../src/model/run.ts";
import type { Contact, RunEvent } from "../src/source/messages.ts";

const SIGNAL = (t: number, name: string, value: boolean | number | string, line = 0): RunEvent => ({ type: "signal", t, name, value, by: "program", line });
const CHANNEL = (t: number, what: string, channel = "cam"): RunEvent => ({ type: "channel", t, channel, kind: "socket", what, data: "x", line: 3, thread: "main" });

function events(run: Run, ...list: RunEvent[]): void {
  run.take({ type: "events", run: 1, list });
}

test("lanes come in the order of groups, terminals before registers, outputs before inputs", () => {
  const run = new Run(1, 1, {});
  events(
    run,
    SIGNAL(1, "output_int_register[3]", 4),
    SIGNAL(1, "standard_digital_in[10]", true),
    SIGNAL(1, "standard_digital_in[9]", true),
    SIGNAL(1, "standard_digital_out[1]", true),
    CHANNEL(1, "open"),
    { type: "device", t: 1, level: "info", device: "camera", text: "picture" },
    { type: "log", t: 2, level: "info", text: "hello", thread: "main", line: 1 },
    { type: "safety", t: 3, mode: "PROTECTIVE_STOP", text: "contact" },
  );
  run.take({ type: "lines", run: 1, thread: "main", t: [0], line: [1] });
  run.take({ type: "lines", run: 1, thread: "beat", t: [0], line: [7] });
  run.take({ type: "moves", run: 1, list: [{ start_s: 0, end_s: 1, kind: "movej", line: 2 }] });
  const contact: Contact = { start_s: 1, end_s: 2, line: 4, first: "elbow", second: "table", distance_m: -0.01, t: 1.5, is_contact: true };
  run.take({ type: "contacts", run: 1, list: [{ ...contact, is_contact: false }, contact] });
  const lanes = new Lanes(run);
  assert.deepEqual(lanes.all.map(({ id }) => id), [
    "lines main", "lines beat", "moves", "contacts", "messages", "safety", "signal standard_digital_out[1]", "signal standard_digital_in[9]",
    "signal standard_digital_in[10]", "signal output_int_register[3]", "channel socket cam", "device camera",
  ]);
  assert.equal((lanes.get("contacts") as SpanLane).what(0), "elbow – table");
  assert.deepEqual(lanes.entries().map(({ t, kind }) => `${t} ${kind}`), [
    "0 move", "1 signal", "1 signal", "1 signal", "1 signal", "1 channel", "1 device", "1 contact", "2 log", "3 safety",
  ]);
});

test("a lane of a signal: the level before, and of one tick the last one", () => {
  const run = new Run(1, 1, {});
  run.take({ type: "progress", run: 1, t: 5 });
  const lanes = new Lanes(run);
  events(run, SIGNAL(1, "flag[0]", true, 12), SIGNAL(2, "standard_analog_out[0]", 1.5));
  assert.equal(lanes.all.length, 2);
  events(run, SIGNAL(2, "flag[0]", false), SIGNAL(2, "flag[0]", true, 14), SIGNAL(3, "standard_analog_out[0]", "NaN"));
  const flag = lanes.get("signal flag[0]") as LevelLane;
  assert.deepEqual([flag.start, flag.value, flag.line, flag.isBit], [[0, 1, 2], [0, 1, 1], [0, 12, 14], true]);
  assert.deepEqual([0, 0.996, 1, 9].map((t) => indexAt(flag, t)), [0, 0, 1, 2]);
  const analog = lanes.get("signal standard_analog_out[0]") as LevelLane;
  assert.deepEqual([analog.value, analog.isBit, analog.end()], [[0, 1.5, NaN], false, 5]);
});

test("a channel is open from its opening until it is closed, or until now", () => {
  const run = new Run(1, 1, {});
  run.take({ type: "progress", run: 1, t: 9 });
  events(run, CHANNEL(1, "open"), CHANNEL(2, "sent"), CHANNEL(3, "closed"), CHANNEL(3, "closed"), CHANNEL(4, "refused"), CHANNEL(5, "open"));
  const lane = new Lanes(run).get("channel socket cam") as MarkLane;
  assert.deepEqual(lane.open.start.map((t, index) => [t, lane.open.end(index)]), [[1, 3], [5, 9]]);
  assert.deepEqual(marksNear(lane, 3.01, 0.02).map(markKind), ["closed", "closed"]);
  assert.deepEqual(lane.events.map(markKind), ["open", "sent", "closed", "closed", "refused", "open"]);
});

test("lines, moves and modes of safety follow a run that grows", () => {
  const run = new Run(1, 1, {});
  run.take({ type: "lines", run: 1, thread: "main", t: [0, 1], line: [1, 2] });
  run.take({ type: "moves", run: 1, list: [{ start_s: 0, end_s: 1, kind: "movej", line: 2 }] });
  run.take({ type: "progress", run: 1, t: 1.5 });
  const lanes = new Lanes(run);
  const main = lanes.get("lines main") as SpanLane;
  const moves = lanes.get("moves") as SpanLane;
  assert.deepEqual([main.end(1), moves.start], [1.5, [0]]);
  run.take({ type: "lines", run: 1, thread: "main", t: [2, 4], line: [0, 1] });
  run.take({ type: "moves", run: 1, list: [{ start_s: 0, end_s: 2, kind: "movel", line: 3 }, { start_s: 2, end_s: 4, kind: "movej", line: 2 }] });
  run.take({ type: "progress", run: 1, t: 4 });
  assert.deepEqual([main.end(1), main.end(3), moves.start, moves.what(0), moves.end(0)], [2, 4, [0, 2], "movel", 2]);
  assert.deepEqual([0, 1.9, 4, 5].map((t) => indexAt(main, t)), [0, 1, 3, -1]);
  assert.deepEqual([1, 3.9, 4.1].map((t) => indexAt(moves, t)), [0, 1, -1]);
  events(run, { type: "safety", t: 1, mode: "REDUCED", text: "" });
  const safety = lanes.get("safety") as SpanLane;
  events(run, { type: "safety", t: 3, mode: "NORMAL", text: "door" });
  void lanes.all;
  assert.deepEqual([safety.end(0), safety.end(1), safety.what(0), safety.what(1)], [3, 4, "REDUCED", "NORMAL: door"]);
});

test("a lane for each of the longest lines, and one for the others", () => {
  const run = new Run(1, 1, {});
  run.take({ type: "lines", run: 1, thread: "main", t: [0, 1, 4, 5, 5.5], line: [10, 12, 11, 10, 0] });
  run.take({ type: "progress", run: 1, t: 7 });
  const lanes = lanesByLine(run, "main", 2);
  assert.deepEqual(lanes.map(({ name, start }) => [name, [...start]]), [["12", [1]], ["", [0, 4, 5]]]);
  assert.deepEqual([lanes[1]!.line(1), lanes[1]!.end(1), lanes[1]!.end(2)], [11, 5, 5.5]);
  assert.deepEqual(lanesByLine(run, "main", 3).map(({ name }) => name), ["10", "11", "12"]);
  assert.deepEqual(lanesByLine(run, "beat", 3), []);
});

test("the next and the previous of some times", () => {
  assert.deepEqual([0.5, 1, 2, 3].map((t) => nextStop([1, 2, 3], t, 1)), [1, 2, 3, null]);
  assert.deepEqual([1, 1.5, 3, 9].map((t) => nextStop([1, 2, 3], t, -1)), [null, 1, 2, 3]);
});

test("what events say", () => {
  const said = (type: string, fields: object) => eventText({ type, t: 0, ...fields });
  assert.equal(said("channel", { kind: "socket", channel: "cam", what: "sent", data: "trigger" }), "socket cam sent: trigger");
  assert.equal(said("popup", { title: "Box", text: "Insert" }), "Box: Insert");
  assert.equal(said("alarm", { code: "R101", class: "TypeError", text: "no" }), "R101 TypeError: no");
  assert.equal(said("warning", { text: "slow" }), "slow");
  assert.equal(said("print", { text: "a\n" }), "a");
  assert.equal(said("signal", { name: "flag[0]", value: true }), "flag[0] = true");
});

test("50,000 events are taken once each", () => {
  const run = new Run(1, 1, {});
  const lanes = new Lanes(run);
  const before = process.cpuUsage().user;
  for (let part = 0; part < 100; part++) {
    events(run, ...Array.from({ length: 500 }, (_, index) => SIGNAL((part * 500 + index) * 0.004, `output_int_register[${index % 14}]`, index)));
    assert.equal(lanes.all.length, 14);
  }
  assert.equal(lanes.all.reduce((sum, lane) => sum + lane.stops.length, 0), 50_000);
  // Beginning again with each part would make 2,500,000 steps.
  assert.ok(process.cpuUsage().user - before < 1_500_000);
});
