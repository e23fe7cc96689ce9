/** Samples of a run by time: columns of rows, finer where they were asked for. */

import { TICK_S, type Column, type Rows } from "../source/rows.ts";

export class SampleTable {
  /** Times of the rows, s, ascending. */
  t = new Float64Array(0);
  private columns = new Map<Column, Float64Array>();

  get length(): number {
    return this.t.length;
  }

  get end_s(): number {
    return this.t.at(-1) ?? 0;
  }

  /** Values of a column, one for each time; NaN where a row does not have it. */
  column(name: Column): Float64Array {
    return this.columns.get(name) ?? new Float64Array(this.t.length).fill(NaN);
  }

  /** Adds rows; of two at one time the newer one counts. */
  add(rows: Rows): void {
    const old = this.t;
    const order: [number, number][] = []; // index of the old row or -1, of the new row or -1
    let i = 0;
    let j = 0;
    while (i < old.length || j < rows.ticks.length) {
      const a = i < old.length ? old[i]! : Infinity;
      const b = j < rows.ticks.length ? rows.ticks[j]! * TICK_S : Infinity;
      if (Math.abs(a - b) < TICK_S / 2) order.push([i++, j++]);
      else if (a < b) order.push([i++, -1]);
      else order.push([-1, j++]);
    }
    const t = new Float64Array(order.length);
    order.forEach(([a, b], index) => (t[index] = b >= 0 ? rows.ticks[b]! * TICK_S : old[a]!));
    const columns = new Map<Column, Float64Array>();
    for (const name of new Set([...this.columns.keys(), ...rows.columns.keys()])) {
      if (name === "tick") continue;
      const before = this.columns.get(name);
      const added = rows.columns.get(name);
      const values = new Float64Array(order.length);
      order.forEach(([a, b], index) => (values[index] = (b >= 0 ? added?.[b] : undefined) ?? before?.[a] ?? NaN));
      columns.set(name, values);
    }
    this.t = t;
    this.columns = columns;
  }
}
