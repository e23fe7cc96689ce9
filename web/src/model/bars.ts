/**
 * What is drawn of thousands of spans, levels and marks in a few hundred pixel columns: nothing gets lost.
 *
 * Whatever is narrower than a column is counted in the column in which it begins. Times s; x in pixels from the left.
 */

/** Times ascending; a span lasts from its time until its end. */
export interface Spans {
  readonly start: readonly number[];
  readonly end: (index: number) => number;
}

/** A span of its own (`count` 1), or several that begin in one column, of which `index` is the first. */
export interface Bar {
  readonly x0: number;
  readonly x1: number;
  readonly index: number;
  readonly count: number;
}

/** Returns the first index whose time is later than `t`, from `low` on. */
export function after(times: ArrayLike<number>, t: number, low = 0): number {
  let high = times.length;
  while (low < high) {
    const middle = (low + high) >>> 1;
    if (times[middle]! > t) high = middle;
    else low = middle + 1;
  }
  return low;
}

/** Returns the first index whose time is not before `t`, from `low` on. */
export function atOrAfter(times: ArrayLike<number>, t: number, low = 0): number {
  let high = times.length;
  while (low < high) {
    const middle = (low + high) >>> 1;
    if (times[middle]! >= t) high = middle;
    else low = middle + 1;
  }
  return low;
}

/** Returns what to draw of spans that do not overlap, for a view of `width` columns. */
export function bars(spans: Spans, from_s: number, to_s: number, width: number): Bar[] {
  const found: Bar[] = [];
  const scale = width / (to_s - from_s);
  const { start, end } = spans;
  let index = Math.max(after(start, from_s) - 1, 0);
  while (index < start.length && end(index) < from_s) index++;
  while (index < start.length && start[index]! <= to_s) {
    const x0 = Math.max((start[index]! - from_s) * scale, 0);
    const x1 = Math.min((end(index) - from_s) * scale, width);
    if (x1 - x0 >= 1) {
      found.push({ x0, x1, index, count: 1 });
      index++;
      continue;
    }
    const column = Math.min(Math.floor(x0), width - 1);
    let next = Math.max(atOrAfter(start, from_s + (column + 1) / scale, index), index + 1);
    // The last one of a column may be wide.
    if (next - 1 > index && (end(next - 1) - start[next - 1]!) * scale >= 1) next--;
    found.push({ x0: column, x1: column + 1, index, count: next - index });
    index = next;
  }
  return found;
}

/** The changes of a level in one column: levels before and after them, and the lowest and highest of all of these. */
export interface LevelStep {
  readonly x: number;
  readonly before: number;
  readonly after: number;
  readonly low: number;
  readonly high: number;
  readonly count: number;
}

/** Returns the level at the begin of the view, and its changes in it, at most one for each column. */
export function levelSteps(times: readonly number[], levels: readonly number[], from_s: number, to_s: number, width: number): { first: number; steps: LevelStep[] } {
  const scale = width / (to_s - from_s);
  let index = after(times, from_s);
  let before = levels[Math.max(index - 1, 0)] ?? 0;
  const first = before;
  const steps: LevelStep[] = [];
  while (index < times.length && times[index]! <= to_s) {
    const x = (times[index]! - from_s) * scale;
    const next = Math.max(atOrAfter(times, from_s + (Math.floor(x) + 1) / scale, index), index + 1);
    let low = before;
    let high = before;
    for (let change = index; change < next; change++) {
      low = Math.min(low, levels[change]!);
      high = Math.max(high, levels[change]!);
    }
    steps.push({ x, before, after: levels[next - 1]!, low, high, count: next - index });
    before = levels[next - 1]!;
    index = next;
  }
  return { first, steps };
}

/** Marks nearer to each other than `gap` are one, of their heaviest kind, at the first of that kind. */
export interface Mark {
  readonly x: number;
  readonly index: number;
  readonly count: number;
}

/** Returns the marks of a view. `weight`: of each; heavier ones stay, and are drawn last. */
export function marks(times: readonly number[], weight: (index: number) => number, from_s: number, to_s: number, width: number, gap: number): Mark[] {
  const scale = width / (to_s - from_s);
  const found: Mark[] = [];
  let index = atOrAfter(times, from_s);
  while (index < times.length && times[index]! <= to_s) {
    const next = Math.max(atOrAfter(times, times[index]! + gap / scale, index), index + 1);
    const end = Math.min(next, after(times, to_s));
    let heaviest = index;
    for (let other = index + 1; other < end; other++) if (weight(other) > weight(heaviest)) heaviest = other;
    found.push({ x: (times[heaviest]! - from_s) * scale, index: heaviest, count: end - index });
    index = end;
  }
  return found.sort((a, b) => weight(a.index) - weight(b.index));
}
