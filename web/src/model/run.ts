/** One run of a program as the page knows it: grows while it is computed. */

import { signal } from "@preact/signals-core";
import type { AlarmReport, Contact, CycleRow, FromSource, Moment, Move, ProgramTree, RunEvent, RunOptions, Scene, Value } from "../source/messages.ts";
import { TICK_S, type Rows } from "../source/rows.ts";
import { SampleTable } from "./samples.ts";
import { innerNode, nodeOf } from "./tree.ts";

export type LeftOut = Extract<FromSource, { type: "left_out" }>;
export type RunEnded = Extract<FromSource, { type: "run_ended" }>;

/** Where a thread was: `line[i]` from `t[i]` until `t[i + 1]`, the last until the end of what is computed; line 0: no such thread. */
export interface ThreadLines {
  readonly t: number[];
  readonly line: number[];
}

/** A stretch of a thread in one line. */
export interface Span {
  readonly start_s: number;
  readonly end_s: number;
  readonly thread: string;
}

/** Types of events that are for people to read: rows of Messages. */
const READ_TYPES: ReadonlySet<string> = new Set(["log", "print", "popup", "warning", "device", "safety", "alarm"]);

export class Run {
  /** Raised when anything has changed; what shows a run reads it. At most once for each message. */
  readonly revision = signal(0);
  readonly samples = new SampleTable();
  /** By the name of the thread, `main` first. */
  readonly lines = new Map<string, ThreadLines>();
  /** Times at which nodes of a graphical program began, by their numbers. */
  readonly nodes = new Map<number, number[]>();
  readonly moves: Move[] = [];
  /** In the order in which they happened. */
  readonly events: RunEvent[] = [];
  /** Those of the events that people read. */
  readonly messages: RunEvent[] = [];
  /** Changes of each signal that changed. */
  readonly signals = new Map<string, { readonly t: number[]; readonly value: Value[]; readonly line: number[] }>();
  cycle: readonly CycleRow[] = [];
  contacts: readonly Contact[] = [];
  /** What the source has not sent of the events; null: nothing. */
  leftOut: LeftOut | null = null;
  /** The robot that ran; null: that of the page. */
  scene: Scene | null = null;
  /** Up to where it is computed, s. */
  known_s = 0;
  ended: RunEnded | null = null;
  readonly number: number;
  /** Of the text. */
  readonly version: number;
  readonly options: RunOptions;
  /** The text that ran. */
  readonly text: string;
  /** The graphical program of which that is the script; null if it is none. */
  readonly tree: ProgramTree | null;

  constructor(number: number, version: number, options: RunOptions, text = "", tree: ProgramTree | null = null) {
    this.number = number;
    this.version = version;
    this.options = options;
    this.text = text;
    this.tree = tree;
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
        for (const event of message.list) this.happen(event);
        break;
      case "left_out":
        this.leftOut = message;
        break;
      case "lines":
        this.pass(message.thread, message.t, message.line);
        break;
      case "marks":
        this.begin(message.t, message.node);
        break;
      case "moves":
        for (const move of message.list) this.move(move);
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

  /** Takes over the rows of another run up to a time; all else comes again, as its lines may be others in this text. */
  continueFrom(other: Run, until_s: number): void {
    if (until_s <= 0) return;
    this.samples.begin(other.samples, until_s);
    this.known_s = Math.max(this.known_s, Math.min(until_s, other.known_s));
    this.revision.value++;
  }

  // ---------------------------------------------------------------- questions

  /** The node of a line as people say it; "" where it belongs to none. */
  nodeAt(line: number): string {
    return nodeOf(this.tree, line);
  }

  /** A line of the text as lists show it; in a graphical program its node stands first. */
  shownLine(lines: readonly string[], line: number): string {
    return [innerNode(this.nodeAt(line)), lines[line - 1]?.trim() ?? ""].filter((part) => part !== "").join("  ");
  }

  /** The line of a thread at a time; 0 where there is none. */
  lineAt(t: number, thread = "main"): number {
    const found = this.lines.get(thread);
    return found === undefined ? 0 : (found.line[lastAtOrBefore(found.t, t)] ?? 0);
  }

  /** Stretches in which a thread is in a line, by their begin. */
  spansOf(line: number): Span[] {
    const spans: Span[] = [];
    for (const [thread, { t, line: lines }] of this.lines) {
      for (let index = 0; index < t.length; index++) {
        if (lines[index] === line) spans.push({ start_s: t[index]!, end_s: t[index + 1] ?? this.known_s, thread });
      }
    }
    return spans.sort((a, b) => a.start_s - b.start_s);
  }

  /** The next visit of a line after a time, the first one if there is none; null if it never ran. */
  visitAfter(line: number, t: number): number | null {
    const visits = this.spansOf(line);
    return (visits.find((span) => span.start_s > t + TICK_S / 2) ?? visits[0])?.start_s ?? null;
  }

  /** The time of the next (1) or previous (-1) event, contact or begin of a move; null if there is none. */
  eventBeside(t: number, by: 1 | -1): number | null {
    let found: number | null = null;
    const look = (time: number) => {
      if (by > 0 ? time > t + TICK_S / 2 && (found === null || time < found) : time < t - TICK_S / 2 && (found === null || time > found)) found = time;
    };
    for (const event of this.events) look(event.t);
    for (const move of this.moves) look(move.start_s);
    for (const contact of this.contacts) if (contact.is_contact) look(contact.start_s);
    if (this.alarm !== null) look(this.alarm.t);
    return found;
  }

  // ---------------------------------------------------------------- what it grows by

  private happen(event: RunEvent): void {
    this.events.push(event);
    if (READ_TYPES.has(event.type)) this.messages.push(event);
    if (event.type === "signal") {
      const name = String(event["name"]);
      const changes = this.signals.get(name) ?? { t: [], value: [], line: [] };
      changes.t.push(event.t);
      changes.value.push(event["value"] as Value);
      changes.line.push(event.line ?? 0);
      this.signals.set(name, changes);
    }
  }

  /** What comes again for a time counts instead of what was known. */
  private pass(thread: string, t: readonly number[], line: readonly number[]): void {
    const known = this.lines.get(thread) ?? { t: [], line: [] };
    while (known.t.length > 0 && t.length > 0 && known.t.at(-1)! >= t[0]!) {
      known.t.pop();
      known.line.pop();
    }
    for (let index = 0; index < t.length; index++) {
      known.t.push(t[index]!);
      known.line.push(line[index]!);
    }
    this.lines.set(thread, known);
  }

  private begin(times: readonly number[], nodes: readonly number[]): void {
    nodes.forEach((node, index) => {
      const known = this.nodes.get(node);
      if (known === undefined) this.nodes.set(node, [times[index]!]);
      else known.push(times[index]!);
    });
  }

  private move(move: Move): void {
    while (this.moves.length > 0 && this.moves.at(-1)!.start_s >= move.start_s - TICK_S / 2) this.moves.pop();
    this.moves.push(move);
  }
}

/** Index of the last of ascending times that is not after `t`; -1 if there is none. */
export function lastAtOrBefore(times: ArrayLike<number>, t: number): number {
  let low = 0;
  let high = times.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (times[middle]! <= t + TICK_S / 4) low = middle + 1;
    else high = middle;
  }
  return low - 1;
}
