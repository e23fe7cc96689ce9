/**
 * Units: what people type into SI values, and SI values into what people read. Inside, everything is SI: rad, m, s, N.
 */

import { text } from "../text/text.ts";

export interface Display {
  readonly angle: "rad" | "deg";
  readonly length: "m" | "mm";
}

export type Quantity = "angle" | "length" | "time" | "speed" | "angular_speed" | "voltage" | "current" | "force" | "torque" | "plain";

const DEGREE = Math.PI / 180;

/** Factor to SI by unit; the first of a quantity is taken where none is typed, but for angles and lengths the one shown. */
const FACTORS: { readonly [quantity in Quantity]: { readonly [unit: string]: number } } = {
  angle: { rad: 1, deg: DEGREE, "°": DEGREE },
  length: { m: 1, cm: 1e-2, mm: 1e-3, um: 1e-6, "µm": 1e-6, in: 0.0254 },
  time: { s: 1, ms: 1e-3, min: 60, h: 3600 },
  speed: { "m/s": 1, "mm/s": 1e-3, "cm/s": 1e-2, "m/min": 1 / 60, "mm/min": 1e-3 / 60 },
  angular_speed: { "rad/s": 1, "deg/s": DEGREE, "°/s": DEGREE },
  voltage: { V: 1, mV: 1e-3 },
  current: { A: 1, mA: 1e-3 },
  force: { N: 1, kN: 1e3 },
  torque: { "N m": 1, Nm: 1 },
  plain: { "": 1, "%": 1e-2 },
};

const NUMBER = /^\s*([+-]?(?:\d+(?:\.\d*)?|\.\d+)(?:e[+-]?\d+)?)\s*(.*?)\s*$/i;

/** A typed value that is no value; `message` says why, for people. */
export class UnitError extends Error {}

/** Returns what was typed, in SI: `90 deg`, `250 mm/s`, `1.2`. Throws a UnitError. */
export function parse(typed: string, quantity: Quantity, display?: Display): number {
  const found = NUMBER.exec(typed);
  if (found === null) throw new UnitError(text("unit_no_number", { typed: typed.trim() }));
  const factors = FACTORS[quantity];
  const unit = found[2]! || unitOf(quantity, display);
  const factor = Object.entries(factors).find(([name]) => name === unit || name.toLowerCase() === unit.toLowerCase())?.[1];
  if (factor === undefined) throw new UnitError(text("unit_unknown", { unit, units: Object.keys(factors).filter(Boolean).join(", ") }));
  const value = Number(found[1]) * factor;
  // JSON has no infinity.
  if (!Number.isFinite(value)) throw new UnitError(text("unit_no_number", { typed: typed.trim() }));
  return value;
}

/** Returns the values of a list: `0, -90 deg, 90 deg, ...`; a unit counts for the values before it that have none. */
export function parseList(typed: string, quantity: Quantity, display?: Display): number[] {
  const parts = typed.trim().replace(/^\[|\]$/g, "").split(/[,;]/);
  const unit = parts.map((part) => NUMBER.exec(part)?.[2] ?? "").filter(Boolean).at(-1) ?? "";
  return parts.map((part) => parse(NUMBER.exec(part)?.[2] ? part : `${part} ${unit}`, quantity, display));
}

/** The unit in which a quantity is shown. */
export function unitOf(quantity: Quantity, display: Display = { angle: "rad", length: "m" }): string {
  switch (quantity) {
    case "angle":
      return display.angle;
    case "angular_speed":
      return `${display.angle}/s`;
    case "length":
      return display.length;
    case "speed":
      return `${display.length}/s`;
    default:
      return Object.keys(FACTORS[quantity])[0]!;
  }
}

/** Decimals that show 0.001 deg, 0.01 mm and 1 ms, which is finer than any arm moves. */
const DECIMALS: { readonly [unit: string]: number } = { rad: 4, "rad/s": 3, deg: 2, "deg/s": 2, m: 4, "m/s": 3, mm: 1, "mm/s": 1, s: 3, V: 2, A: 4, N: 1, "N m": 2 };

/** Returns a value in the unit of the display, without the unit: `-90.00`. NaN and infinities as in JSON. */
export function format(value: number, quantity: Quantity, display?: Display): string {
  if (!Number.isFinite(value)) return String(value);
  const unit = unitOf(quantity, display);
  const shown = (value / FACTORS[quantity][unit]!).toFixed(DECIMALS[unit] ?? 3);
  return /^-0\.?0*$/.test(shown) ? shown.slice(1) : shown;
}

/** Returns a value with its unit: `-90.00 deg`. */
export function withUnit(value: number, quantity: Quantity, display?: Display): string {
  return `${format(value, quantity, display)} ${unitOf(quantity, display)}`.trim();
}

/** Returns a time as all regions show it: `3.204 s`. */
export function seconds(t: number): string {
  return `${format(t, "time")} s`;
}

/** Returns a number of bytes with its unit. */
export function size(bytes: number): string {
  for (const [unit, of] of [["GB", 1e9], ["MB", 1e6], ["kB", 1e3]] as const) if (bytes >= of) return `${(bytes / of).toPrecision(3)} ${unit}`;
  return `${bytes} B`;
}
