import assert from "node:assert/strict";
import { test } from "node:test";
import { PALETTES, type Palette } from "../src/style/palette.ts";
import { en, type Texts } from "../src/text/en.ts";
import { zh } from "../src/text/zh.ts";

function luminance(colour: string): number {
  const [r, g, b] = [1, 3, 5].map((at) => {
    const part = parseInt(colour.slice(at, at + 2), 16) / 255;
    return part <= 0.04045 ? part / 12.92 : ((part + 0.055) / 1.055) ** 2.4;
  });
  return 0.2126 * r! + 0.7152 * g! + 0.0722 * b!;
}

function contrast(first: string, second: string): number {
  const [low, high] = [luminance(first), luminance(second)].sort((a, b) => a - b);
  return (high! + 0.05) / (low! + 0.05);
}

test("black on white is 21 to 1", () => assert.ok(Math.abs(contrast("#000000", "#ffffff") - 21) < 1e-9));

const TEXTS = ["ink", "faint", "stale", "accent", "error", "warning", "good"] as const;
const GROUNDS = ["panel", "raised", "hovered"] as const;
const ON: readonly (readonly [keyof Palette, keyof Palette, number])[] = [
  ["on_accent", "accent", 4.5], ["error", "error_ground", 4.5], ["warning", "warning_ground", 4.5], ["good", "good_ground", 4.5],
  ["ink", "chosen", 4.5], ["faint", "chosen", 4.5], ["ink", "warning_ground", 4.5],
  ["focus", "panel", 3], ["focus", "ground", 3], ["edge", "panel", 3], ["edge", "raised", 3], ["cursor", "panel", 3], ["hover", "panel", 3],
];

for (const [name, palette] of Object.entries(PALETTES)) {
  test(`contrast of the ${name} colours`, () => {
    const pairs = [...ON, ...TEXTS.flatMap((ink) => GROUNDS.map((ground) => [ink, ground, 4.5] as const))];
    for (const [ink, ground, least] of pairs) {
      const found = contrast(palette[ink] as string, palette[ground] as string);
      assert.ok(found >= least, `${ink} on ${ground}: ${found.toFixed(2)}`);
    }
    for (const joint of palette.joints) assert.ok(contrast(joint, palette.panel) >= 4.5, `joint ${joint}`);
  });
}

test("texts of both languages have the same places for values, and none is empty", () => {
  const places = (text: string) => [...text.matchAll(/\{\w+\}/g)].map(String).sort();
  for (const key of Object.keys(en) as (keyof Texts)[]) {
    assert.deepEqual(places(zh[key]), places(en[key]), key);
    assert.ok(zh[key] !== "" && en[key] !== "", key);
  }
});
