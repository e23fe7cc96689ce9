/** Two runs over each other: which lines and which times belong together. */

import type { RecordedRun } from "../source/recording.ts";
import { TICK_S } from "../source/rows.ts";
import { lineMap } from "./difference.ts";
import { Run } from "./run.ts";

/** How the times of two runs are laid over each other. */
export type Alignment = "time" | "visit";

/** Returns a recorded run as the page knows runs. */
export function runOf(recorded: RecordedRun): Run {
  const { said } = recorded;
  const began = said.find((message) => message.type === "run_began");
  const file = said.find((message) => message.type === "file");
  const run = new Run(began?.run ?? 0, began?.version ?? 0, began?.options ?? {}, file?.text ?? "", file?.tree ?? null);
  run.scene = said.find((message) => message.type === "scene") ?? null;
  for (const message of said) if (message.type !== "run_ended") run.take(message);
  run.takeRows(recorded.rows);
  for (const message of said) if (message.type === "run_ended") run.take(message);
  return run;
}

/** Returns the recording in the text of a page, in base 64; null if the text is no such page. */
export function recordingIn(text: string): string | null {
  return /<script type="text\/plain" id="recording">([A-Za-z0-9+/=\s]+)<\/script>/.exec(text)?.[1] ?? null;
}

/** Returns what a recorded run is of: the file and the arm. */
export function titleOf(recorded: RecordedRun): string {
  const hello = recorded.said.find((message) => message.type === "hello");
  const scene = recorded.said.find((message) => message.type === "scene");
  return [hello?.title, scene?.robot].filter(Boolean).join(" · ");
}

/** A time of one run, and that of the other at which it comes to the same place. */
export interface Anchor {
  readonly theirs: number;
  readonly ours: number;
}

/**
 * Returns the times at which both runs come to the same line as often as before: the n-th visit of a line here and
 * there, as many as can be in the order of both. Both begin together, and end together.
 */
export function anchors(theirs: Run, ours: Run): Anchor[] {
  const lines = lineMap(theirs.text, ours.text);
  const visits = visitsOf(theirs);
  const pairs: Anchor[] = [];
  for (const [line, times] of visitsOf(ours)) {
    const their = visits.get(theirs.text === "" || ours.text === "" ? line : (lines.get(line) ?? -1)) ?? [];
    for (let nth = 0; nth < Math.min(times.length, their.length); nth++) pairs.push({ theirs: their[nth]!, ours: times[nth]! });
  }
  pairs.sort((a, b) => a.ours - b.ours || a.theirs - b.theirs);
  return [{ theirs: 0, ours: 0 }, ...ascending(pairs.filter((pair) => pair.ours > 0 && pair.theirs > 0)), { theirs: theirs.known_s, ours: ours.known_s }];
}

/** Returns a time of ours for one of theirs: between anchors in proportion, beyond the last as much later. */
export function timeOf(t: number, along: readonly Anchor[]): number {
  let low = 0;
  let high = along.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (along[middle]!.theirs <= t) low = middle;
    else high = middle - 1;
  }
  const from = along[low]!;
  const to = along[low + 1];
  if (to === undefined) return from.ours + t - from.theirs;
  const length = to.theirs - from.theirs;
  return length <= 0 ? to.ours : from.ours + ((t - from.theirs) / length) * (to.ours - from.ours);
}

/** Returns a run with its times laid over those of another: what it did during a visit of a line stands where ours is. */
export function aligned(theirs: Run, ours: Run): Run {
  const along = anchors(theirs, ours);
  const at = (t: number) => timeOf(t, along);
  const run = new Run(theirs.number, theirs.version, theirs.options, theirs.text);
  run.scene = theirs.scene;
  run.cycle = theirs.cycle;
  run.contacts = theirs.contacts.map((contact) => ({ ...contact, t: at(contact.t), start_s: at(contact.start_s), end_s: at(contact.end_s) }));
  for (const [thread, { t, line }] of theirs.lines) run.take({ type: "lines", run: run.number, thread, t: t.map(at), line });
  for (const move of theirs.moves) run.take({ type: "moves", run: run.number, list: [{ ...move, start_s: at(move.start_s), end_s: at(move.end_s) }] });
  run.take({ type: "events", run: run.number, list: theirs.events.map((event) => ({ ...event, t: at(event.t) })) });
  run.takeRows(theirs.samples.shifted(run.number, (t) => Math.round(at(t) / TICK_S)));
  if (theirs.ended !== null) run.take({ ...theirs.ended, moment: { ...theirs.ended.moment, t: at(theirs.ended.moment.t) } });
  run.known_s = at(theirs.known_s);
  return run;
}

/** Times at which the main thread comes to each line. */
function visitsOf(run: Run): Map<number, number[]> {
  const found = new Map<number, number[]>();
  const main = run.lines.get("main");
  for (let index = 0; index < (main?.t.length ?? 0); index++) {
    const line = main!.line[index]!;
    if (line === 0) continue;
    const times = found.get(line);
    if (times === undefined) found.set(line, [main!.t[index]!]);
    else times.push(main!.t[index]!);
  }
  return found;
}

/** Returns the longest part of pairs, ascending in our time, that ascends in theirs too (patience sorting). */
function ascending(pairs: readonly Anchor[]): Anchor[] {
  const ends: number[] = [];
  const before = new Int32Array(pairs.length).fill(-1);
  for (let index = 0; index < pairs.length; index++) {
    let low = 0;
    let high = ends.length;
    while (low < high) {
      const middle = (low + high) >> 1;
      if (pairs[ends[middle]!]!.theirs < pairs[index]!.theirs && pairs[ends[middle]!]!.ours < pairs[index]!.ours) low = middle + 1;
      else high = middle;
    }
    if (low > 0) before[index] = ends[low - 1]!;
    ends[low] = index;
  }
  const found: Anchor[] = [];
  for (let index = ends.at(-1) ?? -1; index >= 0; index = before[index]!) found.push(pairs[index]!);
  return found.reverse();
}
