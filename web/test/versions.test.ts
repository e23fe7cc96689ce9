import assert from "node:assert/strict";
import { test } from "node:test";
import { EditorState } from "@codemirror/state";
import { Versions } from "../src/regions/program/versions.ts";

function edited(...edits: readonly { from: number; to?: number; insert: string }[]) {
  let state = EditorState.create({ doc: "one\n  two\nthree\nfour" });
  const versions = new Versions();
  versions.begin(1, state.doc);
  for (const edit of edits) {
    const change = state.update({ changes: edit });
    versions.changed(change.changes);
    state = change.state;
  }
  return { versions, text: state.doc };
}

test("lines below an inserted line move down", () => {
  const { versions, text } = edited({ from: 4, insert: "new\n" });
  assert.deepEqual([1, 2, 3, 4].map((line) => versions.now(1, line, text)), [1, 3, 4, 5]);
  assert.deepEqual([1, 2, 3, 4, 5].map((line) => versions.then(1, line, text)), [1, 0, 2, 3, 4]);
});

test("a deleted line is nowhere", () => {
  const { versions, text } = edited({ from: 4, to: 10, insert: "" });
  assert.deepEqual([1, 2, 3, 4].map((line) => versions.now(1, line, text)), [1, 0, 2, 3]);
  assert.deepEqual([1, 2, 3].map((line) => versions.then(1, line, text)), [1, 3, 4]);
});

test("typing inside a line keeps it", () => {
  const { versions, text } = edited({ from: 7, insert: "x" }, { from: 0, insert: "y" });
  assert.deepEqual([1, 2, 3, 4].map((line) => versions.now(1, line, text)), [1, 2, 3, 4]);
  assert.deepEqual([1, 2, 3, 4].map((line) => versions.then(1, line, text)), [1, 2, 3, 4]);
});

test("versions and lines that are not known are nowhere", () => {
  const { versions, text } = edited();
  assert.equal(versions.now(0, 1, text), 0);
  assert.equal(versions.now(1, 9, text), 0);
  assert.equal(versions.then(1, 0, text), 0);
});

test("a version that options have raised has the text in front of it", () => {
  const { versions, text } = edited({ from: 4, insert: "new\n" });
  versions.begin(5, text);
  assert.deepEqual([2, 3, 4].map((version) => versions.now(version, 2, text)), [3, 3, 3]);
  assert.equal(versions.now(6, 2, text), 2);
});

test("the text of a run is known however many follow that do not run", () => {
  const { versions, text } = edited({ from: 4, insert: "new\n" });
  for (let version = 2; version < 400; version++) versions.begin(version, text);
  assert.equal(versions.now(1, 2, text), 3);
  versions.forget(300);
  assert.equal(versions.now(299, 2, text), 0);
  assert.equal(versions.now(300, 2, text), 2);
});

test("texts are kept up to a number of characters", () => {
  const versions = new Versions();
  const large = EditorState.create({ doc: "x".repeat(10_000_000) }).doc;
  for (let version = 1; version <= 20; version++) versions.begin(version, large);
  assert.equal(versions.count, 6);
  assert.equal(versions.now(20, 1, large), 1);
  assert.equal(versions.now(14, 1, large), 0);
  versions.forget(20);
  for (let version = 21; version <= 25; version++) versions.begin(version, large);
  assert.equal(versions.count, 6);
});
