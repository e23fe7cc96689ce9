/** Plays conversations of real sources to the page's model: see conversations/README.md. */

import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { Studio } from "../src/model/studio.ts";
import { fromBase64 } from "../src/source/recording.ts";
import { readRows } from "../src/source/rows.ts";
import type { FromSource, ToSource } from "../src/source/messages.ts";
import { EXAMPLES } from "./conversations/examples.ts";
import { FakeSource } from "./fake.ts";

type Entry = { readonly page: ToSource } | { readonly source: FromSource } | { readonly rows: string };

/** Plays a conversation up to an entry; what the page of then has said is its text here too. */
function played(name: string, isEnd: (message: FromSource) => boolean = () => false): Studio {
  const text = readFileSync(new URL(`conversations/${name}.jsonl`, import.meta.url), "utf8");
  const source = new FakeSource();
  const studio = new Studio(source);
  studio.start();
  source.link("open");
  for (const line of text.trim().split("\n")) {
    const entry = JSON.parse(line) as Entry;
    if ("rows" in entry) source.rows(readRows(fromBase64(entry.rows).buffer));
    else if ("source" in entry) {
      source.say(entry.source);
      if (isEnd(entry.source)) break;
    } else if (entry.page.type === "program" && studio.text.value !== entry.page.text) studio.edit(entry.page.text);
  }
  studio.close();
  return studio;
}

const nearly = (found: number, wanted: number, within = 1e-6) => assert.ok(Math.abs(found - wanted) <= within, `${found}, not ${wanted}`);

test("a live run: text, scene, rows, lines of two threads, moves, messages, signals, cycle time, the end", () => {
  const studio = played("live_edits", (message) => message.type === "run_ended");
  assert.equal(studio.hello.value?.mode, "live");
  assert.ok(studio.can("edit") && studio.can("record"));
  assert.ok(studio.text.value.startsWith("def job():"));
  assert.equal(studio.problems.value?.compiles, true);
  assert.equal(studio.scene.value?.dh.length, 6);
  const run = studio.run.value!;
  assert.equal(run.ended?.state, "finished");
  assert.deepEqual([...run.lines.keys()].sort(), ["main", "other"]);
  assert.equal(run.lineAt(0.1, "other"), 5);
  assert.equal(run.moves.length, 2);
  assert.deepEqual(run.messages.map(({ text }) => text), ["</script> <!-- \u2028 done"]);
  assert.deepEqual(run.signals.get("standard_digital_out[1]")?.value, [true]);
  nearly(run.samples.joints(run.known_s)![0], 0.2);
  nearly(run.cycle.reduce((sum, row) => sum + row.moving_s + row.standing_s, 0), run.known_s, 0.005);
  assert.deepEqual(run.last?.globals.map(({ name, value, type }) => [name, value, type]), [["n", "2", "int"]]);
});

test("an edit that does not compile keeps the run; the next one replaces it", () => {
  const broken = played("live_edits", (message) => message.type === "problems" && !message.compiles);
  assert.ok(broken.problems.value!.list[0]!.line === 9);
  assert.equal(broken.run.value?.number, 1);
  const studio = played("live_edits");
  assert.equal(studio.run.value?.moves.length, 3);
  assert.equal(studio.before.value?.moves.length, 2);
  assert.equal(studio.isModified.value, true);
  // Rows of the detail are 4 ms apart.
  assert.ok(studio.run.value!.samples.isFine(0.2, 0.24, 0.004));
});

test("an alarm: line, pose that was asked for, limit, contacts with things", () => {
  const run = played("live_alarm").run.value!;
  assert.equal(run.ended?.state, "alarm");
  assert.equal(run.alarm?.line, 3);
  nearly(run.alarm!.asked_pose![0], 3);
  assert.ok(run.contacts.some((contact) => [contact.first, contact.second].includes("post") && contact.distance_m < 1));
});

test("a controller: its state, joints, what it can do", () => {
  const studio = played("connected");
  assert.ok(studio.can("live") && studio.can("control") && !studio.can("edit"));
  assert.equal(studio.controller.value?.model, "CS66");
  assert.equal(studio.controller.value?.robot_mode, "RUNNING");
  nearly(studio.moment.value!.joints[1], -1.2);
  assert.ok(studio.run.value!.samples.length > 0);
});

test("a recorded run says what a live one says", () => {
  const studio = played("recorded");
  assert.equal(studio.hello.value?.mode, "recorded");
  const run = studio.run.value!;
  const live = played("live_edits", (message) => message.type === "run_ended").run.value!;
  assert.equal(run.known_s, live.known_s);
  assert.deepEqual(run.moves, live.moves);
  const cycle = (of: typeof run) => of.cycle.map((row) => [row.line, row.visits, Math.round(1e6 * row.moving_s), Math.round(1e6 * row.standing_s)]);
  assert.deepEqual(cycle(run), cycle(live));
  assert.deepEqual(run.last, live.last);
  assert.deepEqual(run.events, live.events);
});

test("messages of every recorded form are known", () => {
  assert.ok(EXAMPLES.length > 20);
  for (const type of ["hello", "scene", "file", "problems", "run_began", "events", "lines", "moves", "cycle", "contacts", "run_ended", "state", "detail_ended", "saved", "refused", "recorded", "answer", "moment", "done"]) {
    assert.ok(EXAMPLES.some((message) => message.type === type), type);
  }
});
