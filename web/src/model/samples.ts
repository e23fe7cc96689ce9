/**
 * Samples of a run by time: columns of rows, finer where they were asked for.
 *
 * Columns are typed arrays with room to grow, so rows at the end cost only themselves; rows in between move what is
 * after them. Speeds and accelerations between rows follow from positions and speeds of both (cubic Hermite).
 */

import { COLUMNS, type Column, type Rows } from "../source/rows.ts";
import type { Six } from "../source/messages.ts";

const TICKS_PER_S = 250;
const ROOM_LEAST = 256;

/** Columns that follow from others: changes of `qd` by time, and target less actual joints. */
export type Derived = "qdd1" | "qdd2" | "qdd3" | "qdd4" | "qdd5" | "qdd6" | "error1" | "error2" | "error3" | "error4" | "error5" | "error6";

/** Points of curves: one list of times, and values of each curve at them. */
export interface Curves {
  readonly t: Float64Array;
  readonly values: readonly Float64Array[];
}

export class SampleTable {
  private size = 0;
  private ticks = new Int32Array(0);
  private times = new Float64Array(0);
  private readonly data = new Map<Column, Float64Array>();
  private readonly derived = new Map<Derived, { values: Float64Array; valid: number }>();

  get length(): number {
    return this.size;
  }

  /** Times of the rows, s, ascending. A view: it is valid until rows are added. */
  get t(): Float64Array {
    return this.times.subarray(0, this.size);
  }

  get end_s(): number {
    return this.size === 0 ? 0 : this.times[this.size - 1]!;
  }

  has(name: Column): boolean {
    return this.data.has(name);
  }

  /** Values of a column, one for each time; NaN where a row does not have it. A view: it is valid until rows are added. */
  column(name: Column | Derived): Float64Array {
    if (isDerived(name)) return this.derive(name);
    return this.data.get(name)?.subarray(0, this.size) ?? new Float64Array(this.size).fill(NaN);
  }

  /** Adds rows; of two at one time the newer one counts, as far as it has columns. */
  add(rows: Rows): void {
    const { ticks } = rows;
    if (ticks.length === 0) return;
    for (const name of rows.columns.keys()) {
      if (name !== "tick" && !this.data.has(name)) this.data.set(name, new Float64Array(this.times.length).fill(NaN));
    }
    const low = this.rowAtOrAfter(ticks[0]!);
    const high = this.rowAtOrAfter(ticks[ticks.length - 1]! + 1);
    const plan = merged(this.ticks.subarray(low, high), ticks);
    const grown = this.size - (high - low) + plan.length;
    this.reserve(grown);
    this.place(this.ticks, low, high, plan, ticks);
    for (const [name, values] of this.data) this.place(values, low, high, plan, rows.columns.get(name), NaN);
    this.times.copyWithin(low + plan.length, high, this.size);
    for (let row = low; row < low + plan.length; row++) this.times[row] = this.ticks[row]! / TICKS_PER_S;
    this.size = grown;
    for (const entry of this.derived.values()) entry.valid = Math.min(entry.valid, low);
  }

  /** Takes the rows of another table up to a time, s, in place of its own. */
  begin(other: SampleTable, until_s: number): void {
    const rows = other.index(until_s) + 1;
    this.size = 0;
    this.data.clear();
    this.derived.clear();
    this.reserve(rows);
    this.ticks.set(other.ticks.subarray(0, rows));
    this.times.set(other.times.subarray(0, rows));
    for (const [name, values] of other.data) {
      const mine = new Float64Array(this.times.length);
      mine.set(values.subarray(0, rows));
      this.data.set(name, mine);
    }
    this.size = rows;
  }

  /** Returns all rows at other times, which ascend; of several that come to one tick the last. */
  shifted(run: number, tickOf: (t: number) => number): Rows {
    const rows: number[] = [];
    const ticks: number[] = [];
    for (let row = 0; row < this.size; row++) {
      const tick = tickOf(this.times[row]!);
      if (ticks.at(-1) === tick) rows[rows.length - 1] = row;
      else {
        rows.push(row);
        ticks.push(tick);
      }
    }
    const columns = new Map([...this.data].map(([name, values]) => [name, Float64Array.from(rows, (row) => values[row]!)]));
    return { run, ticks: Int32Array.from(ticks), columns };
  }

  /** Drops the rows before a time, once they are at least half of all: memory stays bounded, and copies are few. */
  forget(before_s: number): void {
    const rows = this.index(before_s);
    if (rows < ROOM_LEAST || 2 * rows < this.size) return;
    this.ticks.copyWithin(0, rows, this.size);
    this.times.copyWithin(0, rows, this.size);
    for (const values of this.data.values()) values.copyWithin(0, rows, this.size);
    this.size -= rows;
    this.derived.clear();
  }

  /** Returns the last row at or before a time; -1 if it is before the first. */
  index(t: number): number {
    let low = 0;
    let high = this.size;
    while (low < high) {
      const middle = (low + high) >>> 1;
      if (this.times[middle]! <= t + 1e-9) low = middle + 1;
      else high = middle;
    }
    return low - 1;
  }

  /** Returns the row whose time is nearest; -1 of an empty table. */
  nearest(t: number): number {
    const row = Math.max(this.index(t), 0);
    if (row + 1 < this.size && this.times[row + 1]! - t < t - this.times[row]!) return row + 1;
    return this.size === 0 ? -1 : row;
  }

  /**
   * Returns a column's value at a time: that of a row exactly, between rows cubic for joints whose speeds are known,
   * else linear; that of the first or last row outside. NaN if there is none.
   */
  value(name: Column | Derived, t: number): number {
    const values = this.column(name);
    let row = this.index(t);
    while (row >= 0 && Number.isNaN(values[row]!)) row--;
    let next = Math.max(row, this.index(t)) + 1;
    while (next < this.size && Number.isNaN(values[next]!)) next++;
    if (row < 0) return next < this.size ? values[next]! : NaN;
    const t0 = this.times[row]!;
    const first = values[row]!;
    if (next >= this.size || t - t0 < 1e-9) return first;
    const h = this.times[next]! - t0;
    const s = (t - t0) / h;
    const last = values[next]!;
    const speeds = /^q[1-6]$/.test(name) ? this.data.get(`qd${name[1]}` as Column) : undefined;
    const v0 = speeds?.[row] ?? NaN;
    const v1 = speeds?.[next] ?? NaN;
    if (Number.isNaN(v0) || Number.isNaN(v1)) return first + s * (last - first);
    const rest = 1 - s;
    return rest * rest * ((1 + 2 * s) * first + s * h * v0) + s * s * ((3 - 2 * s) * last - rest * h * v1);
  }

  /** Returns the joints at a time, rad; null of an empty table. */
  joints(t: number): Six | null {
    if (this.size === 0) return null;
    return [this.value("q1", t), this.value("q2", t), this.value("q3", t), this.value("q4", t), this.value("q5", t), this.value("q6", t)];
  }

  /** Whether there are rows, at most `step_s` apart, from one time to another. */
  isFine(from_s: number, to_s: number, step_s: number): boolean {
    const first = this.index(from_s);
    const last = Math.min(this.index(to_s), this.size - 1);
    if (first < 0 || this.end_s < to_s - 1e-9) return false;
    for (let row = first; row < last; row++) {
      if (this.times[row + 1]! - this.times[row]! > step_s + 1e-9) return false;
    }
    return true;
  }

  /**
   * Returns curves to draw: all rows of a stretch and one on either side of it, or, if they are many, the lowest and the
   * highest value of each of `columns` equal parts of the stretch, in the order in which they occur.
   */
  curves(names: readonly (Column | Derived)[], from_s: number, to_s: number, columns: number): Curves {
    const all = names.map((name) => this.column(name));
    const low = Math.max(this.index(from_s), 0);
    const high = Math.min(this.index(to_s) + 2, this.size);
    if (high - low <= 2 * columns) {
      return { t: this.times.subarray(low, Math.max(low, high)), values: all.map((values) => values.subarray(low, Math.max(low, high))) };
    }
    const starts = this.parts(low, high, from_s, to_s, columns);
    const t = new Float64Array(2 * starts.length);
    const thinned = all.map(() => new Float64Array(2 * starts.length));
    let points = 0;
    for (let part = 0; part < starts.length; part++) {
      const begin = starts[part]!;
      const end = part + 1 < starts.length ? starts[part + 1]! : high;
      const isOne = end - begin === 1;
      t[points] = this.times[begin]!;
      if (!isOne) t[points + 1] = this.times[end - 1]!;
      for (let curve = 0; curve < all.length; curve++) {
        const values = all[curve]!;
        let least = begin;
        let most = begin;
        for (let row = begin + 1; row < end; row++) {
          const value = values[row]!;
          // The first of a part may be NaN: any other number takes its place.
          if (value < values[least]! || Number.isNaN(values[least])) least = row;
          if (value > values[most]! || Number.isNaN(values[most])) most = row;
        }
        thinned[curve]![points] = values[Math.min(least, most)]!;
        if (!isOne) thinned[curve]![points + 1] = values[Math.max(least, most)]!;
      }
      points += isOne ? 1 : 2;
    }
    return { t: t.subarray(0, points), values: thinned.map((values) => values.subarray(0, points)) };
  }

  /** Returns the lowest and the highest value of columns over a stretch; null if there is none. */
  range(names: readonly (Column | Derived)[], from_s: number, to_s: number): readonly [number, number] | null {
    let least = Infinity;
    let most = -Infinity;
    const low = Math.max(this.index(from_s), 0);
    const high = Math.min(this.index(to_s) + 2, this.size);
    for (const name of names) {
      const values = this.column(name);
      for (let row = low; row < high; row++) {
        const value = values[row]!;
        if (value < least) least = value;
        if (value > most) most = value;
      }
    }
    return least <= most ? [least, most] : null;
  }

  /** First row of each part that has one; the rows at both ends, outside of the stretch, are parts of their own. */
  private parts(low: number, high: number, from_s: number, to_s: number, columns: number): number[] {
    const starts: number[] = [];
    const scale = columns / (to_s - from_s);
    let last = -2;
    for (let row = low; row < high; row++) {
      const t = this.times[row]!;
      const part = t < from_s ? -1 : t > to_s ? columns : Math.min(Math.floor((t - from_s) * scale), columns - 1);
      if (part !== last) starts.push(row);
      last = part;
    }
    return starts;
  }

  private rowAtOrAfter(tick: number): number {
    if (this.size === 0 || this.ticks[this.size - 1]! < tick) return this.size;
    let low = 0;
    let high = this.size;
    while (low < high) {
      const middle = (low + high) >>> 1;
      if (this.ticks[middle]! < tick) low = middle + 1;
      else high = middle;
    }
    return low;
  }

  private reserve(rows: number): void {
    if (rows <= this.times.length) return;
    const room = Math.max(ROOM_LEAST, rows, 2 * this.times.length);
    const grow = (old: Float64Array) => {
      const made = new Float64Array(room);
      made.set(old.subarray(0, this.size));
      return made;
    };
    const ticks = new Int32Array(room);
    ticks.set(this.ticks.subarray(0, this.size));
    this.ticks = ticks;
    this.times = grow(this.times);
    for (const [name, values] of this.data) this.data.set(name, grow(values));
  }

  /** Writes the merged rows in place of those from `low` to `high`; `missing` fills what neither has. */
  private place(into: Int32Array | Float64Array, low: number, high: number, plan: Plan, added: ArrayLike<number> | undefined, missing = 0): void {
    const old = into.slice(low, high);
    into.copyWithin(low + plan.length, high, this.size);
    for (let row = 0; row < plan.length; row++) {
      const newer = plan.added[row]!;
      const older = plan.old[row]!;
      if (newer >= 0 && added !== undefined) into[low + row] = added[newer]!;
      else into[low + row] = older >= 0 ? old[older]! : missing;
    }
  }

  private derive(name: Derived): Float64Array {
    let entry = this.derived.get(name);
    if (entry === undefined || entry.values.length < this.size) {
      const values = new Float64Array(this.times.length);
      if (entry !== undefined) values.set(entry.values.subarray(0, entry.valid));
      entry = { values, valid: entry?.valid ?? 0 };
      this.derived.set(name, entry);
    }
    const { values } = entry;
    const joint = name[name.length - 1]!;
    if (name.startsWith("error")) {
      const target = this.column(`q${joint}` as Column);
      const actual = this.column(`qa${joint}` as Column);
      for (let row = entry.valid; row < this.size; row++) values[row] = target[row]! - actual[row]!;
    } else {
      const speeds = this.column(`qd${joint}` as Column);
      for (let row = entry.valid; row < this.size; row++) {
        values[row] = row === 0 ? 0 : (speeds[row]! - speeds[row - 1]!) / (this.times[row]! - this.times[row - 1]!);
      }
    }
    entry.valid = this.size;
    return values.subarray(0, this.size);
  }
}

/** For each merged row the row among the old ones and among those that were added; -1: none. */
interface Plan {
  readonly length: number;
  readonly old: Int32Array;
  readonly added: Int32Array;
}

function merged(old: Int32Array, added: Int32Array): Plan {
  const plan = { old: new Int32Array(old.length + added.length), added: new Int32Array(old.length + added.length) };
  let i = 0;
  let j = 0;
  let length = 0;
  while (i < old.length || j < added.length) {
    const tick = Math.min(old[i] ?? Infinity, added[j] ?? Infinity);
    plan.old[length] = old[i] === tick ? i++ : -1;
    plan.added[length] = -1;
    while (added[j] === tick) plan.added[length] = j++;
    length++;
  }
  return { length, ...plan };
}

const SOURCES = new Set<string>(COLUMNS);

function isDerived(name: Column | Derived): name is Derived {
  return !SOURCES.has(name);
}
