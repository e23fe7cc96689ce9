/** What is shown of a sweep: chosen quantities and the chosen run. */

import { computed, signal, type ReadonlySignal, type Signal } from "@preact/signals-core";
import type { Column, Kind, ShownRun, Sweep } from "./data.ts";
import { kindsOf, runsOf } from "./numbers.ts";

/** Kinds of failures with a colour of their own. */
export const KINDS_COLOURED = 5;

export type Colouring = "result" | "kind";

export class State {
  readonly sweep: Sweep;
  readonly kinds: Column["values"];
  readonly runs: Column["values"];
  /** Columns that can be chosen for an axis. */
  readonly quantities: readonly Column[];
  readonly histogram: Signal<Column>;
  readonly across: Signal<Column>;
  readonly up: Signal<Column>;
  readonly colouring: Signal<Colouring>;
  /** Row of the chosen run; -1: none. */
  readonly row = signal(-1);
  /** Number that was asked for and is not in the data. */
  readonly missing = signal<number | null>(null);
  readonly chosen: ReadonlySignal<{ readonly run: number; readonly kind: Kind | null; readonly shown: ShownRun | null } | null>;
  /** Rows of failing runs, in the order of their numbers. */
  readonly failing: readonly number[];
  private readonly rowOf = new Map<number, number>();

  constructor(sweep: Sweep) {
    this.sweep = sweep;
    this.kinds = kindsOf(sweep);
    this.runs = runsOf(sweep);
    this.quantities = sweep.columns.filter(({ role }) => role !== "run" && role !== "kind");
    this.runs.forEach((run, row) => this.rowOf.set(run, row));
    this.failing = Array.from(this.kinds.keys()).filter((row) => this.kinds[row]! >= 0);
    const time = this.quantities.find(({ role }) => role === "time")!;
    const varied = this.quantities.filter(({ role, labels }) => role === "varied" && labels === null);
    const measure = this.quantities.find(({ role, labels }) => role === "measure" && labels === null);
    this.histogram = signal(time);
    this.across = signal(varied[0] ?? this.quantities[0]!);
    // Where something fails, it fails somewhere in the box of what was varied.
    this.up = signal((this.failing.length > 0 ? varied[1] : undefined) ?? measure ?? time);
    this.colouring = signal<Colouring>(sweep.kinds.length > 1 ? "kind" : "result");
    this.chosen = computed(() => {
      const row = this.row.value;
      if (row < 0) return null;
      const run = this.runs[row]!;
      const kind = sweep.kinds.find(({ number }) => number === this.kinds[row]) ?? null;
      const shown = kind?.runs.find((entry) => entry.run === run) ?? sweep.nearest.find((entry) => entry.run === run) ?? null;
      return { run, kind, shown };
    });
  }

  /** Chooses a run by its number. */
  choose(run: number): void {
    const row = this.rowOf.get(run);
    this.missing.value = row === undefined ? run : null;
    this.row.value = row ?? -1;
  }

  /** Goes to the next failing run, or the one before. */
  step(by: 1 | -1): void {
    const at = this.row.value;
    const later = this.failing.filter((row) => (by > 0 ? row > at : row < at || at < 0));
    const row = by > 0 ? later[0] : later.at(-1);
    if (row !== undefined) this.choose(this.runs[row]!);
  }

  /** Place of a row's kind in the table of kinds, for its colour; `KINDS_COLOURED` for those without one; -1: it holds. */
  colourOf(row: number): number {
    const kind = this.kinds[row]!;
    if (kind < 0) return -1;
    if (this.colouring.value === "result") return 0;
    const place = this.sweep.kinds.findIndex(({ number }) => number === kind);
    return place < 0 ? KINDS_COLOURED : Math.min(place, KINDS_COLOURED);
  }
}
