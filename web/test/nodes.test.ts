/** What graphical programs are made of, in both languages; what they say themselves stays as it is. */

import assert from "node:assert/strict";
import { test } from "node:test";
import { chosenLanguage } from "../src/text/language.ts";
import { kindOf, summaryOf } from "../src/text/nodes.ts";

test("kinds and words are in the language of the page, statements and values as they are written", () => {
  assert.equal(kindOf("Waypoint"), "Waypoint");
  assert.equal(summaryOf("3 times"), "3 times");
  chosenLanguage.value = "zh";
  try {
    assert.equal(kindOf("Waypoint"), "路点");
    assert.equal(kindOf("MoveJ"), "MoveJ");
    assert.equal(summaryOf("3 times"), "3 次");
    assert.equal(summaryOf("joints [0.1, 0.2], blend 0.05 m"), "关节 [0.1, 0.2]，交融 0.05 m");
    assert.equal(summaryOf("box_held is high, at most 2 s"), "box_held 为高，最多 2 s");
    assert.equal(summaryOf('textmsg("once", a, b)'), 'textmsg("once", a, b)');
  } finally {
    chosenLanguage.value = null;
  }
});
