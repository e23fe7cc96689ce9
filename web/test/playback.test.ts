import assert from "node:assert/strict";
import { test } from "node:test";
import { signal } from "@preact/signals-core";
import { Playback, type Frames } from "../src/model/playback.ts";
import { Run } from "../src/model/run.ts";
import type { RunEvent } from "../src/source/messages.ts";
import { random } from "./random.ts";

/** Frames that the test gives. */
class Clock implements Frames {
  now_ms = 1000;
  private readonly waiting = new Map<number, (now_ms: number) => void>();
  private next = 1;

  request(frame: (now_ms: number) => void): number {
    this.waiting.set(this.next, frame);
    return this.next++;
  }

  cancel(handle: number): void {
    this.waiting.delete(handle);
  }

  get isIdle(): boolean {
    return this.waiting.size === 0;
  }

  pass(ms: number): void {
    this.now_ms += ms;
    const frames = [...this.waiting.values()];
    this.waiting.clear();
    for (const frame of frames) frame(this.now_ms);
  }
}

function prepared(end_s: number, events: readonly RunEvent[] = [], hasEnded = true) {
  const run = new Run(1, 1, {});
  run.take({ type: "events", run: 1, list: events });
  run.take({ type: "progress", run: 1, t: end_s });
  if (hasEnded) end(run, end_s);
  const cursor = signal(0);
  const asked: number[] = [];
  const played = {
    run: signal<Run | null>(run), cursor, isPlaying: signal(false), rate: signal(1),
    setCursor: (t: number) => { cursor.value = Math.round(t * 250) / 250; },
    advance: (t: number, asks: boolean) => { cursor.value = t; if (asks) asked.push(t); },
  };
  const clock = new Clock();
  return { run, played, clock, cursor, asked, playback: new Playback(played, clock) };
}

function end(run: Run, t: number): void {
  const six = [0, 0, 0, 0, 0, 0] as const;
  run.take({ type: "run_ended", run: 1, state: "finished", moment: { t, line: 0, joints: six, tcp_pose: six, globals: [], signals: {}, threads: [] } });
}

const near = (value: number, expected: number) => assert.ok(Math.abs(value - expected) < 1e-9, `${value} is not ${expected}`);

test("plays in real time, faster and slower, and stops at the end", () => {
  const { played, clock, cursor } = prepared(2);
  assert.ok(clock.isIdle);
  played.isPlaying.value = true;
  clock.pass(500); // the first frame sets the time
  near(cursor.value, 0);
  clock.pass(16);
  near(cursor.value, 0.016);
  played.rate.value = 10;
  clock.pass(100);
  near(cursor.value, 1.016);
  played.rate.value = 0.25;
  clock.pass(20);
  near(cursor.value, 1.021);
  played.rate.value = 5;
  clock.pass(400);
  near(cursor.value, 2);
  assert.equal(played.isPlaying.value, false);
  assert.ok(clock.isIdle);
});

test("a pause leaves the cursor at a control period", () => {
  const { played, clock, cursor } = prepared(2);
  played.isPlaying.value = true;
  clock.pass(0);
  clock.pass(17);
  played.isPlaying.value = false;
  assert.equal(cursor.value, 0.016);
  assert.ok(clock.isIdle);
  played.isPlaying.value = true;
  clock.pass(5000);
  clock.pass(4);
  near(cursor.value, 0.02);
});

test("a page that was hidden goes on from where it was", () => {
  const { played, clock, cursor } = prepared(100);
  played.isPlaying.value = true;
  clock.pass(0);
  clock.pass(60_000);
  near(cursor.value, 0.5);
});

test("holds at the end of what is computed, and goes on with it", () => {
  const { run, played, clock, cursor, playback } = prepared(0.1, [], false);
  played.isPlaying.value = true;
  clock.pass(0);
  clock.pass(200);
  near(cursor.value, 0.1);
  assert.deepEqual([played.isPlaying.value, playback.isHeld.value], [true, true]);
  run.take({ type: "progress", run: 1, t: 3 });
  clock.pass(100);
  near(cursor.value, 0.2);
  assert.equal(playback.isHeld.value, false);
  end(run, 0.24);
  clock.pass(100);
  near(cursor.value, 0.24);
  assert.equal(played.isPlaying.value, false);
});

test("a stretch is played over and over, with the rest of a frame at its begin", () => {
  const { played, clock, cursor, playback } = prepared(10);
  playback.loop.value = [2, 2.1];
  played.isPlaying.value = true;
  clock.pass(0);
  near(cursor.value, 2);
  clock.pass(60);
  near(cursor.value, 2.06);
  clock.pass(60);
  near(cursor.value, 2.02);
  played.rate.value = 10;
  clock.pass(35);
  near(cursor.value, 2.07);
  playback.loop.value = null;
  played.rate.value = 1;
  clock.pass(100);
  near(cursor.value, 2.17);
});

test("a loop beyond the end of the run ends with it", () => {
  const { played, clock, cursor, playback } = prepared(1);
  playback.loop.value = [0.9, 5];
  played.isPlaying.value = true;
  clock.pass(0);
  clock.pass(120);
  near(cursor.value, 0.92);
  playback.loop.value = [4, 5];
  clock.pass(50);
  near(cursor.value, 0.97);
});

test("every event is passed once, in order, however long the frames are", () => {
  const draw = random(2);
  for (let round = 0; round < 20; round++) {
    const times = Array.from({ length: 300 }, () => Math.floor(draw() * 2500) / 250).sort((a, b) => a - b);
    const { played, clock, playback } = prepared(10, times.map((t, index) => ({ type: "log", t, index })));
    const passed: RunEvent[] = [];
    playback.listen((events) => passed.push(...events));
    played.rate.value = [0.25, 1, 10][round % 3]!;
    played.isPlaying.value = true;
    while (!clock.isIdle) clock.pass(draw() < 0.1 ? 400 * draw() : 30 * draw());
    assert.deepEqual(passed.map((event) => event["index"]), times.map((_, index) => index));
  }
});

test("a jump of the cursor passes nothing in between, a loop all of its events again", () => {
  const at = (t: number): RunEvent => ({ type: "log", t });
  const { played, clock, cursor, playback } = prepared(10, [at(0), at(1), at(5), at(5.1), at(5.2)]);
  const passed: number[] = [];
  const stop = playback.listen((events) => passed.push(...events.map(({ t }) => t)));
  played.isPlaying.value = true;
  clock.pass(0);
  clock.pass(20);
  cursor.value = 5;
  clock.pass(20);
  assert.deepEqual(passed, [0, 5]);
  playback.loop.value = [5, 5.2];
  clock.pass(200);
  assert.deepEqual(passed, [0, 5, 5.1, 5.2, 5]);
  stop();
  clock.pass(150);
  assert.equal(passed.length, 5);
});

test("the exact state is asked for ten times a second, not with each frame", () => {
  const { played, clock, asked } = prepared(10);
  played.isPlaying.value = true;
  for (let frame = 0; frame < 61; frame++) clock.pass(1000 / 60);
  assert.ok(asked.length >= 9 && asked.length <= 11, String(asked.length));
});

test("nothing moves once it is closed", () => {
  const { played, clock, playback } = prepared(10);
  played.isPlaying.value = true;
  playback.close();
  assert.ok(clock.isIdle);
});
