/** Draws lanes: what is in view of one, in one row of a canvas. */

import { bars, levelSteps, marks } from "../../model/bars.ts";
import { indexAt, markKind, markWeight, type Lane, type LevelLane, type MarkLane, type SpanLane } from "../../model/lanes.ts";
import type { Stretch } from "../../model/playback.ts";
import type { Palette } from "../../style/palette.ts";
import { drawSign, hatch, HATCHINGS, type Tint } from "./looks.ts";

export const SANS = "system-ui, -apple-system, 'Segoe UI', Roboto, 'Noto Sans', sans-serif";

export interface Drawing {
  readonly g: CanvasRenderingContext2D;
  /** Pixels of the canvas for one of the page. */
  readonly ratio: number;
  readonly palette: Palette;
  readonly tints: readonly Tint[];
  readonly view: Stretch;
  /** Of the stretch in view, px. */
  readonly width: number;
  /** Line that is pointed at: its spans are raised; 0: none. */
  readonly raised: number;
  /** Place of a line among those of the program, for its look. */
  readonly order: (line: number) => number;
  readonly sourceLine: (line: number) => string;
}

/** Marks nearer than this are drawn as one, px. */
const GAP = 7;

const KINDS = ["movej", "movel", "movep", "movec", "speedj", "speedl", "servoj", "servoc"];

/** Draws a lane in a row. */
export function drawLane(drawing: Drawing, lane: Lane, top: number, height: number): void {
  switch (lane.shape) {
    case "levels":
      drawLevels(drawing, lane, top, height);
      return;
    case "marks":
      drawMarks(drawing, lane, top, height);
      return;
    default:
      drawSpans(drawing, lane, top, height);
  }
}

/** Draws lines of the grid at whole times. */
export function drawGrid({ g, palette, view, width }: Drawing, times: readonly number[], height: number): void {
  g.strokeStyle = palette.line;
  g.lineWidth = 1;
  g.globalAlpha = 0.6;
  g.beginPath();
  for (const t of times) {
    const x = Math.round(((t - view[0]) / (view[1] - view[0])) * width) + 0.5;
    g.moveTo(x, 0);
    g.lineTo(x, height);
  }
  g.stroke();
  g.globalAlpha = 1;
}

function drawSpans(drawing: Drawing, lane: SpanLane, top: number, height: number): void {
  const { g, palette, view, width, ratio, raised, tints: all } = drawing;
  const y = top + 2.5;
  const h = height - 5;
  g.font = `11.5px ${SANS}`;
  g.textBaseline = "middle";
  g.textAlign = "left";
  for (const { x0, x1, index, count } of bars(lane, view[0], view[1], width)) {
    const line = lane.line(index);
    if (lane.shape === "lines" && line === 0 && count === 1) continue;
    const isRaised = raised > 0 && (line === raised || (count > 1 && hasLine(lane, index, count, raised)));
    g.globalAlpha = raised > 0 && !isRaised ? 0.35 : 1;
    if (count > 1) {
      // Several in one pixel: a dense column, taller where there are more.
      g.fillStyle = isRaised ? palette.accent : palette.faint;
      const part = Math.min(1, 0.55 + 0.08 * count);
      g.fillRect(x0, y + (h * (1 - part)) / 2, 1, h * part);
      continue;
    }
    const look = lookOf(drawing, lane, index);
    const { fill, edge } = lane.shape === "contacts" ? { fill: palette.error_ground, edge: palette.error } : all[look % all.length]!;
    const w = x1 - x0;
    if (w < 3) {
      g.fillStyle = isRaised ? palette.accent : edge;
      g.fillRect(x0, y, Math.max(w, 1), h);
      continue;
    }
    g.fillStyle = fill;
    g.fillRect(x0, y, w - 0.5, h);
    const hatching = lane.shape === "contacts" ? 1 : look % HATCHINGS;
    if (hatching > 0) {
      g.globalAlpha *= 0.3;
      g.fillStyle = hatch(g, hatching, edge, ratio);
      g.fillRect(x0, y, w - 0.5, h);
      g.globalAlpha = raised > 0 && !isRaised ? 0.35 : 1;
    }
    g.fillStyle = isRaised ? palette.accent : edge;
    g.fillRect(x0, y, Math.min(1.5, w / 3), h);
    if (isRaised) {
      g.strokeStyle = palette.accent;
      g.lineWidth = 1.5;
      g.strokeRect(x0 + 0.75, y, w - 1.5, h);
    }
    const label = spanLabel(drawing, lane, index, w - 7);
    if (label !== "") {
      g.fillStyle = palette.ink;
      g.fillText(label, x0 + 4.5, y + h / 2 + 0.5);
    }
  }
  g.globalAlpha = 1;
}

function hasLine(lane: SpanLane, index: number, count: number, line: number): boolean {
  for (let other = index; other < index + count; other++) if (lane.line(other) === line) return true;
  return false;
}

function lookOf(drawing: Drawing, lane: SpanLane, index: number): number {
  if (lane.shape === "lines") return drawing.order(lane.line(index));
  const found = KINDS.indexOf(lane.what(index));
  return found < 0 ? (lane.shape === "safety" && lane.what(index).startsWith("NORMAL") ? 2 : 1) : found;
}

/** Returns the longest label of a span that fits: number and text of a line, or the number alone; empty if none does. */
function spanLabel({ g, sourceLine }: Drawing, lane: SpanLane, index: number, room: number): string {
  if (room < 6) return "";
  const short = lane.shape === "lines" ? String(lane.line(index)) : lane.what(index);
  if (lane.shape === "lines" && room > 60) {
    const whole = `${short}  ${sourceLine(lane.line(index))}`;
    return fitted(g, whole, room);
  }
  return g.measureText(short).width <= room ? short : room > 40 ? fitted(g, short, room) : "";
}

/** Returns the begin of a text that fits, with an ellipsis. */
export function fitted(g: CanvasRenderingContext2D, text: string, room: number): string {
  if (g.measureText(text).width <= room) return text;
  let low = 0;
  let high = Math.min(text.length, Math.ceil(room / 3));
  while (low < high) {
    const middle = (low + high + 1) >>> 1;
    if (g.measureText(`${text.slice(0, middle)}…`).width <= room) low = middle;
    else high = middle - 1;
  }
  return low === 0 ? "" : `${text.slice(0, low)}…`;
}

function drawLevels({ g, palette, view, width }: Drawing, lane: LevelLane, top: number, height: number): void {
  const [low, high] = lane.isBit ? [0, 1] : range(lane.value);
  const bottom = top + height - 4;
  const y = (value: number) => bottom - (height - 8) * (high > low && Number.isFinite(value) ? (value - low) / (high - low) : 0);
  const { first, steps } = levelSteps(lane.start, lane.value, view[0], view[1], width);
  const scale = width / (view[1] - view[0]);
  const begin = (Math.max(lane.start[0]!, view[0]) - view[0]) * scale;
  const end = (Math.min(lane.end(), view[1]) - view[0]) * scale;
  if (end <= begin) return;
  const outline = new Path2D();
  const area = new Path2D();
  const dense = new Path2D();
  outline.moveTo(begin, y(first));
  let from = begin;
  for (const step of steps) {
    outline.lineTo(step.x, y(step.before));
    area.rect(from, y(step.before), step.x - from, bottom - y(step.before));
    from = step.x;
    // A column in which it changes more than once is filled from the lowest to the highest level.
    if (step.count > 1) dense.rect(Math.floor(step.x), y(step.high), 1, y(step.low) - y(step.high));
    if (step.count > 1) outline.moveTo(step.x, y(step.after));
    else outline.lineTo(step.x, y(step.after));
  }
  const last = y(steps.at(-1)?.after ?? first);
  outline.lineTo(end, last);
  area.rect(from, last, end - from, bottom - last);
  g.fillStyle = g.strokeStyle = palette.good;
  g.globalAlpha = lane.isBit ? 0.25 : 0.1;
  g.fill(area);
  g.globalAlpha = 0.5;
  g.fill(dense);
  g.globalAlpha = 1;
  g.lineWidth = 1.5;
  g.lineJoin = "round";
  g.stroke(outline);
}

/** Lowest and highest of the finite ones of many numbers; zeros of none. */
function range(values: readonly number[]): readonly [number, number] {
  let low = Infinity;
  let high = -Infinity;
  for (const value of values) {
    if (!Number.isFinite(value)) continue;
    low = Math.min(low, value);
    high = Math.max(high, value);
  }
  return low <= high ? [low, high] : [0, 0];
}

function drawMarks({ g, palette, view, width }: Drawing, lane: MarkLane, top: number, height: number): void {
  const middle = top + height / 2;
  g.fillStyle = palette.accent;
  g.globalAlpha = 0.16;
  for (const { x0, x1 } of bars(lane.open, view[0], view[1], width)) g.fillRect(x0, middle - 5, x1 - x0, 10);
  g.globalAlpha = 1;
  const weight = (index: number) => markWeight(lane.events[index]!);
  g.font = `10px ${SANS}`;
  g.textBaseline = "middle";
  g.textAlign = "left";
  for (const { x, index, count } of marks(lane.stops, weight, view[0], view[1], width, GAP)) {
    drawSign(g, markKind(lane.events[index]!), x, middle, palette);
    if (count > 1) {
      // A tick above says that there is more than one.
      g.fillStyle = palette.faint;
      g.fillRect(x - 4, top + 1, Math.min(8, 1 + count), 1.5);
    }
  }
}

/** Returns the text of a lane at a time, for the names on the left. */
export function laneValue(lane: Lane, t: number): string {
  if (lane.shape === "marks") return "";
  const index = indexAt(lane, t);
  if (index < 0) return "";
  if (lane.shape === "levels") return levelText(lane, index);
  return lane.shape === "lines" ? (lane.line(index) > 0 ? String(lane.line(index)) : "") : lane.what(index).replace(/:.*/, "");
}

export function levelText(lane: LevelLane, index: number): string {
  const value = lane.value[index] ?? NaN;
  if (lane.isBit) return value === 0 ? "0" : "1";
  return Number.isInteger(value) ? String(value) : String(Number(value.toPrecision(5)));
}
