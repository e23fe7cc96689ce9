/** Moves the cursor of a run by itself: in real time or slower or faster, over and over through a stretch. */

import { effect, signal, type ReadonlySignal, type Signal } from "@preact/signals-core";
import type { RunEvent } from "../source/messages.ts";
import type { Run } from "./run.ts";
import { TICK_S } from "../source/rows.ts";

/** Rates that people choose from; 1 is real time. */
export const RATES: readonly number[] = [0.25, 0.5, 1, 2, 5, 10];

/** A longer pause between two frames is that of a page that was hidden: playback goes on from where it was. */
const FRAME_LONGEST_S = 0.5;

/** How often the source is asked for the exact state while the cursor moves. */
const EXACT_EACH_MS = 100;

/** From and to, s. */
export type Stretch = readonly [number, number];

/** What playback moves; `Studio` is one. */
export interface Played {
  readonly run: ReadonlySignal<Run | null>;
  readonly cursor: ReadonlySignal<number>;
  readonly isPlaying: Signal<boolean>;
  readonly rate: ReadonlySignal<number>;
  /** Shows a time; `asks`: for the exact state too. */
  advance(t: number, asks: boolean): void;
  /** Shows the tick that is nearest to a time; the exact state follows. */
  setCursor(t: number): void;
}

/** `requestAnimationFrame` and `cancelAnimationFrame`. */
export interface Frames {
  request(frame: (now_ms: number) => void): number;
  cancel(handle: number): void;
}

/** Takes what happened after one time and until another, each event once; of a jump of the cursor nothing. */
export type PassedListener = (events: readonly RunEvent[], from_s: number, to_s: number) => void;

export class Playback {
  /** The stretch that is played over and over; null: the whole run, once. */
  readonly loop = signal<Stretch | null>(null);
  /** Whether it waits for the run to be computed further. */
  readonly isHeld = signal(false);
  private readonly played: Played;
  private readonly frames: Frames;
  private readonly listeners = new Set<PassedListener>();
  private handle: number | null = null;
  private last_ms: number | null = null;
  private exact_ms = -Infinity;
  private shown = NaN;
  private readonly dispose: () => void;

  constructor(played: Played, frames: Frames) {
    this.played = played;
    this.frames = frames;
    this.dispose = effect(() => {
      if (played.isPlaying.value) this.begin();
      else this.end();
    });
  }

  close(): void {
    this.dispose();
    this.end();
  }

  /** Calls a listener with the events that playback passes; returns what ends that. */
  listen(listener: PassedListener): () => void {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  }

  private begin(): void {
    if (this.handle !== null) return;
    this.last_ms = null;
    this.shown = NaN;
    this.handle = this.frames.request(this.frame);
  }

  private end(): void {
    if (this.handle === null) return;
    this.frames.cancel(this.handle);
    this.handle = null;
    this.isHeld.value = false;
    // At rest the cursor is at a control period, of which the source knows the exact state.
    this.played.setCursor(this.played.cursor.peek());
  }

  private readonly frame = (now_ms: number): void => {
    this.handle = this.frames.request(this.frame);
    const passed_s = this.last_ms === null ? 0 : Math.min(Math.max(now_ms - this.last_ms, 0) / 1000, FRAME_LONGEST_S);
    this.last_ms = now_ms;
    this.advance(passed_s * this.played.rate.peek(), now_ms);
  };

  /** Moves the cursor on, through the end of the loop as often as it takes. */
  private advance(passed_s: number, now_ms: number): void {
    const run = this.played.run.peek();
    if (run === null) return;
    const loop = loopIn(this.loop.peek(), run);
    let cursor = this.played.cursor.peek();
    if (loop !== null && (cursor < loop[0] || cursor >= loop[1])) cursor = loop[0];
    // Where the cursor has come by itself, what is at its place has been passed; elsewhere it has not.
    let from_s = cursor === this.shown ? cursor : justBefore(cursor);
    let t = cursor + passed_s;
    while (loop !== null && t >= loop[1] && run.known_s >= loop[1]) {
      this.pass(run, from_s, loop[1]);
      from_s = justBefore(loop[0]);
      t -= loop[1] - loop[0];
    }
    const isAtEnd = t >= run.known_s;
    t = Math.min(t, run.known_s);
    this.pass(run, from_s, t);
    this.show(t, now_ms);
    this.isHeld.value = isAtEnd && run.ended === null;
    if (isAtEnd && loop === null && run.ended !== null) this.played.isPlaying.value = false;
  }

  private show(t: number, now_ms: number): void {
    const asks = now_ms - this.exact_ms >= EXACT_EACH_MS;
    if (asks) this.exact_ms = now_ms;
    this.played.advance(t, asks);
    this.shown = t;
  }

  private pass(run: Run, from_s: number, to_s: number): void {
    if (this.listeners.size === 0) return;
    const passed = run.events.slice(firstAfter(run.events, from_s), firstAfter(run.events, to_s));
    for (const listener of this.listeners) listener(passed, from_s, to_s);
  }
}

/** Returns the stretch to repeat, as far as the run has it; null if it takes no time. */
function loopIn(loop: Stretch | null, run: Run): Stretch | null {
  if (loop === null) return null;
  const end_s = run.ended === null ? loop[1] : Math.min(loop[1], run.known_s);
  return end_s - loop[0] > TICK_S / 2 ? [loop[0], end_s] : null;
}

function justBefore(t: number): number {
  return t - TICK_S / 1000;
}

/** Returns the first index of an event later than `t`. */
function firstAfter(events: readonly RunEvent[], t: number): number {
  let low = 0;
  let high = events.length;
  while (low < high) {
    const middle = (low + high) >>> 1;
    if (events[middle]!.t > t) high = middle;
    else low = middle + 1;
  }
  return low;
}
