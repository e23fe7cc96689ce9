/** Curves over time with uPlot: joints, their speeds and accelerations, tracking errors, speed of the TCP. */

import uPlot from "uplot";
import type { Stretch } from "../../model/playback.ts";
import type { Run } from "../../model/run.ts";
import type { Column } from "../../source/rows.ts";
import type { Derived } from "../../model/samples.ts";
import type { Scene } from "../../source/messages.ts";
import type { Palette } from "../../style/palette.ts";
import { DASHES, hatch } from "./looks.ts";
import { SANS } from "./draw.ts";
import type { CURVES } from "./state.ts";

export type CurveSpec = (typeof CURVES)[number];

/** Width of the numbers on the left of a curve, and of the names on its right, px. */
export const AXIS = 54;
export const RIGHT = 34;

/** A limit nearer than this many times what is reached is in the picture. */
const NEAR = 1.8;

export interface CurveInput {
  readonly run: Run;
  readonly ghost: { readonly run: Run; readonly from_s: number } | null;
  readonly scene: Scene | null;
  readonly view: Stretch;
  readonly width: number;
  readonly height: number;
  readonly palette: Palette;
  readonly ticks: readonly number[];
  /** Factor from SI to what is shown. */
  readonly factor: number;
  readonly showsLimits: boolean;
}

/** Low and high limit of each curve, SI; null: none. */
export function limitsOf(spec: CurveSpec, scene: Scene | null): readonly (readonly [number, number] | null)[] {
  const limits = scene?.limits;
  return spec.columns.map((_, index) => {
    if (limits === undefined) return null;
    switch (spec.key) {
      case "q":
        return [limits.position_min[index]!, limits.position_max[index]!];
      case "qd":
        return [-limits.speed[index]!, limits.speed[index]!];
      case "qdd":
        return [-limits.acceleration[index]!, limits.acceleration[index]!];
      case "speed":
        return [-Infinity, limits.tcp_speed];
      default:
        return null;
    }
  });
}

export class CurveChart {
  private readonly plot: uPlot;
  private readonly spec: CurveSpec;
  private input: CurveInput;
  private range: readonly [number, number] = [0, 1];
  private rangeOf = "";
  /** The part of its nearest limit that each curve reaches; 0 without limits. */
  used: readonly number[] = [];
  private ends: readonly Float64Array[] = [];

  constructor(parent: HTMLElement, spec: CurveSpec, input: CurveInput) {
    this.spec = spec;
    this.input = input;
    const series = (isGhost: boolean) =>
      spec.columns.map((_, index): uPlot.Series => ({
        scale: "y",
        stroke: () => (isGhost ? this.input.palette.stale : this.colour(index)),
        width: isGhost ? 1 : 1.5,
        dash: isGhost ? [2, 2] : [...DASHES[spec.columns.length > 1 ? index : 0]!],
        points: { show: false },
        spanGaps: true,
      }));
    const options: uPlot.Options = {
      width: AXIS + input.width + RIGHT,
      height: input.height,
      padding: [6, RIGHT, 6, 0],
      legend: { show: false },
      cursor: { show: false },
      scales: { x: { time: false, range: () => [...this.input.view] }, y: { range: () => [...this.range] } },
      axes: [
        { size: 0, values: () => [], splits: () => [...this.input.ticks], grid: { stroke: () => this.input.palette.line, width: 1 }, ticks: { show: false } },
        {
          scale: "y", size: AXIS, gap: 4, space: 26, stroke: () => this.input.palette.faint, font: `11px ${SANS}`,
          grid: { stroke: () => this.input.palette.line, width: 1 }, ticks: { show: false },
        },
      ],
      series: [{}, ...series(true), ...series(false)],
      hooks: { drawAxes: [(plot) => this.drawLimits(plot)], draw: [(plot) => this.drawNames(plot)] },
    };
    this.plot = new uPlot(options, this.data(), parent);
    this.plot.root.setAttribute("aria-hidden", "true");
  }

  destroy(): void {
    this.plot.destroy();
  }

  update(input: CurveInput): void {
    const isResized = input.width !== this.input.width || input.height !== this.input.height;
    this.input = input;
    if (isResized) this.plot.setSize({ width: AXIS + input.width + RIGHT, height: input.height });
    this.plot.setData(this.data(), true);
  }

  private colour(index: number): string {
    const { palette } = this.input;
    return this.spec.columns.length > 1 ? palette.joints[index]! : palette.accent;
  }

  private data(): uPlot.AlignedData {
    const { run, ghost, view, width, factor } = this.input;
    this.fit();
    const names: readonly (Column | Derived)[] = this.spec.columns;
    const own = run.samples.curves(names, view[0], view[1], Math.max(Math.round(width), 10));
    const back = ghost?.run.samples.curves(names, view[0], view[1], Math.max(Math.round(width), 10));
    const scaled = (values: Float64Array) => values.map((value) => value * factor);
    if (ghost === null || back === undefined) {
      this.ends = own.values.map(scaled);
      const nothing = new Array<null>(own.t.length).fill(null);
      return [own.t, ...names.map(() => nothing), ...this.ends.map(withGaps)];
    }
    // Both on one list of times: what one of them does not have is a gap, which is bridged.
    this.ends = own.values.map(scaled);
    const from = ghost.from_s;
    const first = back.t.findIndex((t) => t >= from);
    const t = first < 0 ? back.t.subarray(0, 0) : back.t.subarray(Math.max(first - 1, 0));
    const ghosts = back.values.map((values) => scaled(first < 0 ? values.subarray(0, 0) : values.subarray(Math.max(first - 1, 0))));
    const order = merge(own.t, t);
    const place = (values: ArrayLike<number>, from_index: Int32Array) => {
      const made: (number | null)[] = new Array<null>(order.t.length).fill(null);
      for (let index = 0; index < made.length; index++) if (from_index[index]! >= 0) made[index] = values[from_index[index]!]!;
      return made;
    };
    return [order.t, ...ghosts.map((values) => place(values, order.second)), ...this.ends.map((values) => place(values, order.first))];
  }

  /** Sets the range of values: what the run reaches, and limits that are near. */
  private fit(): void {
    const { run, ghost, scene, factor, showsLimits } = this.input;
    const key = [run.number, run.samples.length, run.known_s, ghost?.run.number, ghost?.from_s, scene?.robot, factor, showsLimits].join(" ");
    if (key === this.rangeOf) return;
    this.rangeOf = key;
    const names = this.spec.columns;
    const all = limitsOf(this.spec, scene);
    const each = names.map((name) => run.samples.range([name], 0, Infinity) ?? ([0, 0] as const));
    this.used = each.map(([least, most], index) => {
      const [lower, upper] = all[index] ?? [-Infinity, Infinity];
      return Math.max(upper > 0 ? most / upper : 0, lower < 0 ? least / lower : 0);
    });
    const reached = [Math.min(...each.map(([least]) => least)), Math.max(...each.map(([, most]) => most))] as const;
    const behind = ghost?.run.samples.range(names, ghost.from_s, Infinity) ?? reached;
    const isSpeed = this.spec.key === "speed";
    let low = Math.min(reached[0], behind[0]);
    let high = Math.max(reached[1], behind[1]);
    const limits = all.filter((limit) => limit !== null);
    // A standing arm shows a flat line, not the noise of the last digit.
    const least = this.spec.key === "error" ? 1e-4 : 0.02 * Math.min(1, ...limits.map((limit) => limit[1]));
    low = isSpeed ? 0 : Math.min(low, -least);
    high = Math.max(high, least);
    const size = Math.max(-low, high);
    for (const [lower, upper] of limits) {
      if (showsLimits || (upper < NEAR * size && upper < NEAR * high)) high = Math.max(high, upper);
      if (!isSpeed && (showsLimits || (-lower < NEAR * size && -lower < NEAR * -low))) low = Math.min(low, lower);
    }
    const margin = 0.06 * (high - low);
    this.range = [(isSpeed ? 0 : low - margin) * factor, (high + margin) * factor];
  }

  private drawLimits(plot: uPlot): void {
    const { ctx: g } = plot;
    const { palette, factor, scene } = this.input;
    const ratio = uPlot.pxRatio;
    const { left, top, width, height } = plot.bbox;
    const own = new Map<number, string | null>();
    limitsOf(this.spec, scene).forEach((limit, index) => {
      for (const value of limit ?? []) own.set(value, own.has(value) ? null : this.colour(index));
    });
    g.save();
    g.beginPath();
    g.rect(left, top, width, height);
    g.clip();
    for (const [value, colour] of own) {
      const shown = value * factor;
      if (shown < this.range[0] || shown > this.range[1]) continue;
      const y = plot.valToPos(shown, "y", true);
      const beyond = 7 * ratio;
      g.fillStyle = hatch(g, value > 0 ? 1 : 2, colour ?? palette.error, ratio);
      g.globalAlpha = 0.7;
      g.fillRect(left, value > 0 ? y - beyond : y, width, beyond);
      g.globalAlpha = 1;
      g.fillStyle = colour ?? palette.error;
      g.fillRect(left, y - ratio / 2, width, ratio);
    }
    g.restore();
  }

  /** Writes the name of each joint at the end of its curve, apart from the others. */
  private drawNames(plot: uPlot): void {
    if (this.ends.length < 2) return;
    const { ctx: g } = plot;
    const ratio = uPlot.pxRatio;
    const { left, top, width, height } = plot.bbox;
    const named = this.ends.flatMap((values, index) => {
      const last = values[values.length - 1];
      return last === undefined || Number.isNaN(last) ? [] : [{ index, y: plot.valToPos(last, "y", true), at: 0 }];
    });
    named.sort((a, b) => a.y - b.y);
    const room = 11.5 * ratio;
    let next = top + room / 2;
    for (const name of named) {
      name.at = Math.max(name.y, next);
      next = name.at + room;
    }
    next = top + height - room / 2 + 4 * ratio;
    for (const name of [...named].reverse()) {
      name.at = Math.min(name.at, next);
      next = name.at - room;
    }
    g.save();
    g.setLineDash([]);
    g.font = `600 ${10.5 * ratio}px ${SANS}`;
    g.textAlign = "left";
    g.textBaseline = "middle";
    for (const { index, y, at } of named) {
      g.strokeStyle = g.fillStyle = this.colour(index);
      g.lineWidth = ratio;
      g.beginPath();
      g.moveTo(left + width + ratio, Math.min(Math.max(y, top), top + height));
      g.lineTo(left + width + 9 * ratio, at);
      g.stroke();
      g.fillText(`J${index + 1}`, left + width + 11 * ratio, at);
    }
    g.restore();
  }
}

/** uPlot takes null for a gap. */
function withGaps(values: Float64Array): Float64Array | (number | null)[] {
  for (const each of values) if (Number.isNaN(each)) return Array.from(values, (value) => (Number.isNaN(value) ? null : value));
  return values;
}

/** Merges two ascending lists of times; for each time its index in either, or -1. */
function merge(a: Float64Array, b: Float64Array): { readonly t: Float64Array; readonly first: Int32Array; readonly second: Int32Array } {
  const t = new Float64Array(a.length + b.length);
  const first = new Int32Array(t.length);
  const second = new Int32Array(t.length);
  let i = 0;
  let j = 0;
  let length = 0;
  while (i < a.length || j < b.length) {
    const time = Math.min(a[i] ?? Infinity, b[j] ?? Infinity);
    t[length] = time;
    first[length] = a[i] === time ? i++ : -1;
    second[length] = b[j] === time ? j++ : -1;
    length++;
  }
  return { t: t.subarray(0, length), first: first.subarray(0, length), second: second.subarray(0, length) };
}
