import assert from "node:assert/strict";
import { test } from "node:test";
import { cycleRows } from "../src/model/cycle.ts";
import { firstChange, lineMap, pairLines } from "../src/model/difference.ts";
import { History } from "../src/model/history.ts";
import { familyOf, hasSlider, inputNames, readValue, shownNames, valueAt } from "../src/model/points.ts";
import { Run } from "../src/model/run.ts";
import type { SignalFamily } from "../src/source/services.ts";

// ---------------------------------------------------------------- differences

const show = (first: string, second: string) =>
  pairLines(first.replaceAll(" ", "\n"), second.replaceAll(" ", "\n")).map((pair) => `${pair.second === null ? "-" : pair.first === null ? "+" : ""}${pair.text}`).join(" ");

for (const [first, second, shown] of [
  ["a b c", "a b c", "a b c"],
  ["a b c", "a x c", "a -b +x c"],
  ["a b c", "b c", "-a b c"],
  ["a", "a b c", "a +b +c"],
  ["a b c d", "a c b d", "a -b c +b d"],
  ["a a a", "a a", "a a -a"],
] as const) {
  test(`"${first}" and "${second}"`, () => assert.equal(show(first, second), shown));
}

test("the numbers of lines are those of both texts", () => {
  assert.deepEqual([...lineMap("a\nb\nc", "x\na\nc")], [[2, 1], [3, 3]]);
  assert.deepEqual([firstChange("a\nb", "a\nb"), firstChange("a\nb", "a\nc"), firstChange("a", "a\nb"), firstChange("a\nb", "a")], [0, 2, 2, 2]);
});

test("texts too different for a search are compared in a moment", () => {
  const text = (word: string) => Array.from({ length: 20_000 }, (_, line) => `${word} ${line}`).join("\n");
  const pairs = pairLines(text("a"), text("b"));
  assert.equal(pairs.length, 40_000);
});

// ---------------------------------------------------------------- cycle time

const row = (line: number, moving_s: number, standing_s = 0) => ({ line, moving_s, standing_s, visits: 1 });

function run(text: string, ...table: ReturnType<typeof row>[]): Run {
  const made = new Run(1, 1, {}, text);
  made.cycle = table;
  return made;
}

test("the longest line is first, with its share", () => {
  const rows = cycleRows(run("a\nb", row(1, 1), row(2, 2, 1)), null, "share");
  assert.deepEqual(rows.map((found) => [found.line, found.share, found.difference]), [[2, 0.75, null], [1, 0.25, null]]);
});

test("lines are compared with the same lines of the other text, wherever they are", () => {
  const before = run("a\nb\nc", row(1, 1), row(2, 2), row(3, 3));
  const rows = cycleRows(run("new\na\nc", row(1, 5), row(2, 1), row(3, 2.5)), before, "line");
  assert.deepEqual(rows.map((found) => [found.line, found.difference, found.before]), [[1, 5, null], [2, 0, 1], [3, -0.5, 3], [0, -2, 2]]);
});

// ---------------------------------------------------------------- signals

const FAMILIES: readonly SignalFamily[] = [
  { name: "standard_digital_in", kind: "bool", size: 2, is_input: true, low: null, high: null, unit: "", default: false, summary: "", is_kept: false },
  { name: "tool_analog_in", kind: "float", size: 1, is_input: true, low: 0, high: 10, unit: "V or A", default: 0, summary: "", is_kept: false },
  { name: "standard_digital_out", kind: "bool", size: 2, is_input: false, low: null, high: null, unit: "", default: false, summary: "", is_kept: false },
  { name: "input_int_register", kind: "int", size: 1, is_input: true, low: -(2 ** 31), high: 2 ** 31 - 1, unit: "", default: 0, summary: "", is_kept: false },
  { name: "encoder_speed", kind: "float", size: 1, is_input: true, low: null, high: null, unit: "1/s", default: 0, summary: "", is_kept: false },
];

test("families, their inputs and sliders", () => {
  assert.equal(familyOf(FAMILIES, "standard_digital_out[1]")?.is_input, false);
  assert.equal(familyOf(FAMILIES, "nothing[1]"), null);
  assert.deepEqual(inputNames(FAMILIES), ["standard_digital_in[0]", "standard_digital_in[1]", "tool_analog_in", "input_int_register", "encoder_speed"]);
  assert.deepEqual(FAMILIES.map(hasSlider), [false, true, false, false, false]);
});

for (const [index, typed, value] of [
  [0, "on", true], [0, "0", false], [0, "2", null], [1, "4.2 V", 4.2], [1, "11", null], [1, "", null], [1, "12 mA", 0.012], [1, "abc", null], [1, "V", null], [1, "4 N", null], [4, "-5 1/s", -5], [3, "0x10", null], [3, "7", 7], [3, "7.5", null], [3, "-8", -8],
] as const) {
  test(`${FAMILIES[index]!.name} takes "${typed}" as ${value}`, () => assert.equal(readValue(FAMILIES[index]!, typed), value));
}

test("a value is that of the exact state, else of the last change, else the default", () => {
  const made = new Run(1, 1, {});
  made.take({ type: "events", run: 1, list: [{ type: "signal", t: 1, name: "standard_digital_out[0]", value: true }, { type: "signal", t: 2, name: "standard_digital_out[0]", value: false }] });
  const at = (t: number) => valueAt("standard_digital_out[0]", t, made, null, FAMILIES);
  assert.deepEqual([at(0.5), at(1), at(1.5), at(2)], [false, true, true, false]);
  const exact = { t: 1.5, line: 1, joints: [0, 0, 0, 0, 0, 0], tcp_pose: [0, 0, 0, 0, 0, 0], globals: [], signals: {}, threads: [] } as const;
  assert.equal(valueAt("standard_digital_out[0]", 1.5, made, exact, FAMILIES), false);
  assert.equal(valueAt("unknown", 1, made, null, FAMILIES), undefined);
  // A recording has no families: off before the first change.
  assert.equal(valueAt("standard_digital_out[0]", 0, made, null, []), false);
});

test("shown are changed, given and chosen signals, inputs first, by their number", () => {
  const made = new Run(1, 1, {});
  made.take({ type: "events", run: 1, list: [{ type: "signal", t: 1, name: "standard_digital_out[10]", value: true }, { type: "signal", t: 1, name: "standard_digital_out[2]", value: true }] });
  const names = shownNames(made, null, { inputs: [{ name: "tool_analog_in", value: 1, at_s: 0 }] }, ["standard_digital_in[1]"], FAMILIES);
  assert.deepEqual(names, ["standard_digital_in[1]", "tool_analog_in", "standard_digital_out[2]", "standard_digital_out[10]"]);
});

// ---------------------------------------------------------------- undo

test("undo and redo; a new value ends what could be redone", () => {
  const history = new History(0);
  for (const value of [1, 2, 3]) history.set(value);
  assert.equal(history.undo() && history.undo() && history.value.value, 1);
  assert.equal(history.redo() && history.value.value, 2);
  history.set(9);
  assert.equal(history.redo(), false);
  assert.equal(history.undo() && history.value.value, 2);
});

test("values with one key in a row are one step, but not across an undo", () => {
  const history = new History(0);
  for (const value of [1, 2, 3]) history.set(value, "slider");
  history.undo();
  assert.equal(history.value.value, 0);
  history.set(4, "slider");
  history.undo();
  assert.equal(history.value.value, 0);
});
