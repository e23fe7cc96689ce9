/** What the plots are made of: bins, ranges, the point under the pointer. Pure. */

import type { Column, Sweep } from "./data.ts";

/** A column of numbers, with what its axis shows. */
export interface Axis {
  readonly column: Column;
  readonly least: number;
  readonly most: number;
}

export function axisOf(column: Column): Axis {
  if (column.labels !== null) return { column, least: -0.5, most: column.labels.length - 0.5 };
  let least = Infinity;
  let most = -Infinity;
  for (const value of column.values) {
    if (!Number.isFinite(value)) continue;
    if (value < least) least = value;
    if (value > most) most = value;
  }
  if (least > most) return { column, least: 0, most: 1 };
  const room = (most - least) * 0.03 || Math.abs(least) * 0.01 || 0.5;
  return { column, least: least - room, most: most + room };
}

export interface Bins {
  /** Lower edges, and the last upper one. */
  readonly edges: readonly number[];
  readonly holding: readonly number[];
  readonly failing: readonly number[];
}

/** Counts shown rows in about `count` bins whose edges are round numbers; labels have one each. Counts are of all runs, by the share that is shown. */
export function binned(sweep: Sweep, column: Column, count = 40): Bins {
  const kinds = kindsOf(sweep);
  const { first, step, many } = column.labels === null ? roundBins(axisBounds(column), count) : { first: -0.5, step: 1, many: column.labels.length };
  const holding = new Array<number>(many).fill(0);
  const failing = new Array<number>(many).fill(0);
  for (let row = 0; row < sweep.rows; row++) {
    const value = column.values[row]!;
    if (!Number.isFinite(value)) continue;
    const bin = Math.min(Math.max(Math.floor((value - first) / step), 0), many - 1);
    if (kinds[row]! < 0) holding[bin]! += sweep.holding[1];
    else failing[bin]! += sweep.failing[1];
  }
  return { edges: Array.from({ length: many + 1 }, (_, index) => first + index * step), holding, failing };
}

function axisBounds(column: Column): readonly [number, number] {
  let least = Infinity;
  let most = -Infinity;
  for (const value of column.values) {
    if (!Number.isFinite(value)) continue;
    if (value < least) least = value;
    if (value > most) most = value;
  }
  return least > most ? [0, 1] : [least, most];
}

/** Bins of 1, 2 or 5 times a power of ten that hold everything between two numbers. */
export function roundBins([least, most]: readonly [number, number], count: number): { readonly first: number; readonly step: number; readonly many: number } {
  const width = (most - least) / count;
  // A difference that 32 bits cannot tell is none.
  if (!(width > Math.abs(most) * 1e-7)) {
    const step = Math.abs(least) * 0.01 || 1;
    return { first: least - step / 2, step, many: 1 };
  }
  const power = 10 ** Math.floor(Math.log10(width));
  const step = [1, 2, 5, 10].map((times) => times * power).find((found) => found >= width * (1 - 1e-9))!;
  const first = Math.floor(least / step) * step;
  return { first, step, many: Math.floor((most - first) / step) + 1 };
}

export function kindsOf(sweep: Sweep): Column["values"] {
  return sweep.columns.find(({ role }) => role === "kind")!.values;
}

export function runsOf(sweep: Sweep): Column["values"] {
  return sweep.columns.find(({ role }) => role === "run")!.values;
}

/** The row nearest to a place in pixels, at most `reach` away; -1: none. Of several, failing ones come first. */
export function nearestRow(x: ArrayLike<number>, y: ArrayLike<number>, kinds: ArrayLike<number>, at: readonly [number, number], reach = 24): number {
  let found = -1;
  let least = reach * reach;
  for (let row = 0; row < x.length; row++) {
    const dx = x[row]! - at[0];
    const dy = y[row]! - at[1];
    const distance = dx * dx + dy * dy - (kinds[row]! < 0 ? 0 : 16);
    if (distance < least) {
      least = distance;
      found = row;
    }
  }
  return found;
}

/** A number as people read it: four digits, or six of large ones. */
export function shown(value: number): string {
  if (!Number.isFinite(value)) return Number.isNaN(value) ? "–" : value > 0 ? "∞" : "−∞";
  const digits = Math.abs(value) < 1e4 ? 4 : 6;
  return String(Number(value.toPrecision(digits)));
}

/** A value of a column in a row. */
export function shownValue(column: Column, row: number): string {
  const value = column.values[row]!;
  return column.labels === null ? shown(value) : column.labels[value] ?? "–";
}

/** Where labels lie that are drawn apart, so that equal points do not hide each other: the same for the same row. */
export function spread(row: number, salt: number): number {
  const bits = Math.imul(row ^ salt, 0x9e3779b1) >>> 0;
  return (((bits ^ (bits >>> 15)) % 1000) / 1000 - 0.5) * 0.6;
}
