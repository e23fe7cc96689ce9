/** Differences of two texts by line. */

export interface LinePair {
  /** Line numbers from 1; null where the other text has the line alone. */
  readonly first: number | null;
  readonly second: number | null;
  readonly text: string;
}

/** Longest stretch in which common lines are searched; what is longer counts as changed as a whole. */
const SEARCHED_MAX = 2000;

/** Lines of two texts beside each other: a longest common sequence between equal beginnings and ends. */
export function pairLines(first: string, second: string): LinePair[] {
  const a = first.split("\n");
  const b = second.split("\n");
  let head = 0;
  while (head < a.length && head < b.length && a[head] === b[head]) head++;
  let tail = 0;
  while (tail < a.length - head && tail < b.length - head && a[a.length - 1 - tail] === b[b.length - 1 - tail]) tail++;
  const pairs: LinePair[] = [];
  for (let i = 0; i < head; i++) pairs.push({ first: i + 1, second: i + 1, text: a[i]! });
  pairs.push(...common(a.slice(head, a.length - tail), b.slice(head, b.length - tail), head));
  for (let i = tail; i > 0; i--) pairs.push({ first: a.length - i + 1, second: b.length - i + 1, text: a[a.length - i]! });
  return pairs;
}

/** The lines of the first text by those of the second, where they are the same. */
export function lineMap(first: string, second: string): Map<number, number> {
  const found = new Map<number, number>();
  for (const pair of pairLines(first, second)) if (pair.first !== null && pair.second !== null) found.set(pair.second, pair.first);
  return found;
}

/** First line of the second text that differs from the first; 0 if they are equal. */
export function firstChange(first: string, second: string): number {
  if (first === second) return 0;
  const a = first.split("\n");
  const b = second.split("\n");
  let line = 0;
  while (line < a.length && line < b.length && a[line] === b[line]) line++;
  return line + 1;
}

function common(a: readonly string[], b: readonly string[], head: number): LinePair[] {
  const pairs: LinePair[] = [];
  const isLong = a.length * b.length > SEARCHED_MAX * SEARCHED_MAX;
  // length[i][j]: of the longest common sequence of a[i..] and b[j..].
  const width = b.length + 1;
  const length = new Uint16Array(isLong ? 0 : (a.length + 1) * width);
  if (!isLong) {
    for (let i = a.length - 1; i >= 0; i--) {
      for (let j = b.length - 1; j >= 0; j--) {
        length[i * width + j] =
          a[i] === b[j] ? length[(i + 1) * width + j + 1]! + 1 : Math.max(length[(i + 1) * width + j]!, length[i * width + j + 1]!);
      }
    }
  }
  let i = 0;
  let j = 0;
  while (i < a.length || j < b.length) {
    if (!isLong && i < a.length && j < b.length && a[i] === b[j]) {
      pairs.push({ first: head + i + 1, second: head + j + 1, text: a[i]! });
      i++;
      j++;
    } else if (j >= b.length || (i < a.length && (isLong || length[(i + 1) * width + j]! >= length[i * width + j + 1]!))) {
      pairs.push({ first: head + i + 1, second: null, text: a[i]! });
      i++;
    } else {
      pairs.push({ first: null, second: head + j + 1, text: b[j]! });
      j++;
    }
  }
  return pairs;
}
