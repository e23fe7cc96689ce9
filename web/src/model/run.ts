/** One run of a program as the page knows it: grows while it is computed. */

import { signal } from "@preact/signals-core";
import type { AlarmReport, Contact, CycleRow, FromSource, Moment, Move, RunEvent, RunOptions } from "../source/messages.ts";
import type { Rows } from "../source/rows.ts";
import { SampleTable } from "./samples.ts";

export type RunEnded = Extract<FromSource, { type: "run_ended" }>;

/** Where a thread was: `line[i]` from `t[i]` until `t[i + 1]`, the last until the end of what is computed; line 0: no such thread. */
export interface ThreadLines {
  readonly t: number[];
  readonly line: number[];
}

export class Run {
  /** Raised when anything has changed; what shows a run reads it. At most once for each message. */
  readonly revision = signal(0);
  readonly samples = new SampleTable();
  /** By the name of the thread, `main` first. */
  readonly lines = new Map<string, ThreadLines>();
  readonly moves: Move[] = [];
  readonly events: RunEvent[] = [];
  cycle: readonly CycleRow[] = [];
  contacts: readonly Contact[] = [];
  /** Up to where it is computed, s. */
  known_s = 0;
  ended: RunEnded | null = null;
  readonly number: number;
  /** Of the text. */
  readonly version: number;
  readonly options: RunOptions;

  constructor(number: number, version: number, options: RunOptions) {
    this.number = number;
    this.version = version;
    this.options = options;
  }

  /** The last moment, once it has ended. */
  get last(): Moment | null {
    return this.ended?.moment ?? null;
  }

  get alarm(): AlarmReport | null {
    return this.ended?.alarm ?? null;
  }

  /** Takes a message about this run; returns whether it was one. */
  take(message: FromSource): boolean {
    switch (message.type) {
      case "progress":
        this.known_s = Math.max(this.known_s, message.t);
        break;
      case "events":
        this.events.push(...message.list);
        break;
      case "lines": {
        const known = this.lines.get(message.thread) ?? { t: [], line: [] };
        known.t.push(...message.t);
        known.line.push(...message.line);
        this.lines.set(message.thread, known);
        break;
      }
      case "moves":
        this.moves.push(...message.list);
        break;
      case "cycle":
        this.cycle = message.table;
        break;
      case "contacts":
        this.contacts = message.list;
        break;
      case "run_ended":
        this.ended = message;
        this.known_s = message.moment.t;
        break;
      default:
        return false;
    }
    this.revision.value++;
    return true;
  }

  takeRows(rows: Rows): void {
    this.samples.add(rows);
    this.known_s = Math.max(this.known_s, this.samples.end_s);
    this.revision.value++;
  }
}
