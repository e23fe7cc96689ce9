/** A source that has everything already: a recording of one run, which it says again and answers questions from. */

import { runOf } from "../model/compare.ts";
import { lastAtOrBefore, type Run } from "../model/run.ts";
import { text } from "../text/text.ts";
import type { FromSource, Moment, Six, ThreadState, ToSource, Value, VariableState } from "./messages.ts";
import type { RecordedRun } from "./recording.ts";
import { type Column, TICK_S } from "./rows.ts";
import type { Listener, Source } from "./source.ts";

export class RecordedSource implements Source {
  private readonly recorded: RecordedRun;
  private readonly run: Run;
  private listener: Listener | null = null;
  private last: Moment | null = null;
  /** The answer before: globals that differ from it are marked as changed. */
  private shown: Moment | null = null;

  constructor(recorded: RecordedRun) {
    this.recorded = recorded;
    this.run = runOf(recorded);
  }

  start(listener: Listener): void {
    this.listener = listener;
    listener.linked("open");
    for (const message of this.recorded.said) {
      if (message.type === "run_ended") {
        this.last = message.moment;
        listener.rows(this.recorded.rows);
      }
      listener.message(message);
    }
  }

  send(message: ToSource): void {
    switch (message.type) {
      case "seek":
        this.answer({ type: "state", ask: message.ask, run: message.run, moment: this.momentAt(message.t) });
        return;
      case "step": {
        const t = this.beginBeside(message.t, message.by, message.thread);
        if (t === null) this.answer({ type: "refused", ask: message.ask, text: text(message.by > 0 ? "last_statement" : "first_statement") });
        else this.answer({ type: "state", ask: message.ask, run: message.run, moment: this.momentAt(t) });
        return;
      }
      case "detail":
        // All rows that there are have been said.
        this.answer({ type: "detail_ended", ask: message.ask, run: message.run });
        return;
      default:
        if ("ask" in message) this.answer({ type: "refused", ask: message.ask, text: text("recorded_only") });
    }
  }

  close(): void {
    this.listener = null;
  }

  /** Answers after the question was sent, as every source does. */
  private answer(message: FromSource): void {
    queueMicrotask(() => this.listener?.message(message));
  }

  /** The next or previous time at which a thread comes to a line; what takes no time is not recorded. */
  private beginBeside(t: number, by: 1 | -1, thread: string): number | null {
    const times = this.run.lines.get(thread)?.t ?? [];
    const here = lastAtOrBefore(times, t);
    if (by > 0) return times[here + 1] ?? (this.last !== null && t < this.last.t - TICK_S / 4 ? this.last.t : null);
    const isAtBegin = here >= 0 && Math.abs(times[here]! - t) < TICK_S / 4;
    return times[isAtBegin ? here - 1 : here] ?? null;
  }

  private momentAt(t: number): Moment {
    if (this.shown !== null && this.shown.t === t) return this.shown;
    const { first } = this.recorded;
    let found: Moment;
    if (this.last !== null && t > this.last.t - TICK_S / 4) found = this.last;
    else if (first !== null && t < first.t + TICK_S / 4) found = first;
    else found = this.between(t);
    const before = this.shown;
    if (before !== null) found = { ...found, globals: found.globals.map((item) => ({ ...item, changed: valueOf(before, item.name) !== item.value })) };
    this.shown = found;
    return found;
  }

  private between(t: number): Moment {
    const value = (name: Column) => this.run.samples.value(name, t);
    const joints: Six = [value("q1"), value("q2"), value("q3"), value("q4"), value("q5"), value("q6")];
    const tcp_pose: Six = [value("x"), value("y"), value("z"), value("rx"), value("ry"), value("rz")];
    const threads = this.threadsAt(t);
    return { t, line: threads[0]?.line ?? 0, joints, tcp_pose, globals: this.globalsAt(t), signals: this.signalsAt(t), threads };
  }

  private globalsAt(t: number): VariableState[] {
    const found: VariableState[] = [];
    for (const { name, t: times, value, type } of this.recorded.globals) {
      const index = lastAtOrBefore(times, t);
      if (index >= 0) found.push({ name, value: value[index]!, type: type[index]!, changed: false });
    }
    return found;
  }

  private signalsAt(t: number): Record<string, Value> {
    const found: Record<string, Value> = { ...this.recorded.first?.signals };
    for (const [name, changes] of this.run.signals) {
      const value = changes.value[lastAtOrBefore(changes.t, t)];
      // The default of every signal is off or zero.
      if (value === false || value === 0) delete found[name];
      else if (value !== undefined) found[name] = value;
    }
    return found;
  }

  private threadsAt(t: number): ThreadState[] {
    const found: ThreadState[] = [];
    for (const name of this.run.lines.keys()) {
      const line = this.run.lineAt(t, name);
      if (line === 0 && name !== "main") continue;
      const waits = this.recorded.waits.find(({ thread }) => thread === name);
      found.push({ name, line, waits_for: waits?.value[lastAtOrBefore(waits.t, t)] ?? "", function: "" });
    }
    return found;
  }
}

function valueOf(moment: Moment, name: string): string | undefined {
  return moment.globals.find((variable) => variable.name === name)?.value;
}
