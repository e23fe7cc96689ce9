/**
 * Draws the time line when something has changed, at most once a frame, and takes what the pointer does on it.
 *
 * Lines of the cursor and the pointer are elements over the drawing: they move without anything being drawn again.
 */

import { computed, effect } from "@preact/signals-core";
import type { Frames, Stretch } from "../../model/playback.ts";
import type { Run } from "../../model/run.ts";
import { axisTicks } from "../../model/view.ts";
import { isDark, palette } from "../../style/palette.ts";
import { bars } from "../../model/bars.ts";
import type { Lane, SpanLane } from "../../model/lanes.ts";
import { seconds } from "../../model/units.ts";
import { AXIS, CurveChart, RIGHT, type CurveInput } from "./curves.ts";
import { canvasWords, factorOf, jointValue, tooltip } from "./describe.ts";
import { drawGrid, drawLane, laneValue, SANS, type Drawing } from "./draw.ts";
import { drawSign, tints } from "./looks.ts";
import { CURVES, type CurveKey, type Row, type TimelineState } from "./state.ts";

export const ROW = 24;
/** Of the second run, below the first. */
export const ROW_COMPARED = 14;
export const AXIS_HEIGHT = 22;
export const OVERVIEW_HEIGHT = 30;
const CURVE_HEIGHT = 118;

/** Of the stretch in view, px. */
const WIDTH_LEAST = 50;

/** Pixels between two numbers of the axis. */
const TICK_ROOM = 90;

/** Marks this near to the pointer are under it, px. */
const REACH = 7;

/** Curves that reach this part of a limit have a sign. */
const NEAR_LIMIT = 0.95;

/** A pointer that has moved less has clicked, px. */
const CLICK = 4;

type Ref<E extends HTMLElement> = (element: E | null) => void;

export class Board {
  private readonly state: TimelineState;
  private readonly frames: Frames;
  private root: HTMLElement | null = null;
  private area: HTMLElement | null = null;
  private readonly canvases = new Map<string, HTMLCanvasElement>();
  private readonly holders = new Map<CurveKey, HTMLElement>();
  private readonly charts = new Map<CurveKey, CurveChart>();
  private readonly values = new Map<string, HTMLElement>();
  private readonly refs = new Map<string, Ref<HTMLElement>>();
  private cursorLine: HTMLElement | null = null;
  private hoverLine: HTMLElement | null = null;
  private hoverTime: HTMLElement | null = null;
  private selection: HTMLElement | null = null;
  private tip: HTMLElement | null = null;
  private handle: number | null = null;
  private isDirty = false;
  private readonly disposers: (() => void)[] = [];
  private pointers = new Map<number, { x: number; readonly startX: number; readonly isTouch: boolean; hasMoved: boolean }>();
  private sourceOf: { readonly run: Run | null; readonly lines: readonly string[] } = { run: null, lines: [] };
  private lineOrder: { readonly key: string; readonly order: ReadonlyMap<number, number> } = { key: "", order: new Map() };

  constructor(state: TimelineState, frames: Frames) {
    this.state = state;
    this.frames = frames;
  }

  /** Begins to draw into the elements that have been given. */
  start(root: HTMLElement): void {
    this.root = root;
    const { state } = this;
    const { studio, view } = state;
    this.disposers.push(
      // What is drawn depends on these ...
      effect(() => {
        void [view.range.value, view.selected.value, state.groups.value, state.curves.value, state.ghost.value, state.width.value];
        void [palette.value, studio.display.value, studio.scene.value, state.showsLimits.value, state.chosen.value, studio.run.value?.revision.value];
        void this.raised.value;
        this.isDirty = true;
        this.later();
      }),
      // ... and these only move lines and change numbers.
      effect(() => {
        void [studio.cursor.value, studio.hover.value, studio.moment.value];
        this.later();
      }),
      effect(() => view.extend(studio.end.value, studio.can("live"))),
    );
  }

  stop(): void {
    for (const dispose of this.disposers.splice(0)) dispose();
    this.resized.disconnect();
    if (this.handle !== null) this.frames.cancel(this.handle);
    for (const chart of this.charts.values()) chart.destroy();
    this.charts.clear();
  }

  // ---------------------------------------------------------------- elements

  /** Takes the canvas of a group, `axis` or `overview`. */
  canvas(key: string): Ref<HTMLCanvasElement> {
    return this.ref(`canvas ${key}`, (element) => {
      if (element === null) this.canvases.delete(key);
      else this.canvases.set(key, element);
      this.redraw();
    });
  }

  /** Takes the element in which a curve is drawn. */
  curve(key: CurveKey): Ref<HTMLElement> {
    return this.ref(`curve ${key}`, (element) => {
      this.charts.get(key)?.destroy();
      this.charts.delete(key);
      if (element === null) this.holders.delete(key);
      else this.holders.set(key, element);
      this.redraw();
    });
  }

  /** Takes the element with the value of a row, or with `curve` or `used` before it, of a column. */
  value(id: string): Ref<HTMLElement> {
    return this.ref(`value ${id}`, (element) => {
      if (element === null) this.values.delete(id);
      else this.values.set(id, element);
      this.redraw();
    });
  }

  overlay(part: "cursorLine" | "hoverLine" | "hoverTime" | "selection" | "tip"): Ref<HTMLElement> {
    return this.ref(`overlay ${part}`, (element) => {
      this[part] = element;
      this.later();
    });
  }

  /** Takes the element over lanes and curves, whose width is that of the stretch in view. */
  get areaRef(): Ref<HTMLElement> {
    return this.ref("area", (element) => {
      if (this.area !== null) this.resized.unobserve(this.area);
      this.area = element;
      if (element === null) return;
      this.resized.observe(element);
      element.addEventListener("wheel", this.onWheel, { passive: false });
    });
  }

  /** Takes the slider, on which the wheel zooms. */
  get sliderRef(): Ref<HTMLElement> {
    return this.ref("slider", (element) => element?.addEventListener("wheel", this.onWheel, { passive: false }));
  }

  /** Returns the same function each time: another one would be called with each rendering. */
  private ref<E extends HTMLElement>(key: string, take: (element: E | null) => void): Ref<E> {
    const known = (this.refs.get(key) as Ref<E> | undefined) ?? take;
    this.refs.set(key, known as Ref<HTMLElement>);
    return known;
  }

  // ---------------------------------------------------------------- drawing

  private readonly resized = new ResizeObserver(() => {
    this.state.width.value = Math.max(this.area?.clientWidth ?? 0, WIDTH_LEAST);
    this.redraw();
  });

  private redraw(): void {
    this.isDirty = true;
    this.later();
  }

  private later(): void {
    this.handle ??= this.frames.request(() => {
      this.handle = null;
      this.paint();
    });
  }

  /** Line that another region points at. */
  private readonly raised = computed(() => {
    const hover = this.state.studio.hover.value;
    return hover !== null && hover.region !== "timeline" ? (hover.line ?? 0) : 0;
  });

  private paint(): void {
    const { studio, view, details, width } = this.state;
    const run = studio.run.peek();
    if (studio.isPlaying.peek()) view.reveal(studio.cursor.peek());
    if (this.isDirty) {
      this.isDirty = false;
      this.paintAll(run);
    }
    this.moveLines(run);
    if (run !== null) void details.want(run, view.range.peek(), width.peek(), studio.isPlaying.peek() ? studio.cursor.peek() : null);
  }

  private paintAll(run: Run | null): void {
    const { state } = this;
    const { studio, view, width } = state;
    const range = view.range.peek();
    const ticks = axisTicks(range[0], range[1], width.peek() / TICK_ROOM);
    this.paintAxis(ticks.at, ticks.decimals, range);
    this.paintOverview(run);
    for (const { group, rows } of state.groups.peek()) {
      const canvas = this.canvases.get(group);
      if (canvas === undefined) continue;
      const drawing = this.drawing(canvas, range, width.peek());
      if (drawing === null) continue;
      drawGrid(drawing, ticks.at, canvas.clientHeight);
      this.paintRows(drawing, rows);
    }
    const ghost = state.ghost.peek();
    for (const spec of state.curves.peek()) {
      const holder = this.holders.get(spec.key);
      if (holder === undefined || run === null) continue;
      const input: CurveInput = {
        run, ghost, scene: studio.scene.peek(), view: range, width: width.peek(), height: CURVE_HEIGHT, palette: palette.peek(),
        ticks: ticks.at, factor: factorOf(spec, studio.display.peek()), showsLimits: state.showsLimits.peek(),
      };
      const chart = this.charts.get(spec.key);
      if (chart === undefined) this.charts.set(spec.key, new CurveChart(holder, spec, input));
      else chart.update(input);
      this.charts.get(spec.key)!.used.forEach((used, index) => {
        const element = this.values.get(`used ${spec.columns[index]}`);
        if (element !== undefined) say(element, used >= NEAR_LIMIT ? `⚠ ${Math.round(100 * used)} %` : "");
      });
    }
  }

  private paintRows(drawing: Drawing, rows: readonly Row[]): void {
    const { g, view, width } = drawing;
    const { studio, chosen } = this.state;
    const hasCompared = studio.compared.peek() !== null;
    const known = studio.run.peek()?.known_s ?? 0;
    const border = ((known - view[0]) / (view[1] - view[0])) * width;
    const faded = staleDrawing(drawing);
    rows.forEach((row, index) => {
      const top = index * rowHeight(hasCompared);
      if (row.id === chosen.peek()) {
        g.fillStyle = drawing.palette.chosen;
        g.globalAlpha = 0.5;
        g.fillRect(0, top, width, rowHeight(hasCompared));
        g.globalAlpha = 1;
      }
      if (row.stale !== undefined) clipped(g, border, width - border, () => drawLane(faded, row.stale!, top, ROW));
      if (row.lane !== undefined) {
        if (row.stale === undefined) drawLane(drawing, row.lane, top, ROW);
        else clipped(g, -RIGHT, border + RIGHT, () => drawLane(drawing, row.lane!, top, ROW));
      }
      if (row.compared !== undefined) drawLane(faded, row.compared, top + ROW - 3, ROW_COMPARED);
      if (index === rows.length - 1) return;
      g.fillStyle = drawing.palette.line;
      g.fillRect(0, top + rowHeight(hasCompared) - 1, width, 1);
    });
  }

  /** Prepares a canvas that is `RIGHT` pixels wider than the stretch on both sides, so that marks at its ends are whole. */
  private drawing(canvas: HTMLCanvasElement, view: Stretch, width: number): Drawing | null {
    const ratio = devicePixelRatio || 1;
    const w = Math.round(canvas.clientWidth * ratio);
    const h = Math.round(canvas.clientHeight * ratio);
    if (w === 0 || h === 0) return null;
    if (canvas.width !== w || canvas.height !== h) {
      canvas.width = w;
      canvas.height = h;
    }
    const g = canvas.getContext("2d");
    if (g === null) return null;
    g.setTransform(ratio, 0, 0, ratio, 0, 0);
    g.clearRect(0, 0, canvas.clientWidth, canvas.clientHeight);
    g.translate(MARGIN, 0);
    const run = this.state.studio.run.peek();
    const order = this.orderOf(run);
    const lines = this.linesOf(run);
    return {
      g, ratio, palette: palette.peek(), tints: tints(isDark.peek()), view, width, raised: this.raised.peek(),
      order: (line) => order.get(line) ?? line, sourceLine: (line) => run?.shownLine(lines, line) ?? "",
    };
  }

  private paintAxis(at: readonly number[], decimals: number, view: Stretch): void {
    const canvas = this.canvases.get("axis");
    const drawing = canvas === undefined ? null : this.drawing(canvas, view, this.state.width.peek());
    if (drawing === null) return;
    const { g, width } = drawing;
    g.font = `11px ${SANS}`;
    g.fillStyle = drawing.palette.faint;
    g.textBaseline = "middle";
    g.textAlign = "center";
    for (const t of at) {
      const x = ((t - view[0]) / (view[1] - view[0])) * width;
      g.fillRect(Math.round(x), AXIS_HEIGHT - 5, 1, 5);
      const label = t.toFixed(decimals);
      const half = g.measureText(label).width / 2;
      g.fillText(`${label}${t === at.at(-1) ? " s" : ""}`, Math.min(Math.max(x, half - MARGIN), width - half), AXIS_HEIGHT / 2 - 1);
    }
  }

  /** The whole run in one small row, behind the slider: lines of the main thread, alarms, and what is in view. */
  private paintOverview(run: Run | null): void {
    const canvas = this.canvases.get("overview");
    const { view, width } = this.state;
    const whole = view.whole.peek();
    const drawing = canvas === undefined || whole[1] <= whole[0] ? null : this.drawing(canvas, whole, width.peek());
    if (drawing === null || run === null) return;
    const { g, palette: colours } = drawing;
    const x = (t: number) => ((t - whole[0]) / (whole[1] - whole[0])) * drawing.width;
    const lanes = this.state.lanesOf(run);
    const main = lanes?.get("lines main") as SpanLane | undefined;
    const middle = OVERVIEW_HEIGHT / 2;
    g.fillStyle = colours.raised;
    g.fillRect(0, middle - 5, drawing.width, 10);
    if (main !== undefined) {
      for (const { x0, x1, index, count } of bars(main, whole[0], whole[1], drawing.width)) {
        if (count === 1 && main.line(index) === 0) continue;
        g.fillStyle = count > 1 ? colours.faint : drawing.tints[drawing.order(main.line(index)) % drawing.tints.length]!.edge;
        g.globalAlpha = 0.55;
        g.fillRect(x0, middle - 5, Math.max(x1 - x0, 1), 10);
      }
      g.globalAlpha = 1;
    }
    if (!view.isWhole.peek()) {
      const [from, to] = view.range.peek();
      g.fillStyle = colours.ground;
      g.globalAlpha = 0.7;
      g.fillRect(0, 0, Math.max(x(from), 0), OVERVIEW_HEIGHT);
      g.fillRect(x(to), 0, Math.max(drawing.width - x(to), 0), OVERVIEW_HEIGHT);
      g.globalAlpha = 1;
      g.strokeStyle = colours.edge;
      g.lineWidth = 1.5;
      g.strokeRect(x(from), 1, Math.max(x(to) - x(from), 2), OVERVIEW_HEIGHT - 2);
    }
    for (const event of run.messages) {
      if (event.type === "alarm" || event.type === "warning") drawSign(g, event.type, x(event.t), 6, colours);
    }
  }

  // ---------------------------------------------------------------- lines and numbers

  private moveLines(run: Run | null): void {
    const { studio, view, width } = this.state;
    const [from, to] = view.range.peek();
    const place = (t: number) => ((t - from) / (to - from)) * width.peek();
    const cursor = studio.cursor.peek();
    const hover = studio.hover.peek()?.t ?? null;
    // Rows of a source whose time goes on by itself come a little after its moments.
    const shown = studio.isFollowing.peek() && studio.can("live") ? Math.min(cursor, to) : cursor;
    put(this.cursorLine, shown >= from && shown <= to ? place(shown) : null);
    put(this.hoverLine, hover !== null && hover >= from && hover <= to ? place(hover) : null);
    if (this.hoverTime !== null && hover !== null) this.hoverTime.textContent = seconds(hover);
    const selected = view.selected.peek();
    if (this.selection !== null) {
      this.selection.hidden = selected === null || selected[1] < from || selected[0] > to;
      if (selected !== null) {
        const begin = Math.max(place(selected[0]), 0);
        this.selection.style.transform = `translateX(${begin}px)`;
        this.selection.style.width = `${Math.min(place(selected[1]), width.peek()) - begin}px`;
      }
    }
    const t = hover ?? cursor;
    const isExact = hover === null && studio.isExact.peek();
    for (const row of this.state.rows.peek()) {
      const element = this.values.get(row.id);
      const lane = laneAt(row, run, t);
      if (element === undefined) continue;
      // Of lines that take no time only the exact state knows which one it is.
      const thread = isExact && row.id.startsWith("lines ") ? studio.moment.peek()!.threads.find(({ name }) => name === row.name) : undefined;
      say(element, thread !== undefined && thread.line > 0 ? String(thread.line) : lane === undefined ? "" : laneValue(lane, t));
    }
    for (const spec of this.state.curves.peek()) {
      spec.columns.forEach((column, index) => {
        const element = this.values.get(`curve ${column}`);
        if (element === undefined) return;
        const exact = isExact && spec.key === "q" ? studio.moment.peek()!.joints[index] : undefined;
        say(element, jointValue(spec, exact ?? run?.samples.value(column, t) ?? NaN, studio.display.peek()));
      });
    }
    this.root?.classList.toggle("is-hovered", hover !== null);
    if (studio.isPlaying.peek()) return;
    for (const { group, rows } of this.state.groups.peek()) {
      const canvas = this.canvases.get(group);
      const words = canvasWords(group, rows, cursor);
      if (canvas !== undefined && canvas.getAttribute("aria-label") !== words) canvas.setAttribute("aria-label", words);
    }
  }

  // ---------------------------------------------------------------- pointer

  /** Time and row under a point of the window. */
  private find(event: { readonly clientX: number; readonly clientY: number }): { readonly t: number; readonly row: Row | null } {
    const area = this.area?.getBoundingClientRect() ?? new DOMRect(0, 0, 1, 1);
    const [from, to] = this.state.view.range.peek();
    const share = Math.min(Math.max((event.clientX - area.left) / area.width, 0), 1);
    let row: Row | null = null;
    for (const { group, rows } of this.state.groups.peek()) {
      const box = this.canvases.get(group)?.getBoundingClientRect();
      if (box === undefined || event.clientY < box.top || event.clientY >= box.bottom) continue;
      row = rows[Math.floor((event.clientY - box.top) / rowHeight(this.state.studio.compared.peek() !== null))] ?? null;
    }
    return { t: from + share * (to - from), row };
  }

  private reach_s(): number {
    const [from, to] = this.state.view.range.peek();
    return (REACH / this.state.width.peek()) * (to - from);
  }

  readonly onPointerDown = (event: PointerEvent): void => {
    if (event.button !== 0) return;
    const isTouch = event.pointerType === "touch";
    (event.currentTarget as Element).setPointerCapture(event.pointerId);
    this.pointers.set(event.pointerId, { x: event.clientX, startX: event.clientX, isTouch, hasMoved: false });
  };

  readonly onPointerMove = (event: PointerEvent): void => {
    const { studio, view } = this.state;
    const found = this.find(event);
    const pointer = this.pointers.get(event.pointerId);
    if (pointer === undefined) {
      this.hover(found.t, found.row, event);
      return;
    }
    const others = [...this.pointers.entries()].filter(([id]) => id !== event.pointerId).map(([, other]) => other);
    if (Math.abs(event.clientX - pointer.startX) > CLICK) pointer.hasMoved = true;
    if (others.length > 0) {
      const gap = Math.abs(pointer.x - others[0]!.x);
      const now = Math.abs(event.clientX - others[0]!.x);
      if (gap > 10 && now > 10) view.zoom(this.find({ clientX: (event.clientX + others[0]!.x) / 2, clientY: event.clientY }).t, gap / now);
      for (const other of others) other.hasMoved = true;
    } else if (pointer.isTouch && pointer.hasMoved) {
      studio.pause();
      studio.setCursor(found.t);
    } else if (pointer.hasMoved) {
      this.state.select([this.find({ clientX: pointer.startX, clientY: event.clientY }).t, found.t]);
      this.hover(found.t, null, event);
    }
    pointer.x = event.clientX;
  };

  readonly onPointerUp = (event: PointerEvent): void => {
    const pointer = this.pointers.get(event.pointerId);
    this.pointers.delete(event.pointerId);
    if (pointer === undefined || pointer.hasMoved) return;
    const { t, row } = this.find(event);
    const { line, at } = this.hit(t, row);
    this.state.studio.jump(at, line > 0 ? { line, column: 1 } : null);
  };

  readonly onPointerCancel = (event: PointerEvent): void => {
    this.pointers.delete(event.pointerId);
  };

  readonly onPointerLeave = (): void => {
    this.state.studio.point(null);
    this.hideTip();
  };

  readonly onDoubleClick = (event: MouseEvent): void => {
    this.hideTip();
    const { t, row } = this.find(event);
    const { view } = this.state;
    const { span } = this.hit(t, row);
    if (span === null) view.fit();
    else view.show(span[0] - 0.1 * (span[1] - span[0]), span[1] + 0.1 * (span[1] - span[0]));
  };

  /** Zooms with Ctrl, which a pinch on a touch pad is too, moves with Shift or sideways; else the page scrolls. */
  readonly onWheel = (event: WheelEvent): void => {
    const { view } = this.state;
    this.hideTip();
    if (event.ctrlKey || event.metaKey || (event.currentTarget as Element).hasAttribute("data-zooms")) {
      event.preventDefault();
      const unit = event.deltaMode === WheelEvent.DOM_DELTA_PIXEL ? 0.0025 : 0.05;
      view.zoom(this.find(event).t, Math.exp(event.deltaY * unit * (event.ctrlKey && Math.abs(event.deltaY) < 30 ? 4 : 1)));
      return;
    }
    const along = event.deltaX !== 0 ? event.deltaX : event.shiftKey ? event.deltaY : 0;
    if (along === 0 || Math.abs(along) < Math.abs(event.deltaY)) return;
    event.preventDefault();
    view.pan(along / this.state.width.peek());
  };

  private hideTip(): void {
    if (this.tip !== null) this.tip.hidden = true;
  }

  private hover(t: number, row: Row | null, event: PointerEvent): void {
    const { studio } = this.state;
    if (event.pointerType === "touch") return;
    const { line } = this.hit(t, row);
    const run = studio.runAt(t);
    studio.point({ t, line: line > 0 ? line : (run?.lineAt(t) ?? 0), region: "timeline" });
    const lane = row === null ? undefined : laneAt(row, studio.run.peek(), t);
    const words = lane === undefined ? "" : tooltip(lane, t, this.reach_s(), (number) => run?.shownLine(this.linesOf(run), number) ?? "", this.state.families.peek());
    if (this.tip === null || this.root === null) return;
    this.tip.hidden = words === "";
    if (words === "") return;
    this.tip.textContent = words;
    const left = Math.min(event.clientX + 14, innerWidth - this.tip.offsetWidth - 8);
    const isBelow = event.clientY + 18 + this.tip.offsetHeight < innerHeight;
    this.tip.style.left = `${Math.max(4, left)}px`;
    this.tip.style.top = `${isBelow ? event.clientY + 18 : event.clientY - this.tip.offsetHeight - 10}px`;
  }

  /** What is under the pointer: line, exact time of a mark, and the stretch of a span. */
  private hit(t: number, row: Row | null): { readonly line: number; readonly at: number; readonly span: Stretch | null } {
    const nothing = { line: 0, at: t, span: null };
    const lane = row === null ? undefined : laneAt(row, this.state.studio.run.peek(), t);
    if (lane === undefined) return nothing;
    if (lane.shape === "marks") {
      const near = nearest(lane.stops, t);
      if (near < 0 || Math.abs(lane.stops[near]! - t) > this.reach_s()) return nothing;
      return { line: lane.events[near]!.line ?? 0, at: lane.stops[near]!, span: null };
    }
    if (lane.shape === "levels") {
      const near = nearest(lane.stops, t);
      const isOn = near >= 0 && Math.abs(lane.stops[near]! - t) <= this.reach_s();
      return isOn ? { line: lane.line[near + 1]!, at: lane.stops[near]!, span: null } : nothing;
    }
    for (let index = 0; index < 2; index++) {
      // A span too narrow to point at is hit from beside it.
      const found = spanAt(lane, t, index === 0 ? 0 : this.reach_s());
      if (found >= 0) return { line: lane.line(found), at: index === 0 ? t : lane.start[found]!, span: [lane.start[found]!, lane.end(found)] };
    }
    return nothing;
  }

  // ---------------------------------------------------------------- the program

  private linesOf(run: Run | null): readonly string[] {
    if (this.sourceOf.run !== run) this.sourceOf = { run, lines: run?.text.split("\n") ?? [] };
    return this.sourceOf.lines;
  }

  /** Place of each line that ran among them: neighbours look different, and the same in the run behind. */
  private orderOf(run: Run | null): ReadonlyMap<number, number> {
    const runs = [run, this.state.studio.before.peek()].filter((each) => each !== null);
    const key = runs.map(({ number, lines }) => `${number} ${[...lines.values()].map(({ t }) => t.length).join(" ")}`).join();
    if (this.lineOrder.key !== key) {
      const all = new Set(runs.flatMap(({ lines }) => [...lines.values()].flatMap(({ line }) => line)));
      const order = [...all].filter((line) => line > 0).sort((a, b) => a - b);
      this.lineOrder = { key, order: new Map(order.map((line, index) => [line, index])) };
    }
    return this.lineOrder.order;
  }
}

/** Room on either side of a canvas for marks at its ends, px. */
export const MARGIN = 8;

export function rowHeight(hasCompared: boolean): number {
  return hasCompared ? ROW + ROW_COMPARED - 4 : ROW;
}

/** The lane of a row that is valid at a time. */
function laneAt(row: Row, run: Run | null, t: number): Lane | undefined {
  return row.stale !== undefined && t > (run?.known_s ?? 0) ? row.stale : (row.lane ?? row.compared);
}

function spanAt(lane: SpanLane, t: number, reach_s: number): number {
  for (let index = nearest(lane.start, t), tries = 0; index >= 0 && tries < 2; index--, tries++) {
    if (t >= lane.start[index]! - reach_s && t <= lane.end(index) + reach_s) return index;
  }
  return -1;
}

/** Index of the nearest of ascending times; -1 of none. */
function nearest(times: readonly number[], t: number): number {
  let low = 0;
  let high = times.length;
  while (low < high) {
    const middle = (low + high) >>> 1;
    if (times[middle]! <= t) low = middle + 1;
    else high = middle;
  }
  if (low === 0) return times.length > 0 ? 0 : -1;
  return low < times.length && times[low]! - t < t - times[low - 1]! ? low : low - 1;
}

function clipped(g: CanvasRenderingContext2D, x: number, width: number, draw: () => void): void {
  if (width <= 0) return;
  g.save();
  g.beginPath();
  g.rect(x, 0, width, g.canvas.height);
  g.clip();
  draw();
  g.restore();
}

/** Of what is not of the newest run: grey, without tints. */
function staleDrawing(drawing: Drawing): Drawing {
  const { palette: own, tints: all } = drawing;
  const { stale } = own;
  const grey = { fill: all.at(-1)!.fill, edge: stale };
  return { ...drawing, tints: [grey], palette: { ...own, ink: stale, good: stale, accent: stale, error: stale, warning: stale } };
}

function put(line: HTMLElement | null, x: number | null): void {
  if (line === null) return;
  line.hidden = x === null;
  if (x !== null) line.style.transform = `translateX(${x}px)`;
}

function say(element: HTMLElement, words: string): void {
  if (element.textContent !== words) element.textContent = words;
}

export { AXIS, CURVES };
