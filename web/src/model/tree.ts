/** A graphical program beside its script: which node a line belongs to, and what a run says of the nodes. */

import type { ProgramTree } from "../source/messages.ts";
import { TICK_S } from "../source/rows.ts";
import type { Run } from "./run.ts";

/** Place of a row in the tree, for those who cannot see it. */
interface Place {
  /** Number of the row around it; 0: there is none. */
  readonly parent: number;
  /** How many rows are beside it, itself included, and which of them it is. */
  readonly size: number;
  readonly position: number;
  /** Number of the last row in it; its own if none is. */
  readonly last: number;
}

/** What is found in a tree once: trees have thousands of rows. */
interface Found {
  readonly places: readonly Place[];
  /** Lines of the script by row, ascending. */
  readonly lines: readonly (readonly number[])[];
}

const known = new WeakMap<ProgramTree, Found>();

function found(tree: ProgramTree): Found {
  const before = known.get(tree);
  if (before !== undefined) return before;
  const places: { parent: number; size: number; position: number; last: number }[] = [];
  const lines: number[][] = tree.rows.map(() => []);
  tree.lines.forEach((row, index) => lines[row - 1]?.push(index + 1));
  const around: number[] = [];
  const counts = new Map<number, number>();
  tree.rows.forEach((row, index) => {
    around.length = row.level;
    const parent = around.at(-1) ?? 0;
    around.push(index + 1);
    counts.set(parent, (counts.get(parent) ?? 0) + 1);
    places.push({ parent, size: 0, position: counts.get(parent)!, last: index + 1 });
    for (const outer of around) places[outer - 1]!.last = index + 1;
  });
  for (const place of places) place.size = counts.get(place.parent)!;
  const made = { places, lines };
  known.set(tree, made);
  return made;
}

/** The place of a row in its tree. */
export function placeOf(tree: ProgramTree, row: number): Place {
  return found(tree).places[row - 1]!;
}

/** Lines of a row in the script, ascending; none for a row that writes nothing. */
export function linesOf(tree: ProgramTree, row: number): readonly number[] {
  return found(tree).lines[row - 1] ?? [];
}

/** The row to which a line belongs; 0: to none. */
export function rowOf(tree: ProgramTree, line: number): number {
  return tree.rows.length === 0 ? 0 : (tree.lines[line - 1] ?? 0);
}

/** The node of a line as people say it; "" where it belongs to none. */
export function nodeOf(tree: ProgramTree | null | undefined, line: number): string {
  return tree?.places[tree.lines[line - 1] ?? 0] ?? "";
}

/** The node alone of a place that names the one around it, too. */
export function innerNode(place: string): string {
  return place.split(" > ").at(-1)!;
}

/** Rows of which something ran, with those around them. */
export function rowsThatRan(tree: ProgramTree, run: Run): ReadonlySet<number> {
  const ran = new Set<number>();
  const add = (row: number) => {
    for (let at = row; at > 0 && at <= tree.rows.length && !ran.has(at); at = placeOf(tree, at).parent) ran.add(at);
  };
  for (const row of run.nodes.keys()) add(row);
  for (const { line } of run.lines.values()) for (const one of new Set(line)) add(rowOf(tree, one));
  return ran;
}

/** Whether a row can run at all: it has lines, or one in it has. */
export function canRun(tree: ProgramTree, row: number): boolean {
  const { last } = placeOf(tree, row);
  for (let at = row; at <= last; at++) if (linesOf(tree, at).length > 0) return true;
  return false;
}

/** The next time at which a row begins after a time, the first one if there is none; null if it never ran. */
export function nextBegin(tree: ProgramTree, run: Run, row: number, t: number): number | null {
  const times = run.nodes.get(row) ?? linesOf(tree, row).flatMap((line) => run.spansOf(line).map((span) => span.start_s));
  const after = times.filter((time) => time > t + TICK_S / 2);
  return after.length > 0 ? Math.min(...after) : times.length > 0 ? Math.min(...times) : null;
}

/** The line of a row that takes time in a run: where the time line shows it; its first one if none does. */
export function lineToShow(tree: ProgramTree, run: Run | null, row: number): number {
  const lines = linesOf(tree, row);
  return lines.find((line) => run !== null && run.spansOf(line).length > 0) ?? lines[0] ?? 0;
}

/** Numbers of the rows that are shown while some are folded, in their order. */
export function shownRows(tree: ProgramTree, folded: ReadonlySet<number>): number[] {
  const shown: number[] = [];
  for (let row = 1; row <= tree.rows.length; row++) {
    shown.push(row);
    if (folded.has(row)) row = placeOf(tree, row).last;
  }
  return shown;
}

/** The innermost row around one, or itself, that is shown while some are folded. */
export function shownFor(tree: ProgramTree, folded: ReadonlySet<number>, row: number): number {
  let shown = row;
  for (let at = row; at > 0; at = placeOf(tree, at).parent) if (at !== row && folded.has(at)) shown = at;
  return shown;
}

/** Rows that a text finds: by number, kind, name and what they do. */
export function rowsWith(tree: ProgramTree, words: string, named: (row: number) => string): number[] {
  const wanted = words.trim().toLowerCase();
  return wanted === "" ? [] : tree.rows.map((_, index) => index + 1).filter((row) => named(row).toLowerCase().includes(wanted));
}
