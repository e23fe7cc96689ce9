import assert from "node:assert/strict";
import { test } from "node:test";
import { EditorState } from "@codemirror/state";
import { ownSnippet, typedEdits } from "../src/regions/program/assistance.ts";

function after(text: string, caret: number, edits: Parameters<typeof typedEdits>[1]) {
  const state = EditorState.create({ doc: text });
  const changed = state.update(typedEdits(state.doc, edits, caret)).state;
  return [changed.doc.toString(), changed.selection.main.head];
}

test("the caret stays in front of an end that is put below", () => {
  const edit = { line: 2, column: 1, end_line: 2, end_column: 1, text: "  \nend" };
  assert.deepEqual(after("def f():\n", 9, [edit]), ["def f():\n  \nend", 11]);
  const wider = { line: 2, column: 1, end_line: 2, end_column: 3, text: "  \nend" };
  assert.deepEqual(after("def f():\n  ", 11, [wider]), ["def f():\n  \nend", 11]);
});

test("the caret moves with the indentation of its line", () => {
  const edit = { line: 2, column: 1, end_line: 2, end_column: 5, text: "  " };
  assert.deepEqual(after("if a:\n    end", 13, [edit]), ["if a:\n  end", 11]);
});

test("snippets of other editors become those of this one", () => {
  assert.equal(ownSnippet("movej(${1:q})$0"), "movej(${1:q})${}");
  assert.equal(ownSnippet('set_tool_voltage(${1|0,12,24|})'), "set_tool_voltage(${1:0})");
});
