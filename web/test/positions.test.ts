import assert from "node:assert/strict";
import { test } from "node:test";
import { Text } from "@codemirror/state";
import { offsetOf, placeOf, rangeOf } from "../src/regions/program/positions.ts";

const TEXT = Text.of(["a = 1", 'textmsg("😀é", a)', ""]);

test("columns count characters, offsets count UTF-16 units", () => {
  assert.equal(offsetOf(TEXT, { line: 1, column: 1 }), 0);
  assert.equal(offsetOf(TEXT, { line: 2, column: 10 }), 6 + 9); // at the emoji
  assert.equal(offsetOf(TEXT, { line: 2, column: 11 }), 6 + 11); // behind it
  assert.deepEqual(placeOf(TEXT, 6 + 11), { line: 2, column: 11 });
});

test("every offset between characters comes back", () => {
  for (let line = 1; line <= TEXT.lines; line++) {
    const points = [...TEXT.line(line).text].length;
    for (let column = 1; column <= points + 1; column++) {
      assert.deepEqual(placeOf(TEXT, offsetOf(TEXT, { line, column })), { line, column });
    }
  }
});

test("places outside of the text become the nearest inside", () => {
  assert.equal(offsetOf(TEXT, { line: 0, column: 5 }), 0);
  assert.equal(offsetOf(TEXT, { line: 1, column: 99 }), 5);
  assert.equal(offsetOf(TEXT, { line: 9, column: 1 }), TEXT.length);
  assert.deepEqual(rangeOf(TEXT, { line: 2, column: 3, end_line: 1, end_column: 1 }), { from: 8, to: 8 });
});
