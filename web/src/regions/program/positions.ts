/** Places of texts: lines and columns from 1 in code points (messages) against offsets in UTF-16 (CodeMirror). */

import type { Text } from "@codemirror/state";
import type { Span } from "../../source/services.ts";

export type Point = Pick<Span, "line" | "column">;

/** Returns the offset of a place; of one outside of the text, the nearest inside. */
export function offsetOf(text: Text, place: Point): number {
  if (place.line < 1) return 0;
  if (place.line > text.lines) return text.length;
  const line = text.line(place.line);
  return line.from + unitsOf(line.text, place.column - 1);
}

/** Returns the place of an offset. */
export function placeOf(text: Text, offset: number): Point {
  const line = text.lineAt(offset);
  return { line: line.number, column: pointsOf(line.text.slice(0, offset - line.from)) + 1 };
}

/** Returns both offsets of a span, the second not before the first. */
export function rangeOf(text: Text, span: Span): { readonly from: number; readonly to: number } {
  const from = offsetOf(text, span);
  return { from, to: Math.max(from, offsetOf(text, { line: span.end_line, column: span.end_column })) };
}

/** Returns how many UTF-16 units the first `points` characters of a line have. */
function unitsOf(line: string, points: number): number {
  let units = 0;
  for (let point = 0; point < points && units < line.length; point++) units += line.codePointAt(units)! > 0xffff ? 2 : 1;
  return units;
}

function pointsOf(text: string): number {
  let points = 0;
  for (const _ of text) points++;
  return points;
}
