import assert from "node:assert/strict";
import { test } from "node:test";
import { runState } from "../src/app/state.ts";
import { countsOf, findingsOf } from "../src/model/findings.ts";
import { began, moment, NO_ALARM_PARTS, NO_PARTS, opened } from "./fake.ts";

test("a name that is not defined is one row, which counts as an error", () => {
  const { source, studio } = opened();
  const place = { ...NO_PARTS, column: 1, end_line: 2, end_column: 2, hint: "" };
  const cause = { ...place, severity: "warning", code: "W201", text: "the name `a` is not defined", line: 2 } as const;
  const other = { ...cause, text: "the name `b` is not defined" };
  const version = studio.version.value;
  source.say({ type: "problems", version, list: [cause, other], compiles: true }, began(1, version));
  assert.deepEqual(countsOf(findingsOf(studio)), { errors: 0, warnings: 2, others: 0 });
  const alarm = { ...NO_ALARM_PARTS, t: 0, line: 2, column: 1, code: "R100", text: "name 'a' is not defined", hints: [] };
  source.say({ type: "run_ended", run: 1, state: "alarm", moment: moment(0, 2), alarm });
  const found = findingsOf(studio);
  assert.equal(found.cause, cause);
  assert.deepEqual(found.list, [other]);
  assert.deepEqual(countsOf(found), { errors: 1, warnings: 1, others: 0 });
});

test("findings that are left out are counted", () => {
  const { source, studio } = opened();
  const version = studio.version.value;
  const one = { ...NO_PARTS, severity: "error", code: "E301", text: "a", hint: "", line: 1, column: 1, end_line: 1, end_column: 2 } as const;
  source.say({ type: "problems", version, list: [one], compiles: false, left_out: { error: 4, warning: 2, hint: 1 } });
  assert.deepEqual(countsOf(findingsOf(studio)), { errors: 5, warnings: 2, others: 1 });
});

test("an end with errors or warnings does not look good; one with notes does", () => {
  const found = { ...NO_PARTS, code: "W280", line: 4, t: 0.1, count: 1, text: "a", hint: "" };
  for (const [severity, kind, words] of [
    [null, "good", "finished in 2.0 s"],
    ["information", "good", "finished in 2.0 s, 1 hint"],
    ["warning", "warning", "finished in 2.0 s, 1 warning"],
    ["error", "error", "finished in 2.0 s, 1 error"],
  ] as const) {
    const { source, studio } = opened();
    const version = studio.version.value;
    source.say({ type: "problems", version, list: [], compiles: true }, began(1, version));
    source.say({ type: "run_ended", run: 1, state: "finished", moment: moment(2), ...(severity === null ? {} : { findings: [{ ...found, severity }] }) });
    assert.deepEqual([runState(studio).kind, runState(studio).text], [kind, words]);
  }
});
