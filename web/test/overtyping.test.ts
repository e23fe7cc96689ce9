import assert from "node:assert/strict";
import { test } from "node:test";
import { EditorState } from "@codemirror/state";
import { overtyped, remembered } from "../src/regions/program/overtyping.ts";

/** Returns a text after what the editor has put in at `|` (a new line with its indentation, `end`s of the services) and characters typed behind it. */
function typed(text: string, newLine: string, served: string, characters: string): string {
  const at = text.indexOf("|");
  let state = EditorState.create({ doc: text.replace("|", ""), selection: { anchor: at }, extensions: [remembered] });
  state = state.update({ changes: { from: at, insert: newLine }, selection: { anchor: at + newLine.length }, userEvent: "input" }).state;
  const caret = state.selection.main.head;
  if (served !== "") state = state.update({ changes: { from: caret, insert: served }, selection: { anchor: caret }, userEvent: "input.service" }).state;
  for (const character of characters) {
    const head = state.selection.main.head;
    const insert = { changes: { from: head, insert: character }, selection: { anchor: head + 1 }, userEvent: "input.type" };
    state = state.update(overtyped(state, head, character) ?? insert).state;
  }
  const { head } = state.selection.main;
  return `${state.sliceDoc(0, head)}|${state.sliceDoc(head)}`;
}

test("blanks that are typed where the editor has indented are not doubled", () => {
  assert.equal(typed("def f():|", "\n  ", "", "  x"), "def f():\n  x|");
  assert.equal(typed("def f():|", "\n  ", "\nend", "  x"), "def f():\n  x|\nend");
  assert.equal(typed("def f():|", "\n  ", "", "    x"), "def f():\n    x|");
});

test("a smaller indentation is taken if a block around has it, else it is a slip", () => {
  assert.equal(typed("def f():\n  while a:\n    b()|", "\n    ", "", "  x"), "def f():\n  while a:\n    b()\n  x|");
  assert.equal(typed("def f():\n  while a:\n    b()|", "\n    ", "", " x"), "def f():\n  while a:\n    b()\n    x|");
});

test("an end that came with its block is stepped over when it is typed", () => {
  assert.equal(typed("def f():|", "\n", "\nend", "end"), "def f():\nend|");
  assert.equal(typed("def f():\n  a()|", "\n", "\nend", "end"), "def f():\n  a()\nend|");
});

test("an end of an inner block is not taken for that of the outer one", () => {
  assert.equal(typed("def f():\n  while a:\n    b()|", "\n  ", "\nend", "end"), "def f():\n  while a:\n    b()\n  end|\nend");
  const closed = "def f():\n  while a:\n    b()\n  end|";
  assert.equal(typed(closed, "\n", "\nend", "end"), "def f():\n  while a:\n    b()\n  end\nend|");
});

test("an end that a person has written is kept", () => {
  assert.equal(typed("while a:\n  b()|\nend", "\n", "", "end"), "while a:\n  b()\nend|\nend");
});

test("a closing bracket in the next line is stepped over", () => {
  assert.equal(typed("  a = [\n    1,|\n  ]", "\n    ", "", "  ]"), "  a = [\n    1,\n  ]|");
  assert.equal(typed("  a = [\n    1,|\n         ]", "\n    ", "", "]"), "  a = [\n    1,\n  ]|");
  assert.equal(typed("a = [\n  (1,|\n]", "\n  ", "", ")"), "a = [\n  (1,\n  )|\n]");
});
