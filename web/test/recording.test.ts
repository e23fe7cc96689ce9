import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { aligned, anchors, recordingIn, runOf, timeOf, titleOf } from "../src/model/compare.ts";
import { Run } from "../src/model/run.ts";
import { Studio } from "../src/model/studio.ts";
import { RecordedSource } from "../src/source/recorded.ts";
import { fromBase64, readRecording } from "../src/source/recording.ts";
import type { Column } from "../src/source/rows.ts";

// Two runs on two arms, and some of their rows, as Python has recorded them: conversations/README.md.
const made = JSON.parse(readFileSync(new URL("conversations/recording.json", import.meta.url), "utf8")) as {
  recording: string; names: Column[]; rows: number[][][];
};
const recording = () => readRecording(fromBase64(made.recording));

const nearly = (found: number, wanted: number, within = 1e-6) => assert.ok(Math.abs(found - wanted) <= within, `${found}, not ${wanted}`);

/** A run whose main thread is in `line` from each time on. */
function ran(text: string, visits: readonly (readonly [number, number])[], end: number): Run {
  const run = new Run(1, 1, {}, text);
  run.take({ type: "lines", run: 1, thread: "main", t: visits.map(([t]) => t), line: visits.map(([, line]) => line) });
  const ticks = Int32Array.from({ length: Math.round(end * 250) + 1 }, (_, tick) => tick);
  run.takeRows({ run: 1, ticks, columns: new Map([["q1", Float64Array.from(ticks, (tick) => tick / 250)]]) });
  run.take({ type: "run_ended", run: 1, state: "finished", moment: { t: end, line: 0, joints: [0, 0, 0, 0, 0, 0], tcp_pose: [0, 0, 0, 0, 0, 0], globals: [], signals: {}, threads: [] } });
  return run;
}

test("a recording holds every row of the trace to 1e-6", async () => {
  const runs = await recording();
  assert.equal(runs.length, 2);
  runs.forEach((run, number) => {
    for (const [tick, ...values] of made.rows[number]!) {
      const row = run.rows.ticks.indexOf(tick!);
      assert.ok(row >= 0);
      made.names.forEach((name, column) => nearly(run.rows.columns.get(name)![row]!, values[column]!));
    }
  });
});

test("bytes that are no recording are refused with a reason", async () => {
  const bytes = fromBase64(made.recording);
  await assert.rejects(readRecording(new Uint8Array(10)), /no recording/);
  await assert.rejects(readRecording(bytes.slice(0, bytes.length / 2)), /no recording/);
});

test("a page shows the recorded run: joints at a tick, globals, threads, signals, and the exact end", async () => {
  const [first] = await recording();
  const studio = new Studio(new RecordedSource(first!));
  studio.start();
  const [tick, ...values] = made.rows[0]![1]!;
  const show = async (t: number) => {
    studio.setCursor(t);
    await new Promise((resolve) => setTimeout(resolve));
    assert.ok(studio.isExact.value);
    return studio.moment.value!;
  };
  const early = await show(tick! / 250);
  early.joints.forEach((joint, index) => nearly(joint, values[index]!));
  early.tcp_pose.forEach((value, index) => nearly(value, values[made.names.indexOf("x") + index]!));
  assert.deepEqual(early.globals.map(({ name, value, type }) => [name, value, type]), [["n", "1", "int"]]);
  assert.deepEqual((await show(0.1)).threads.map(({ name, line, waits_for }) => [name, line, waits_for !== ""]), [["main", 11, true], ["other", 5, true]]);
  assert.deepEqual((await show(0.1)).signals, {});
  assert.deepEqual((await show(0.3)).signals, { "standard_digital_out[1]": true });
  assert.deepEqual((await show(0.3)).threads.map(({ name }) => name), ["main"]);
  assert.deepEqual((await show(1)).globals.map(({ value, changed }) => [value, changed]), [["2", true]]);
  assert.deepEqual(await show(studio.end.value), studio.run.value!.last);
  studio.close();
});

test("a recorded run is stepped through by the lines that took time", async () => {
  const [first] = await recording();
  const studio = new Studio(new RecordedSource(first!));
  studio.start();
  const begins = studio.run.value!.lines.get("main")!.t;
  await studio.step(1);
  assert.equal(studio.cursor.value, begins.find((t) => t > 0) ?? studio.end.value);
  studio.close();
});

test("a recording is found in the text of its page alone", async () => {
  assert.equal(recordingIn(`<html><script type="text/plain" id="recording">${made.recording}</script>`), made.recording);
  assert.equal(recordingIn("def job():\nend\n"), null);
  assert.equal(recordingIn('<script type="text/plain" id="recording">@@recording@@</script>'), null);
  assert.equal(titleOf((await recording())[1]!), "job.script · CS612");
});

test("visits of the same line belong together, lines of two versions too", () => {
  const ours = ran("a\nnew\nb\nc", [[0, 1], [1, 2], [2, 3], [4, 4], [5, 3], [6, 4]], 7);
  const theirs = ran("a\nb\nc", [[0, 1], [1, 2], [2, 3], [5, 2], [6, 3]], 8);
  const along = anchors(theirs, ours);
  assert.deepEqual(along, [
    { theirs: 0, ours: 0 }, { theirs: 1, ours: 2 }, { theirs: 2, ours: 4 }, { theirs: 5, ours: 5 }, { theirs: 6, ours: 6 }, { theirs: 8, ours: 7 },
  ]);
  assert.equal(timeOf(3.5, along), 4.5);
  assert.equal(timeOf(9, along), 8);
});

test("visits in another order are not crossed", () => {
  const ours = ran("a\nb\nc", [[0, 1], [1, 2], [2, 3]], 3);
  const theirs = ran("a\nb\nc", [[0, 1], [1, 3], [2, 2]], 3);
  const along = anchors(theirs, ours);
  assert.ok(along.every((anchor, index) => index === 0 || (anchor.theirs > along[index - 1]!.theirs && anchor.ours > along[index - 1]!.ours)));
});

test("a run that is aligned is where ours is, line by line", () => {
  const ours = ran("a\nb", [[0, 1], [1, 2]], 2);
  const theirs = ran("a\nb", [[0, 1], [3, 2]], 4);
  const run = aligned(theirs, ours);
  assert.equal(run.lineAt(0.5), 1);
  assert.equal(run.lineAt(1), 2);
  nearly(run.samples.joints(0.5)![0], 1.5, 0.013);
  nearly(run.samples.joints(1.5)![0], 3.5, 0.013);
  assert.equal(run.known_s, 2);
  assert.equal(theirs.known_s, 4);
});

test("the studio aligns when asked, and ends a comparison", async () => {
  const [first, second] = await recording();
  const studio = new Studio(new RecordedSource(first!));
  studio.start();
  const other = runOf(second!);
  studio.compareWith(other, "other");
  assert.equal(studio.compared.value, other);
  studio.alignment.value = "visit";
  assert.notEqual(studio.compared.value, other);
  assert.equal(studio.compared.value!.known_s, studio.run.value!.known_s);
  studio.compareWith(null);
  assert.equal(studio.compared.value, null);
  studio.close();
});
