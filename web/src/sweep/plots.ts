/** The plots of a sweep with uPlot: a histogram, and points of any two quantities. uPlot draws the axes and enlarges. */

import uPlot from "uplot";
import "uplot/dist/uPlot.min.css";
import type { Palette } from "../style/palette.ts";
import type { Column } from "./data.ts";
import { axisOf, nearestRow, shown, spread, type Bins } from "./numbers.ts";
import type { State } from "./state.ts";

const FONT = "11px system-ui, sans-serif";
const LABEL = "12px system-ui, sans-serif";

/** Colours of holding runs, and of failing ones by the place of their kind. */
export function colours(palette: Palette): { readonly holding: string; readonly failing: readonly string[] } {
  const [, red, green, violet] = palette.joints;
  return { holding: palette.accent, failing: [palette.error, palette.warning, violet!, green!, red!, palette.ink] };
}

/** Shapes by the place of the kind, so that colour is not all there is. */
export const SHAPES = ["cross", "triangle", "square", "diamond", "plus", "ring"] as const;
export type Shape = (typeof SHAPES)[number];

export function drawShape(g: CanvasRenderingContext2D, shape: Shape, x: number, y: number, r: number): void {
  g.beginPath();
  switch (shape) {
    case "cross":
      g.moveTo(x - r, y - r), g.lineTo(x + r, y + r), g.moveTo(x + r, y - r), g.lineTo(x - r, y + r);
      break;
    case "plus":
      g.moveTo(x - r, y), g.lineTo(x + r, y), g.moveTo(x, y - r), g.lineTo(x, y + r);
      break;
    case "triangle":
      g.moveTo(x, y - r), g.lineTo(x + r, y + r), g.lineTo(x - r, y + r), g.closePath();
      break;
    case "square":
      g.rect(x - r, y - r, 2 * r, 2 * r);
      break;
    case "diamond":
      g.moveTo(x, y - r), g.lineTo(x + r, y), g.lineTo(x, y + r), g.lineTo(x - r, y), g.closePath();
      break;
    case "ring":
      g.arc(x, y, r, 0, 2 * Math.PI);
  }
  g.stroke();
}

function axis(palette: Palette, label: string, column: Column | null, side: "x" | "y"): uPlot.Axis {
  const labels = column?.labels ?? null;
  return {
    label, labelSize: 18, labelGap: 2, labelFont: LABEL, font: FONT, stroke: palette.faint, size: side === "x" ? 28 : 58, gap: 4,
    grid: { stroke: palette.line, width: 1 }, ticks: { stroke: palette.line, width: 1, size: 4 },
    splits: labels === null ? undefined! : () => labels.map((_, index) => index),
    values: labels === null ? (_, splits) => splits.map((value) => shown(value)) : (_, splits) => splits.map((index) => cut(labels[index] ?? "")),
  };
}

function cut(words: string): string {
  return words.length > 14 ? `${words.slice(0, 13)}…` : words;
}

interface Size {
  readonly width: number;
  readonly height: number;
}

export function histogram(parent: HTMLElement, size: Size, bins: Bins, column: Column, words: { readonly x: string; readonly y: string }, palette: Palette): uPlot {
  const { holding, failing } = colours(palette);
  const { edges } = bins;
  const top = Math.max(1, ...bins.holding.map((count, index) => count + bins.failing[index]!));
  const bars = (plot: uPlot) => {
    const g = plot.ctx;
    const zero = plot.valToPos(0, "y", true);
    g.save();
    g.beginPath();
    g.rect(plot.bbox.left, plot.bbox.top, plot.bbox.width, plot.bbox.height);
    g.clip();
    bins.holding.forEach((count, index) => {
      const left = plot.valToPos(edges[index]!, "x", true);
      const width = Math.max(plot.valToPos(edges[index + 1]!, "x", true) - left - 1, 1);
      const middle = plot.valToPos(count, "y", true);
      const upper = plot.valToPos(count + bins.failing[index]!, "y", true);
      g.fillStyle = holding;
      g.globalAlpha = 0.75;
      g.fillRect(left, middle, width, zero - middle);
      g.globalAlpha = 1;
      g.fillStyle = failing[0]!;
      // A single failure among many runs is seen too.
      if (bins.failing[index]! > 0) g.fillRect(left, Math.min(upper, middle - 2 * devicePixelRatio), width, Math.max(middle - upper, 2 * devicePixelRatio));
    });
    g.restore();
  };
  const options: uPlot.Options = {
    ...size, legend: { show: false }, cursor: { show: false }, padding: [8, 12, 0, 0],
    scales: { x: { time: false, range: [edges[0]!, edges.at(-1)!] }, y: { range: [0, top * 1.05] } },
    axes: [axis(palette, words.x, column, "x"), axis(palette, words.y, null, "y")],
    series: [{}, { paths: () => null, points: { show: false } }], hooks: { draw: [bars] },
  };
  return new uPlot(options, [[edges[0]!, edges.at(-1)!], [0, top]], parent);
}

/** Points of two quantities. Dragging enlarges, a double click shows everything again, a click chooses the nearest run. */
export class Scatter {
  readonly plot: uPlot;
  private readonly x: Float64Array;
  private readonly y: Float64Array;
  private readonly state: State;

  constructor(parent: HTMLElement, size: Size, state: State, words: { readonly x: string; readonly y: string }, palette: Palette, onZoom: (isEnlarged: boolean) => void) {
    this.state = state;
    const across = axisOf(state.across.value);
    const up = axisOf(state.up.value);
    this.x = placed(across.column, 1);
    this.y = placed(up.column, 2);
    const draw = (plot: uPlot) => this.draw(plot, palette);
    const options: uPlot.Options = {
      ...size, legend: { show: false }, padding: [8, 12, 0, 0],
      cursor: { x: false, y: false, points: { show: false }, drag: { x: true, y: true, setScale: true, dist: 6 } },
      scales: { x: { time: false, range: (_, least, most) => fitted(least, most) }, y: { range: (_, least, most) => fitted(least, most) } },
      axes: [axis(palette, words.x, across.column, "x"), axis(palette, words.y, up.column, "y")],
      series: [{}, { paths: () => null, points: { show: false } }],
      hooks: {
        draw: [draw],
        setScale: [(plot) => onZoom((plot.scales["x"]!.max! - plot.scales["x"]!.min!) < (across.most - across.least) * 0.999 || (plot.scales["y"]!.max! - plot.scales["y"]!.min!) < (up.most - up.least) * 0.999)],
      },
    };
    this.plot = new uPlot(options, [[across.least, across.most], [up.least, up.most]], parent);
    const over = this.plot.over;
    let pressed: readonly [number, number] = [0, 0];
    over.addEventListener("pointerdown", (event) => (pressed = [event.clientX, event.clientY]));
    over.addEventListener("click", (event) => {
      if (Math.hypot(event.clientX - pressed[0], event.clientY - pressed[1]) > 5) return;
      const box = over.getBoundingClientRect();
      this.choose(event.clientX - box.left, event.clientY - box.top);
    });
  }

  /** Shows everything again. */
  reset(): void {
    this.plot.setData(this.plot.data, true);
  }

  private choose(left: number, top: number): void {
    const { plot, state } = this;
    const x = Float64Array.from(this.x, (value) => plot.valToPos(value, "x"));
    const y = Float64Array.from(this.y, (value) => plot.valToPos(value, "y"));
    const row = nearestRow(x, y, state.kinds, [left, top]);
    if (row >= 0) state.choose(state.runs[row]!);
  }

  private draw(plot: uPlot, palette: Palette): void {
    const { state } = this;
    const { holding, failing } = colours(palette);
    const g = plot.ctx;
    const { left, top, width, height } = plot.bbox;
    const ratio = devicePixelRatio;
    const rows = this.x.length;
    g.save();
    g.beginPath();
    g.rect(left, top, width, height);
    g.clip();
    // The scales are linear: two points give the line, and 100,000 calls are saved.
    const [x0, kx] = line((value) => plot.valToPos(value, "x", true), plot.scales["x"]!);
    const [y0, ky] = line((value) => plot.valToPos(value, "y", true), plot.scales["y"]!);
    const side = (rows > 20_000 ? 1.5 : rows > 2000 ? 2.5 : 4) * ratio;
    g.globalAlpha = rows > 2000 ? 0.45 : 0.65;
    g.fillStyle = holding;
    for (let row = 0; row < rows; row++) {
      if (state.kinds[row]! >= 0) continue;
      g.fillRect(x0 + kx * this.x[row]! - side / 2, y0 + ky * this.y[row]! - side / 2, side, side);
    }
    g.globalAlpha = 1;
    g.lineWidth = 1.4 * ratio;
    for (const row of state.failing) {
      const place = state.colourOf(row);
      g.strokeStyle = failing[place]!;
      drawShape(g, SHAPES[place]!, x0 + kx * this.x[row]!, y0 + ky * this.y[row]!, (state.failing.length > 2000 ? 2 : 3.5) * ratio);
    }
    const chosen = state.row.value;
    if (chosen >= 0) {
      g.lineWidth = 2 * ratio;
      g.strokeStyle = palette.ink;
      drawShape(g, "ring", x0 + kx * this.x[chosen]!, y0 + ky * this.y[chosen]!, 8 * ratio);
    }
    g.restore();
  }
}

function placed(column: Column, salt: number): Float64Array {
  return Float64Array.from(column.values, (value, row) => (column.labels === null ? value : value + spread(row, salt)));
}

/** The range of a scale as it was given; uPlot widens one of no width, which cannot happen here. */
function fitted(least: number | null, most: number | null): [number, number] {
  return [least ?? 0, most ?? 1];
}

function line(place: (value: number) => number, { min, max }: uPlot.Scale): readonly [number, number] {
  const slope = (place(max!) - place(min!)) / (max! - min!);
  return [place(min!) - slope * min!, slope];
}

