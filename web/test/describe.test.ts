import assert from "node:assert/strict";
import { test } from "node:test";
import { entryText } from "../src/regions/timeline/describe.ts";
import { chosenLanguage } from "../src/text/language.ts";

const entry = (device: string, text: string) => {
  const event = { type: "device", t: 1, device, text };
  return { t: 1, kind: "device", line: 0, thread: "", text: `${device}: ${text}`, event };
};

test("what a fault reports is said in the language of the page", () => {
  chosenLanguage.value = "en";
  assert.equal(entryText(entry("fault", "delay on port 5000 acts")), "fault: delay on port 5000 acts");
  chosenLanguage.value = "zh";
  assert.equal(entryText(entry("fault", "delay on port 5000 acts")), "故障: 端口 5000 上的 delay 生效");
  assert.equal(entryText(entry("fault", "drop on plant acts")), "故障: plant 上的 drop 生效");
});

test("words of other devices stay", () => {
  chosenLanguage.value = "zh";
  assert.equal(entryText(entry("camera", "delay on port 5000 acts")), "camera: delay on port 5000 acts");
});
