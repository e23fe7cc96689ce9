import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { PHRASES } from "../src/text/phrases.ts";

test("each phrase of the editor's packages has a row", () => {
  const found = new Set<string>();
  for (const name of ["search", "language", "lint", "autocomplete", "view", "commands"]) {
    const code = readFileSync(new URL(`../node_modules/@codemirror/${name}/dist/index.js`, import.meta.url), "utf8");
    for (const [, call] of code.matchAll(/phrase\(([^)]{0,80})/g)) for (const [, words] of call!.matchAll(/"([^"]+)"/g)) found.add(words!);
  }
  assert.ok(found.size > 20);
  assert.deepEqual([...found].filter((words) => !(words in PHRASES)), []);
});
