/** The time of a run by line, beside that of another run. */

import { lineMap } from "./difference.ts";
import type { Run } from "./run.ts";

export interface CycleView {
  /** 0: a line that the run does not have any more. */
  readonly line: number;
  readonly moving: number;
  readonly standing: number;
  readonly visits: number;
  /** Of the time of the run, from 0 to 1. */
  readonly share: number;
  /** Time here less time in the compared run, s; null if none is compared. */
  readonly difference: number | null;
  /** The line in the compared run, if it has it. */
  readonly before: number | null;
}

export const ORDERS = ["line", "moving", "standing", "visits", "share", "difference"] as const;
export type CycleOrder = (typeof ORDERS)[number];

/** Rows of the table: lines of both texts that are the same are compared; a line that is gone has its own row. */
export function cycleRows(run: Run, compared: Run | null, order: CycleOrder): CycleView[] {
  const total = run.cycle.reduce((sum, row) => sum + row.moving_s + row.standing_s, 0);
  const lines = compared === null ? new Map<number, number>() : lineMap(compared.text, run.text);
  const theirs = new Map(compared?.cycle.map((row) => [row.line, row.moving_s + row.standing_s]));
  const rows: CycleView[] = run.cycle.map((row) => {
    const time = row.moving_s + row.standing_s;
    const before = compared === null ? null : (lines.get(row.line) ?? null);
    const theirTime = before === null ? 0 : (theirs.get(before) ?? 0);
    if (before !== null) theirs.delete(before);
    return {
      line: row.line, moving: row.moving_s, standing: row.standing_s, visits: row.visits, share: total > 0 ? time / total : 0,
      difference: compared === null ? null : time - theirTime, before,
    };
  });
  for (const [line, time] of theirs) rows.push({ line: 0, moving: 0, standing: 0, visits: 0, share: 0, difference: -time, before: line });
  const size = (row: CycleView) => (order === "difference" ? Math.abs(row.difference ?? 0) : row[order]);
  // A line that is gone stands at the end; equal values stay in the order of lines.
  return rows.sort((a, b) => (order === "line" ? (a.line || Number.MAX_SAFE_INTEGER) - (b.line || Number.MAX_SAFE_INTEGER) : size(b) - size(a) || a.line - b.line));
}
