/** The stretch of time in view of a time line, and the one that is selected in it. */

import { computed, signal } from "@preact/signals-core";
import type { Stretch } from "./playback.ts";

/** The shortest view, s. */
export const VIEW_LEAST_S = 0.02;

/** The view of a source whose time goes on by itself, s. */
export const WINDOW_S = 60;

export class TimeView {
  /** Zoomed to; null: all there is. */
  private readonly zoomed = signal<Stretch | null>(null);
  readonly whole = signal<Stretch>([0, 0]);
  readonly selected = signal<Stretch | null>(null);

  /** From and to, within what there is; never of no length. */
  readonly range = computed<Stretch>(() => {
    const [begin, end] = this.whole.value;
    const zoomed = this.zoomed.value;
    const length = zoomed === null ? Infinity : zoomed[1] - zoomed[0];
    if (zoomed === null || length >= end - begin) return [begin, Math.max(end, begin + VIEW_LEAST_S)];
    const from = Math.min(Math.max(zoomed[0], begin), end - length);
    return [from, from + length];
  });

  readonly isWhole = computed(() => this.zoomed.value === null);

  /** Takes what there is: from 0, or the last minute of what goes on by itself. */
  extend(end_s: number, isLive: boolean): void {
    this.whole.value = [isLive ? Math.max(0, end_s - WINDOW_S) : 0, end_s];
  }

  /** Shows a stretch, as far as there is one. */
  show(from_s: number, to_s: number): void {
    const [begin, end] = this.whole.value;
    const length = Math.max(to_s - from_s, VIEW_LEAST_S);
    if (length >= end - begin) {
      this.fit();
      return;
    }
    const from = Math.min(Math.max(from_s, begin), end - length);
    this.zoomed.value = [from, from + length];
  }

  fit(): void {
    this.zoomed.value = null;
  }

  /** Zooms in (below 1) or out about a time that stays where it is. */
  zoom(about_s: number, factor: number): void {
    const [from, to] = this.range.value;
    const length = Math.max((to - from) * factor, VIEW_LEAST_S);
    const share = to > from ? (about_s - from) / (to - from) : 0.5;
    this.show(about_s - share * length, about_s + (1 - share) * length);
  }

  /** Moves by a share of what is in view. */
  pan(share: number): void {
    const [from, to] = this.range.value;
    this.show(from + share * (to - from), to + share * (to - from));
  }

  /** Moves as little as it takes to have a time in view. */
  reveal(t: number): void {
    const [from, to] = this.range.value;
    if (t < from) this.show(t - 0.1 * (to - from), t + 0.9 * (to - from));
    else if (t > to) this.show(t - 0.1 * (to - from), t + 0.9 * (to - from));
  }

  /** Selects a stretch; one of no length selects nothing. */
  select(from_s: number, to_s: number): void {
    const [begin, end] = this.whole.value;
    const from = Math.max(Math.min(from_s, to_s), begin);
    const to = Math.min(Math.max(from_s, to_s), end);
    this.selected.value = to - from >= VIEW_LEAST_S ? [from, to] : null;
  }
}

/** Returns the times of ticks of an axis: whole multiples of 1, 2 or 5 times a power of ten, at most `most` of them, and their decimals. */
export function axisTicks(from: number, to: number, most: number): { readonly at: readonly number[]; readonly decimals: number } {
  const rough = (to - from) / Math.max(1, most);
  if (!(rough > 0) || !Number.isFinite(rough)) return { at: [], decimals: 0 };
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map((digit) => digit * power).find((each) => each >= rough * 0.999) ?? 10 * power;
  const decimals = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  const at: number[] = [];
  for (let index = Math.ceil(from / step - 1e-9); index * step <= to + step * 1e-9; index++) at.push(Number((index * step).toFixed(decimals)));
  return { at, decimals };
}
