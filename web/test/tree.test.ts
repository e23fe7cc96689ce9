/** A graphical program beside its script: rows and lines, what a run says of rows, files that other tools write. */

import assert from "node:assert/strict";
import { test } from "node:test";
import { canRun, lineToShow, linesOf, nextBegin, nodeOf, placeOf, rowOf, rowsThatRan, rowsWith, shownFor, shownRows } from "../src/model/tree.ts";
import type { FromSource, ProgramTree, TreeRow } from "../src/source/messages.ts";
import { EDIT_MS, Studio } from "../src/model/studio.ts";
import { began, ended, FakeSource, HELLO, moment } from "./fake.ts";

const row = (level: number, kind: string, name = "", is_suppressed = false): TreeRow => ({ level, kind, name, summary: "", is_suppressed });

/** 1 variables, 2 main task, 3 loop, 4 move, 5 A, 6 suppressed B, 7 set, 8 if, 9 wait. */
const TREE: ProgramTree = {
  rows: [
    row(0, "Initial variables"), row(0, "Main task"), row(1, "Loop", "Loop_1"), row(2, "MoveJ"), row(3, "Waypoint", "A"),
    row(3, "Waypoint", "B", true), row(2, "Set"), row(1, "If"), row(2, "Wait"),
  ],
  lines: [0, 2, 3, 3, 4, 5, 5, 7, 7, 3, 8, 8, 9, 9, 0],
  places: ["", "1 Initial variables", "2 Main", "2 Main > 3 Loop", "3 Loop > 4 MoveJ", "4 MoveJ > 5 A", "4 MoveJ > 6 B", "3 Loop > 7 Set", "2 Main > 8 If", "8 If > 9 Wait"],
};
const TEXT = TREE.lines.map((_, index) => `line ${index + 1}`).join("\n");
const TASK = { type: "file", name: "cell.task", text: TEXT, digest: "t1", tree: TREE } as const satisfies FromSource;

/** A page that has the task open. */
function page() {
  const source = new FakeSource();
  const studio = new Studio(source);
  studio.start();
  source.link("open");
  source.say(HELLO, TASK);
  return { source, studio };
}

test("rows know their lines, their parents and what is beside them", () => {
  assert.deepEqual(linesOf(TREE, 3), [3, 4, 10]);
  assert.deepEqual(linesOf(TREE, 6), []);
  assert.equal(rowOf(TREE, 7), 5);
  assert.equal(rowOf(TREE, 99), 0);
  assert.equal(nodeOf(TREE, 7), "4 MoveJ > 5 A");
  assert.equal(nodeOf(null, 7), "");
  assert.deepEqual(placeOf(TREE, 5), { parent: 4, size: 2, position: 1, last: 5 });
  assert.deepEqual(placeOf(TREE, 3), { parent: 2, size: 2, position: 1, last: 7 });
  assert.deepEqual(placeOf(TREE, 2), { parent: 0, size: 2, position: 2, last: 9 });
});

test("folded rows hide what is in them, and stand for it", () => {
  assert.deepEqual(shownRows(TREE, new Set([3])), [1, 2, 3, 8, 9]);
  assert.deepEqual(shownRows(TREE, new Set([2, 3])), [1, 2]);
  assert.equal(shownFor(TREE, new Set([3]), 5), 3);
  assert.equal(shownFor(TREE, new Set([2, 3]), 5), 2);
  assert.equal(shownFor(TREE, new Set([5]), 5), 5);
});

test("a row is found by its number, kind or name", () => {
  const named = (at: number) => `${at} ${TREE.rows[at - 1]!.kind} ${TREE.rows[at - 1]!.name}`;
  assert.deepEqual(rowsWith(TREE, "waypoint", named), [5, 6]);
  assert.deepEqual(rowsWith(TREE, "7 set", named), [7]);
  assert.deepEqual(rowsWith(TREE, " ", named), []);
});

test("a row ran if its mark was passed, or a thread was in one of its lines; those around it ran too", () => {
  const { source, studio } = page();
  source.say(began(1, studio.version.value), { type: "marks", run: 1, t: [0, 0, 0.5, 2], node: [2, 3, 7, 3] });
  source.say({ type: "lines", run: 1, thread: "main", t: [0, 1], line: [7, 0] }, ended(1, 3));
  const run = studio.runOfTree.value!;
  assert.deepEqual([...rowsThatRan(TREE, run)].sort((a, b) => a - b), [2, 3, 4, 5, 7]);
  assert.equal(canRun(TREE, 1), false);
  assert.equal(canRun(TREE, 6), false);
  assert.equal(canRun(TREE, 8), true);
  assert.equal(lineToShow(TREE, run, 5), 7);
  assert.equal(lineToShow(TREE, run, 8), 11);
});

test("a click goes to the begin of a row, the next one after it, and from the last to the first", () => {
  const { source, studio } = page();
  source.say(began(1, studio.version.value), { type: "marks", run: 1, t: [0.4, 1.2], node: [7, 7] }, ended(1, 3));
  const run = studio.runOfTree.value!;
  assert.equal(nextBegin(TREE, run, 9, -1), null);
  for (const t of [0.4, 1.2, 0.4]) {
    studio.visitRow(7);
    assert.equal(studio.cursor.value, t);
  }
  studio.visitRow(9);
  assert.equal(studio.row.value, 9);
  assert.equal(studio.cursor.value, 0.4, "what never ran has no time");
});

test("the rows that run at the cursor are those of its threads, and none behind the end", () => {
  const { source, studio } = page();
  source.say(began(1, studio.version.value), { type: "lines", run: 1, thread: "main", t: [0, 1], line: [7, 13] });
  source.say({ type: "lines", run: 1, thread: "watch", t: [0], line: [9] }, { ...ended(1, 3), moment: moment(3, 0) } as FromSource);
  studio.setCursor(0.5);
  assert.deepEqual(studio.rowsNow.value, [5, 7]);
  studio.setCursor(1.5);
  assert.deepEqual(studio.rowsNow.value, [9, 7]);
  studio.setCursor(3);
  assert.deepEqual(studio.rowsNow.value, []);
});

test("a task that another tool writes runs again; its text is not edited, nor saved", async (context) => {
  context.mock.timers.enable({ apis: ["setTimeout"] });
  const { source, studio } = page();
  assert.equal(studio.canWrite.value, false);
  studio.edit("mine");
  assert.equal(studio.text.value, TEXT);
  assert.equal(await studio.save(), false);
  assert.equal(source.all("save").length, 0);
  const before = source.all("program").length;
  studio.row.value = 9;
  const short: ProgramTree = { rows: TREE.rows.slice(0, 2), lines: [0, 2], places: TREE.places.slice(0, 3) };
  source.say({ type: "file_changed", name: "cell.task", text: "line 1\nline 2", digest: "t2", tree: short });
  context.mock.timers.tick(EDIT_MS);
  assert.equal(source.all("program").length, before + 1);
  assert.equal(source.last("program").text, "line 1\nline 2");
  assert.equal(studio.conflict.value, null);
  assert.equal(studio.row.value, 2);
  assert.equal(studio.isModified.value, false);
});

test("what ran before a task was changed keeps its own nodes", () => {
  const { source, studio } = page();
  source.say(began(1, studio.version.value));
  assert.equal(studio.nodeInRun(7), "4 MoveJ > 5 A");
  const other: ProgramTree = { rows: [], lines: [], places: [""] };
  source.say({ type: "file_changed", name: "cell.task", text: "<EliTask", digest: "t3", tree: other });
  assert.equal(studio.nodeAt(7), "");
  assert.equal(studio.nodeInRun(7), "4 MoveJ > 5 A");
  assert.equal(studio.runOfTree.value, null);
});

test("a file that is gone for a moment is still shown", () => {
  const { source, studio } = page();
  source.say({ type: "file_changed", name: "cell.task", digest: "" });
  assert.equal(studio.tree.value, TREE);
  assert.match(studio.notices.value.at(-1)!.text, /cell\.task/);
  const told = source.all("program").length;
  source.say({ type: "file_changed", name: "cell.task", text: TEXT, digest: "t1", tree: TREE });
  assert.equal(source.all("program").length, told);
});
