/** Signals: which there are, and their values at a time. */

import type { Moment, RunOptions, Value } from "../source/messages.ts";
import type { SignalFamily } from "../source/services.ts";
import { lastAtOrBefore, type Run } from "./run.ts";
import { parse, UnitError, type Quantity } from "./units.ts";

/** What the units of families are units of. */
const QUANTITIES: { readonly [unit: string]: Quantity } = { V: "voltage", A: "current", N: "force", "N m": "torque" };

/** The family of a signal: that whose name is before the index. */
export function familyOf(families: readonly SignalFamily[], name: string): SignalFamily | null {
  const stem = name.replace(/\[\d+\]$/, "");
  return families.find((family) => family.name === stem) ?? null;
}

/** Names of all signals that take values from outside. */
export function inputNames(families: readonly SignalFamily[]): string[] {
  return families.filter((family) => family.is_input).flatMap((family) =>
    family.size === 1 ? [family.name] : Array.from({ length: family.size }, (_, index) => `${family.name}[${index}]`));
}

/** A range with a slider: of what has two ends that are not those of the number format. */
export function hasSlider(family: SignalFamily): boolean {
  return family.low !== null && family.high !== null && family.high - family.low <= 1000;
}

/** Reads a typed value; null if the family takes none like it. */
export function readValue(family: SignalFamily, typed: string): Value | null {
  const said = typed.trim().toLowerCase();
  if (family.kind === "bool") return ["true", "on", "1"].includes(said) ? true : ["false", "off", "0"].includes(said) ? false : null;
  const value = readNumber(typed.trim(), family.unit.split(/, | or /));
  if (value === null || (family.kind === "int" && !Number.isInteger(value))) return null;
  return (family.low !== null && value < family.low) || (family.high !== null && value > family.high) ? null : value;
}

/** Reads a number in one of the units, such as `12 mA` in V or A; null if it is none. */
function readNumber(typed: string, units: readonly string[]): number | null {
  for (const unit of units) {
    try {
      const quantity = QUANTITIES[unit];
      return parse(quantity === undefined && typed.endsWith(` ${unit}`) ? typed.slice(0, -unit.length) : typed, quantity ?? "plain");
    } catch (error) {
      if (!(error instanceof UnitError)) throw error;
    }
  }
  return null;
}

/** The value of a signal at a time: of the exact state if it is given, else as the run's changes say; undefined: not known. */
export function valueAt(name: string, t: number, run: Run | null, exact: Moment | null, families: readonly SignalFamily[]): Value | undefined {
  const changes = run?.signals.get(name);
  // A recording has no list of families; all defaults are off and 0.
  const initial = familyOf(families, name)?.default ?? (changes === undefined ? undefined : zeroOf(changes.value[0]));
  if (exact !== null) return exact.signals[name] ?? initial;
  const index = changes === undefined ? -1 : lastAtOrBefore(changes.t, t);
  return index >= 0 ? changes!.value[index] : initial;
}

function zeroOf(value: Value | undefined): Value | undefined {
  return typeof value === "boolean" ? false : typeof value === "number" ? 0 : undefined;
}

/** Names to show: what changed in the run, is not at its default now, or is given from outside; inputs first, then as in the list of families. */
export function shownNames(run: Run | null, moment: Moment | null, options: RunOptions, pinned: readonly string[], families: readonly SignalFamily[]): string[] {
  const names = new Set([...(run?.signals.keys() ?? []), ...Object.keys(moment?.signals ?? {}), ...(options.inputs ?? []).map((input) => input.name), ...pinned]);
  const rank = (name: string) => {
    const index = families.findIndex((family) => family.name === name.replace(/\[\d+\]$/, ""));
    return (index >= 0 && families[index]!.is_input ? 0 : 1000) + (index < 0 ? 999 : index);
  };
  const point = (name: string) => Number(/\[(\d+)\]$/.exec(name)?.[1] ?? 0);
  return [...names].sort((a, b) => rank(a) - rank(b) || point(a) - point(b) || a.localeCompare(b));
}
