import assert from "node:assert/strict";
import { test } from "node:test";

import { inlineParts } from "../src/regions/program/markdown.ts";

const shown = (source: string) => inlineParts(source).map((part) => [part.kind, part.text]);

test("marks of ours are shown", () => {
  assert.deepEqual(shown("**`movej`** takes *rad* and `a*b` of [a page](x.md#y)."), [
    ["strong", "`movej`"],
    ["text", " takes "],
    ["em", "rad"],
    ["text", " and "],
    ["code", "a*b"],
    ["text", " of a page."],
  ]);
});

test("what stands behind a backslash is a letter", () => {
  const source = String.raw`\[run\](command:a.b) \<img\> \*\*b\*\* \`code\` www\.a.b c\@d http\://x \&amp; \~\~x\~\~ \_y\_`;
  assert.deepEqual(shown(source), [["text", "[run](command:a.b) <img> **b** `code` www.a.b c@d http://x &amp; ~~x~~ _y_"]]);
});

test("code in two marks holds one", () => {
  assert.deepEqual(shown("In the last run at last: `` `x` `` and ``a`b``"), [
    ["text", "In the last run at last: "],
    ["code", "`x`"],
    ["text", " and "],
    ["code", "a`b"],
  ]);
});
