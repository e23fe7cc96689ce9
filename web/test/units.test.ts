import assert from "node:assert/strict";
import { test } from "node:test";
import { format, parse, parseList, seconds, UnitError, withUnit, type Display, type Quantity } from "../src/model/units.ts";

const SHOWN: Display = { angle: "deg", length: "mm" };

const TYPED: readonly (readonly [string, Quantity, number])[] = [
  ["90 deg", "angle", Math.PI / 2],
  ["90°", "angle", Math.PI / 2],
  ["1.5 rad", "angle", 1.5],
  ["250 mm/s", "speed", 0.25],
  ["0.25 m/s", "speed", 0.25],
  ["60 mm/min", "speed", 0.001],
  ["-12.5mm", "length", -0.0125],
  ["2 min", "time", 120],
  ["  120 S ", "time", 120],
  ["1e-3", "time", 0.001],
  [".5", "plain", 0.5],
  ["12 mA", "current", 0.012],
  ["50 %", "plain", 0.5],
];

for (const [typed, quantity, value] of TYPED) {
  test(`"${typed}" is ${value} as ${quantity}`, () => assert.ok(Math.abs(parse(typed, quantity) - value) < 1e-12));
}

test("without a unit the shown one counts", () => {
  assert.ok(Math.abs(parse("90", "angle", SHOWN) - Math.PI / 2) < 1e-12);
  assert.equal(parse("90", "angle"), 90);
  assert.equal(parse("250", "length", SHOWN), 0.25);
});

for (const [typed, quantity] of [["", "time"], ["abc", "time"], ["1,5", "time"], ["3 kg", "time"], ["0x10", "plain"], ["90 deg", "length"]] as const) {
  test(`"${typed}" is no ${quantity}`, () => assert.throws(() => parse(typed, quantity), UnitError));
}

test("a unit at the end of a list counts for all of it", () => {
  const values = parseList("0, -90, 90 deg", "angle");
  assert.ok(values.every((value, index) => Math.abs(value - [0, -Math.PI / 2, Math.PI / 2][index]!) < 1e-12));
  assert.deepEqual(parseList("[0.1, 0.2]", "length"), [0.1, 0.2]);
});

test("what is shown", () => {
  assert.equal(withUnit(-Math.PI / 2, "angle", SHOWN), "-90.00 deg");
  assert.equal(withUnit(0.25, "speed", SHOWN), "250.0 mm/s");
  assert.equal(format(-1e-9, "angle", SHOWN), "0.00");
  assert.equal(format(NaN, "length"), "NaN");
  assert.equal(format(-Infinity, "length"), "-Infinity");
  assert.equal(seconds(3.2041), "3.204 s");
});
