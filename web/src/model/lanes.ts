/**
 * Lanes of a time line: what happened in a run, each thing in a row of its own.
 *
 * `Lanes` follows a run that grows and takes only what is new. It knows times and values; `bars.ts` says what of it is
 * drawn, and `regions/timeline/` draws it.
 */

import type { Contact, Move, RunEvent } from "../source/messages.ts";
import { after, atOrAfter, type Spans } from "./bars.ts";
import type { Run, ThreadLines } from "./run.ts";

export type Group = "threads" | "moves" | "messages" | "signals" | "channels" | "devices";

/** Groups in the order in which they are shown. */
export const GROUPS: readonly Group[] = ["threads", "moves", "messages", "signals", "channels", "devices"];

interface Common {
  readonly id: string;
  readonly group: Group;
  /** Of a thread, a signal, a channel or a device; of other lanes their kind. */
  readonly name: string;
  /** Times at which something happens in this lane, ascending. */
  readonly stops: readonly number[];
}

/** Lines of a thread, moves, modes of the safety system, contacts. */
export interface SpanLane extends Common, Spans {
  readonly shape: "lines" | "moves" | "safety" | "contacts";
  /** Line of a span; 0 if there is none. */
  readonly line: (index: number) => number;
  /** What a span is: kind of move, mode, names of both things in contact; empty for lines. */
  readonly what: (index: number) => string;
}

/** A signal: `value[i]` from `start[i]` on; the first is that before the first change. */
export interface LevelLane extends Common {
  readonly shape: "levels";
  readonly isBit: boolean;
  readonly start: readonly number[];
  readonly value: readonly number[];
  /** Until when it is known, s. */
  readonly end: () => number;
  /** What has changed it (see `docs/reference/events.md`), and the line of the statement; 0 if there is none. */
  readonly by: readonly string[];
  readonly line: readonly number[];
}

/** Messages and alarms, the activity of a channel, what a device has reported. */
export interface MarkLane extends Common {
  readonly shape: "marks";
  readonly events: readonly RunEvent[];
  /** When a channel was open. */
  readonly open: Spans;
}

export type Lane = SpanLane | LevelLane | MarkLane;

/** Kinds of marks, the heaviest last. */
export const MARK_KINDS = ["closed", "open", "sent", "received", "print", "log", "device", "popup", "warning", "timeout", "refused", "alarm"] as const;
export type MarkKind = (typeof MARK_KINDS)[number];

/** Returns the kind of the mark of an event. */
export function markKind(event: RunEvent): MarkKind {
  const kind = event.type === "channel" ? String(event["what"]) : event.type === "device" && event["level"] === "warning" ? "warning" : event.type;
  return MARK_KINDS.find((known) => known === kind) ?? "log";
}

const WEIGHTS = new Map<string, number>(MARK_KINDS.map((kind, weight) => [kind, weight]));

export function markWeight(event: RunEvent): number {
  return WEIGHTS.get(markKind(event)) ?? 0;
}

/** Kind, time and place of something that happened, for lists. */
export interface Entry {
  readonly t: number;
  readonly kind: string;
  readonly line: number;
  readonly thread: string;
  /** What happened, in the product's words. */
  readonly text: string;
  /** Of which this is; moves and contacts have none. */
  readonly event?: RunEvent;
}

export class Lanes {
  readonly run: Run;
  private readonly found = new Map<string, Lane>();
  private eventsTaken = 0;
  private contactsTaken: readonly Contact[] = [];
  private sorted: readonly Lane[] = [];

  constructor(run: Run) {
    this.run = run;
  }

  /** Lanes in the order in which they are shown. Takes what the run has got since the last time. */
  get all(): readonly Lane[] {
    const { run } = this;
    const before = this.found.size;
    for (const [thread, lines] of run.lines) if (!this.found.has(`lines ${thread}`)) this.add(threadLane(run, thread, lines));
    if (run.moves.length > 0 && !this.found.has("moves")) this.add(moveLane(run.moves));
    if (run.contacts !== this.contactsTaken) this.takeContacts();
    for (; this.eventsTaken < run.events.length; this.eventsTaken++) this.takeEvent(run.events[this.eventsTaken]!);
    if (this.found.size !== before || this.sorted.length !== this.found.size) this.sorted = [...this.found.values()].sort(inOrder);
    return this.sorted;
  }

  get(id: string): Lane | undefined {
    void this.all;
    return this.found.get(id);
  }

  /** All events, moves and contacts, in the order of time. */
  entries(): Entry[] {
    const { events, moves, contacts } = this.run;
    const found = [...events.map(entryOf), ...moves.map(moveEntry), ...contacts.filter((contact) => contact.is_contact).map(contactEntry)];
    return found.sort((a, b) => a.t - b.t);
  }

  private add(lane: Lane): void {
    this.found.set(lane.id, lane);
  }

  private takeContacts(): void {
    this.contactsTaken = this.run.contacts;
    this.found.delete("contacts");
    const contacts = this.run.contacts.filter((contact) => contact.is_contact).sort((a, b) => a.start_s - b.start_s);
    if (contacts.length > 0) this.add(contactLane(contacts));
  }

  private takeEvent(event: RunEvent): void {
    switch (event.type) {
      case "signal":
        this.takeSignal(event);
        return;
      case "channel":
        this.takeMark(`channel ${event["kind"]} ${event["channel"]}`, "channels", `${event["kind"]} ${event["channel"]}`, event);
        return;
      case "device":
        this.takeMark(`device ${event["device"]}`, "devices", String(event["device"]), event);
        return;
      case "safety": {
        const lane = this.found.get("safety") as (SpanLane & { modes: RunEvent[] }) | undefined;
        if (lane === undefined) this.add(safetyLane(this.run, event));
        else {
          lane.modes.push(event);
          (lane.start as number[]).push(event.t);
        }
        return;
      }
      default:
        this.takeMark("messages", "messages", "messages", event);
    }
  }

  private takeSignal(event: RunEvent): void {
    const name = String(event["name"]);
    // NaN and infinities come as texts.
    const value = Number(event["value"]);
    let lane = this.found.get(`signal ${name}`) as (LevelLane & { [field in "start" | "value" | "line" | "stops"]: number[] } & { by: string[] }) | undefined;
    if (lane === undefined) {
      const isBit = typeof event["value"] === "boolean";
      lane = {
        id: `signal ${name}`, group: "signals", name, shape: "levels", isBit,
        end: () => this.run.known_s, start: [0], value: [isBit ? 1 - value : 0], by: [""], line: [0], stops: [],
      };
      this.add(lane);
    }
    const last = lane.start.length - 1;
    // Of one tick the last level counts, as clients see it.
    if (last > 0 && lane.start[last] === event.t) {
      lane.value[last] = value;
      lane.by[last] = String(event["by"] ?? "");
      lane.line[last] = event.line ?? 0;
      return;
    }
    lane.start.push(event.t);
    lane.stops.push(event.t);
    lane.value.push(value);
    lane.by.push(String(event["by"] ?? ""));
    lane.line.push(event.line ?? 0);
  }

  private takeMark(id: string, group: Group, name: string, event: RunEvent): void {
    let lane = this.found.get(id) as Marked | undefined;
    if (lane === undefined) {
      lane = markLane(this.run, id, group, name);
      this.add(lane);
    }
    lane.events.push(event);
    lane.stops.push(event.t);
    if (event["what"] === "open" && lane.closed.length === lane.opened.length) lane.opened.push(event.t);
    else if (event["what"] === "closed" && lane.closed.length < lane.opened.length) lane.closed.push(event.t);
  }
}

// ---------------------------------------------------------------- what is where in a lane

/** Returns the index of the span or level at a time; -1 if there is none. */
export function indexAt(lane: SpanLane | LevelLane, t: number): number {
  const index = after(lane.start, t + 1e-9) - 1;
  if (index < 0 || lane.shape === "levels") return index;
  return t < lane.end(index) || (t <= lane.end(index) && index === lane.start.length - 1) ? index : -1;
}

/** Returns the marks within `reach_s` of a time. */
export function marksNear(lane: MarkLane, t: number, reach_s: number): readonly RunEvent[] {
  return lane.events.slice(atOrAfter(lane.stops, t - reach_s - 1e-9), after(lane.stops, t + reach_s + 1e-9));
}

/** Returns the next (1) or previous (-1) of ascending times; null if there is none. */
export function nextStop(times: ArrayLike<number>, t: number, by: 1 | -1): number | null {
  const index = by > 0 ? after(times, t + 1e-6) : atOrAfter(times, t - 1e-6) - 1;
  return times[index] ?? null;
}

/** Returns the stretches of a thread in the lines in which it was longest, one lane each, in the order of lines, and one for the others. */
export function lanesByLine(run: Run, thread: string, most: number): SpanLane[] {
  const lines = run.lines.get(thread) ?? { t: [], line: [] };
  const end = (index: number) => lines.t[index + 1] ?? run.known_s;
  const total = new Map<number, number>();
  lines.line.forEach((line, index) => total.set(line, (total.get(line) ?? 0) + end(index) - lines.t[index]!));
  total.delete(0);
  const longest = [...total.keys()].sort((a, b) => total.get(b)! - total.get(a)! || a - b);
  const chosen = longest.slice(0, longest.length > most ? most - 1 : most).sort((a, b) => a - b);
  const lane = (name: string, isIn: (line: number) => boolean): SpanLane => {
    const indices = lines.line.flatMap((line, index) => (isIn(line) ? [index] : []));
    const start = indices.map((index) => lines.t[index]!);
    return {
      id: `line ${thread} ${name}`, group: "threads", name, shape: "lines", start, stops: start,
      end: (index) => end(indices[index]!), line: (index) => lines.line[indices[index]!]!, what: () => "",
    };
  };
  const found = chosen.map((line) => lane(String(line), (other) => other === line));
  if (chosen.length < longest.length) found.push(lane("", (other) => other !== 0 && !chosen.includes(other)));
  return found;
}

// ---------------------------------------------------------------- making lanes

function threadLane(run: Run, thread: string, lines: ThreadLines): SpanLane {
  return {
    id: `lines ${thread}`, group: "threads", name: thread, shape: "lines", start: lines.t, stops: lines.t,
    end: (index) => lines.t[index + 1] ?? Math.max(run.known_s, lines.t[index]!), line: (index) => lines.line[index]!, what: () => "",
  };
}

function moveLane(moves: readonly Move[]): SpanLane {
  // The run adds moves at its end, or replaces the last ones.
  const start: number[] = [];
  const known = () => {
    start.length = Math.min(start.length, moves.length);
    while (start.length > 0 && start[start.length - 1] !== moves[start.length - 1]!.start_s) start.pop();
    while (start.length < moves.length) start.push(moves[start.length]!.start_s);
    return start;
  };
  return {
    id: "moves", group: "moves", name: "moves", shape: "moves",
    get start() { return known(); },
    get stops() { return known(); },
    end: (index) => moves[index]!.end_s, line: (index) => moves[index]!.line, what: (index) => moves[index]!.kind,
  };
}

function contactLane(contacts: readonly Contact[]): SpanLane {
  const start = contacts.map((contact) => contact.start_s);
  return {
    id: "contacts", group: "moves", name: "contacts", shape: "contacts", start, stops: start,
    end: (index) => contacts[index]!.end_s, line: (index) => contacts[index]!.line,
    what: (index) => `${contacts[index]!.first} – ${contacts[index]!.second}`,
  };
}

function safetyLane(run: Run, first: RunEvent): SpanLane & { modes: RunEvent[] } {
  const modes = [first];
  const start = [first.t];
  return {
    id: "safety", group: "messages", name: "safety", shape: "safety", start, stops: start, modes,
    end: (index) => start[index + 1] ?? Math.max(run.known_s, start[index]!), line: () => 0,
    what: (index) => [modes[index]!["mode"], modes[index]!["text"]].filter(Boolean).join(": "),
  };
}

type Marked = MarkLane & { events: RunEvent[]; stops: number[]; opened: number[]; closed: number[] };

function markLane(run: Run, id: string, group: Group, name: string): Marked {
  const opened: number[] = [];
  const closed: number[] = [];
  const open = { start: opened, end: (index: number) => closed[index] ?? Math.max(run.known_s, opened[index]!) };
  return { id, group, name, shape: "marks", events: [], stops: [], opened, closed, open };
}

/** Orders lanes by group; `main` and messages first, terminals before registers, outputs before inputs. */
export function inOrder(a: Lane, b: Lane): number {
  const [first, second] = [sortKey(a), sortKey(b)];
  for (let index = 0; index < first.length; index++) {
    if (first[index]! !== second[index]!) return first[index]! < second[index]! ? -1 : 1;
  }
  return 0;
}

function sortKey(lane: Lane): readonly (number | string)[] {
  const group = GROUPS.indexOf(lane.group);
  if (lane.group !== "signals") return [group, lane.id === "lines main" || lane.id === "messages" || lane.id === "moves" ? 0 : 1, 0, 0, 0];
  const [, name, index] = /^(.*?)(?:\[(\d+)\])?$/.exec(lane.name) ?? [];
  return [group, /_(in|out)$/.test(name!) ? 0 : 1, /_in$|^input_/.test(name!) ? 1 : 0, name!, Number(index ?? 0)];
}

// ---------------------------------------------------------------- entries of lists

function entryOf(event: RunEvent): Entry {
  return { t: event.t, kind: event.type, line: event.line ?? 0, thread: event.thread ?? "", text: eventText(event), event };
}

/** Returns what an event says, without its time and line. */
export function eventText(event: RunEvent): string {
  const field = (name: string) => String(event[name] ?? "");
  const joined = (...parts: readonly string[]) => parts.filter((part) => part !== "").join(": ");
  switch (event.type) {
    case "signal":
      return `${field("name")} = ${field("value")}`;
    case "channel":
      return joined(`${field("kind")} ${field("channel")} ${field("what")}`, field("data"));
    case "device":
      return joined(field("device"), field("text"));
    case "safety":
      return joined(field("mode"), field("text"));
    case "popup":
      return joined(field("title"), field("text"));
    case "alarm":
      return joined(`${field("code")} ${field("class")}`.trim(), field("text"));
    case "warning":
      return `${field("code")} ${field("text")}`.trim();
    default:
      return field("text").replace(/\n$/, "");
  }
}

function moveEntry(move: Move): Entry {
  return { t: move.start_s, kind: "move", line: move.line, thread: "", text: `${move.kind}, ${(move.end_s - move.start_s).toFixed(3)} s` };
}

function contactEntry(contact: Contact): Entry {
  return { t: contact.start_s, kind: "contact", line: contact.line, thread: "", text: `${contact.first} – ${contact.second}` };
}
