/** The region `Time line`: the slider `Time`, lanes of what happened, curves, and the events as a table. */

import { useComputed } from "@preact/signals";
import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import type { Frames } from "../../model/playback.ts";
import { RestingFrames } from "../../model/redraws.ts";
import type { Studio } from "../../model/studio.ts";
import { parse, seconds } from "../../model/units.ts";
import { TICK_S } from "../../source/rows.ts";
import { text } from "../../text/text.ts";
import { Board, rowHeight } from "./board.ts";
import { AXIS, limitsOf } from "./curves.ts";
import { factorOf, rowName, unitText } from "./describe.ts";
import { Events } from "./events.tsx";
import { DASHES } from "./looks.ts";
import { CURVES, TimelineState, type Row } from "./state.ts";
import "uplot/dist/uPlot.min.css";
import "./timeline.css";

const FRAMES: Frames = {
  request: (frame) => requestAnimationFrame(frame),
  cancel: (handle) => cancelAnimationFrame(handle),
};

/** What PageUp and PageDown move by, s. */
const PAGE_S = 1;

const states = new WeakMap<Studio, TimelineState>();

/** What the region and the tools in its head share. */
function stateOf(studio: Studio): TimelineState {
  const known = states.get(studio) ?? new TimelineState(studio, FRAMES);
  states.set(studio, known);
  return known;
}

export function Timeline({ studio }: { studio: Studio }) {
  const root = useRef<HTMLDivElement>(null);
  const state = stateOf(studio);
  const board = useMemo(() => new Board(state, new RestingFrames(studio.typing, FRAMES)), [state]);
  useEffect(() => {
    const ends = [state.playback.start(), () => board.stop()];
    board.start(root.current!);
    return () => ends.forEach((end) => end());
  }, [board]);
  const canAsk = studio.can("services");
  useEffect(() => {
    // A source that does not answer says so in Signals; units are left out then.
    if (canAsk) studio.ask("signals").then((found) => (state.families.value = found ?? []), () => undefined);
  }, [canAsk]);
  return (
    <div class="timeline-region" ref={root} onKeyDown={(event) => onKey(event, state)}>
      <div class="timeline-head">
        <TimeField state={state} />
        <Slider state={state} board={board} />
      </div>
      <LanesAndCurves state={state} board={board} />
      <Said state={state} />
    </div>
  );
}

/** Keys of the region, but where something is typed. */
function onKey(event: KeyboardEvent, state: TimelineState): void {
  if (event.target instanceof HTMLInputElement && event.target.type !== "range") return;
  if (event.ctrlKey || event.metaKey || event.altKey) return;
  const { view, studio } = state;
  switch (event.key) {
    case "+":
    case "=":
      view.zoom(studio.cursor.value, 1 / 1.5);
      break;
    case "-":
      view.zoom(studio.cursor.value, 1.5);
      break;
    case "0":
      view.fit();
      break;
    case "Escape":
      state.select(null);
      state.chosen.value = null;
      return;
    default:
      return;
  }
  event.preventDefault();
  event.stopPropagation();
}

// ---------------------------------------------------------------- tools

/** In the head of the region. */
export function TimelineTools({ studio }: { studio: Studio }) {
  const state = stateOf(studio);
  const { view, playback } = state;
  const selected = view.selected.value;
  const isLooping = playback.loop.value !== null;
  return (
    <div class="timeline-tools" role="toolbar" aria-label={text("timeline_tools")} onKeyDown={(event) => onKey(event, state)}>
      <span class="tool-group">
        <Tool label={text("timeline_event_before")} sign="⇤" onClick={() => studio.jumpToEvent(-1)} />
        <Tool label={text("timeline_event_after")} sign="⇥" onClick={() => studio.jumpToEvent(1)} />
      </span>
      <span class="tool-group">
        <Tool label={text("timeline_zoom_out")} sign="−" onClick={() => view.zoom(studio.cursor.value, 2)} disabled={view.isWhole.value} />
        <Tool label={text("timeline_zoom_in")} sign="+" onClick={() => view.zoom(studio.cursor.value, 0.5)} />
        <Tool label={text("timeline_fit")} sign={text("timeline_fit_short")} onClick={() => view.fit()} disabled={view.isWhole.value} />
      </span>
      {(selected !== null || isLooping) && (
        <span class="tool-group">
          <Tool label={text("timeline_to_selection")} sign={text("timeline_to_selection_short")} disabled={selected === null} onClick={() => selected && view.show(selected[0], selected[1])} />
          <Tool label={text("timeline_loop")} sign={`↻ ${text("timeline_loop_short")}`} pressed={isLooping} onClick={() => state.toggleLoop()} />
          <Tool label={text("timeline_unselect")} sign="×" onClick={() => state.select(null)} />
          {selected !== null && <output class="selection-length">{seconds(selected[0])} – {seconds(selected[1])} ({seconds(selected[1] - selected[0])})</output>}
        </span>
      )}
      <CurveTools state={state} />
    </div>
  );
}

function CurveTools({ state }: { state: TimelineState }) {
  const open = state.studio.settings.open.value;
  const run = state.studio.run.value;
  const hasErrors = run !== null && run.revision.value >= 0 && run.samples.has("qa1");
  return (
    <span class="tool-group curve-tools" role="group" aria-label={text("timeline_curves")}>
      {CURVES.filter(({ key }) => key !== "error" || hasErrors).map(({ key, isShown }) => (
        <Tool key={key} sign={text(`timeline_curve_${key}`)} pressed={open[`curve_${key}`] ?? isShown} onClick={() => state.toggleCurve(key)} />
      ))}
      <Tool label={text("timeline_limits")} sign={text("timeline_limits_short")} pressed={state.showsLimits.value} onClick={() => (state.showsLimits.value = !state.showsLimits.value)} />
    </span>
  );
}

interface ToolProps {
  readonly sign: string;
  /** What it does, where the sign does not say it. */
  readonly label?: string;
  readonly pressed?: boolean;
  readonly disabled?: boolean;
  readonly onClick: () => void;
}

function Tool({ sign, label, pressed, disabled = false, onClick }: ToolProps) {
  return (
    <button type="button" class="timeline-tool" {...(label === undefined ? {} : { "aria-label": label, title: label })} aria-pressed={pressed} disabled={disabled} onClick={onClick}>
      {sign}
    </button>
  );
}

/** The time as a field: `12.5`, `12.5 s`, `750 ms`. */
function TimeField({ state }: { state: TimelineState }) {
  const { studio, playback } = state;
  const [typed, setTyped] = useState<string | null>(null);
  const [isWrong, setWrong] = useState(false);
  const leave = () => {
    setTyped(null);
    setWrong(false);
  };
  const take = () => {
    if (typed === null) return;
    try {
      studio.jump(parse(typed, "time"));
      leave();
    } catch {
      setWrong(true);
    }
  };
  return (
    <div class="time-field">
      <input
        type="text" inputMode="decimal" spellcheck={false} autocomplete="off" aria-label={text("timeline_time_field")} aria-invalid={isWrong}
        title={isWrong ? text("timeline_time_wrong") : text("timeline_time_hint")} value={typed ?? seconds(studio.cursor.value)}
        onFocus={(event) => event.currentTarget.select()}
        onInput={(event) => setTyped(event.currentTarget.value)}
        onKeyDown={(event) => {
          if (event.key === "Enter") take();
          else if (event.key === "Escape") leave();
          else return;
          event.preventDefault();
        }}
        onBlur={() => (isWrong ? leave() : take())}
      />
      <span class="time-end">{playback.isHeld.value ? text("timeline_held") : `/ ${seconds(studio.end.value)}`}</span>
    </div>
  );
}

function Slider({ state, board }: { state: TimelineState; board: Board }) {
  const { studio } = state;
  const words = useComputed(() => {
    const cursor = studio.cursor.value;
    const run = studio.runAt(cursor);
    void run?.revision.value;
    const line = studio.isExact.value ? studio.moment.value!.line : (run?.lineAt(cursor) ?? 0);
    return line > 0 ? `${seconds(cursor)}, ${text("timeline_line", { line })}` : seconds(cursor);
  });
  const [begin, end] = state.view.whole.value;
  const cursor = studio.cursor.value;
  const move = (t: number) => {
    studio.pause();
    studio.setCursor(t);
  };
  const onKeyDown = (event: KeyboardEvent) => {
    const by = { ArrowLeft: -TICK_S, ArrowDown: -TICK_S, ArrowRight: TICK_S, ArrowUp: TICK_S, PageUp: PAGE_S, PageDown: -PAGE_S }[event.key];
    if (event.ctrlKey || event.altKey || event.metaKey) return;
    if (by !== undefined) move(studio.cursor.value + by);
    else if (event.key === "Home") move(begin);
    else if (event.key === "End") move(end);
    else return;
    event.preventDefault();
  };
  return (
    <div class="slider" data-zooms ref={board.sliderRef}>
      <canvas class="overview" aria-hidden="true" ref={board.canvas("overview")} />
      <input
        type="range" min={begin} max={end} step="any" aria-label={text("timeline_time")} value={cursor}
        aria-valuemin={begin} aria-valuemax={end} aria-valuenow={Number(cursor.toFixed(6))} aria-valuetext={words.value}
        onInput={(event) => move(event.currentTarget.valueAsNumber)} onKeyDown={onKeyDown}
      />
    </div>
  );
}

// ---------------------------------------------------------------- lanes and curves

function LanesAndCurves({ state, board }: { state: TimelineState; board: Board }) {
  const { studio } = state;
  const run = studio.run.value;
  if (run === null) return <p class="empty">{text(studio.hello.value?.mode === "connected" ? "timeline_no_picture" : "timeline_no_run")}</p>;
  const isEmpty = run.revision.value >= 0 && run.ended !== null && run.known_s <= 0;
  const stale = studio.staleFrom.value;
  return (
    <>
      {isEmpty && <p class="empty">{text("timeline_no_time")}</p>}
      {stale > 0 && <p class="timeline-stale">{text("timeline_stale", { line: stale })}</p>}
      <div class={`timeline-board${stale > 0 ? " is-stale" : ""}`} tabIndex={0} role="group" aria-label={text("timeline_board")}>
        <div class="timeline-rows">
          <div class="lane-group axis-row">
            <div class="lane-names" />
            <canvas class="axis" aria-hidden="true" ref={board.canvas("axis")} />
          </div>
          <Groups state={state} board={board} />
          <CurveTools state={state} />
          <Charts state={state} board={board} />
          <div class="plot-frame">
            <div
              class="plot-area" ref={board.areaRef} onPointerDown={board.onPointerDown} onPointerMove={board.onPointerMove}
              onPointerUp={board.onPointerUp} onPointerCancel={board.onPointerCancel} onPointerLeave={board.onPointerLeave} onDblClick={board.onDoubleClick}
            >
              <div class="selected-stretch" hidden ref={board.overlay("selection")} />
              <div class="hover-line" hidden ref={board.overlay("hoverLine")}>
                <span class="hover-time" ref={board.overlay("hoverTime")} />
              </div>
              <div class="cursor-line" hidden ref={board.overlay("cursorLine")} />
            </div>
          </div>
        </div>
        <Events state={state} />
      </div>
      <div class="timeline-tip" hidden ref={board.overlay("tip")} />
    </>
  );
}

function Groups({ state, board }: { state: TimelineState; board: Board }) {
  const { studio, expanded, chosen } = state;
  const height = rowHeight(studio.compared.value !== null);
  const lines = studio.run.value?.text.split("\n") ?? [];
  const sourceLine = (line: number) => studio.run.value?.shownLine(lines, line) ?? "";
  return (
    <>
      {state.groups.value.map(({ group, rows, more, isOpen }) => (
        <div class="lane-group" key={group}>
          <div class="lane-names" style={{ "--lane": `${height}px` }}>
            {rows.map((row) => (
              <LaneName key={row.id} row={row} name={rowName(row, sourceLine)} isChosen={chosen.value === row.id} isOpen={expanded.value.has(row.id)} state={state} board={board} />
            ))}
          </div>
          <canvas
            class="lanes" role="img" aria-label={text(`timeline_group_${group}`)} style={{ height: `${rows.length * height}px` }}
            ref={board.canvas(group)}
          />
          {more > 0 && (
            <button type="button" class="more-lanes" aria-expanded={isOpen} onClick={() => state.toggle(group)}>
              {isOpen ? `▾ ${text("timeline_fewer")}` : `▸ ${text("timeline_more", { count: more })}`}
            </button>
          )}
        </div>
      ))}
    </>
  );
}

interface LaneNameProps {
  readonly row: Row;
  readonly name: string;
  readonly isChosen: boolean;
  readonly isOpen: boolean;
  readonly state: TimelineState;
  readonly board: Board;
}

function LaneName({ row, name, isChosen, isOpen, state, board }: LaneNameProps) {
  // The end of a name of a signal or a channel tells it from the others.
  const isNamed = row.group === "signals" || row.group === "channels";
  const isThread = row.group === "threads" && row.line === 0;
  return (
    <div class={`lane-name${row.line === 0 ? "" : " is-line"}`}>
      {isThread && (
        <button type="button" class="lane-lines" aria-expanded={isOpen} aria-label={text("timeline_by_line", { name: row.name })} title={text("timeline_by_line", { name: row.name })} onClick={() => state.toggle(row.id)}>
          {isOpen ? "▾" : "▸"}
        </button>
      )}
      <button
        type="button" class={isNamed ? "lane-choice from-end" : "lane-choice"} aria-pressed={isChosen} title={`${name}\n${text("timeline_choose")}`}
        onClick={() => (state.chosen.value = isChosen ? null : row.id)}
      >
        <bdi>{name}</bdi>
      </button>
      <span class="lane-value" ref={board.value(row.id)} />
    </div>
  );
}

function Charts({ state, board }: { state: TimelineState; board: Board }) {
  const { studio } = state;
  const display = studio.display.value;
  const scene = studio.scene.value;
  return (
    <>
      {state.curves.value.map((spec) => {
        const limits = limitsOf(spec, scene);
        const factor = factorOf(spec, display);
        return (
          <div class="lane-group curve" key={spec.key}>
            <div class="curve-names">
              <h3>
                {text(`timeline_curve_${spec.key}`)}, {unitText(spec, display)}
              </h3>
              <dl>
                {spec.columns.map((column, index) => (
                  <div key={column} title={limitText(limits[index] ?? null, factor, unitText(spec, display))}>
                    {spec.columns.length > 1 && (
                      <dt style={{ color: `var(--joint-${index + 1})` }}>
                        <svg width="18" height="8" aria-hidden="true">
                          <line x1="0" y1="4" x2="18" y2="4" stroke="currentColor" stroke-width="2" stroke-dasharray={DASHES[index]!.join(" ")} />
                        </svg>
                        J{index + 1}
                      </dt>
                    )}
                    <dd class="near-limit" ref={board.value(`used ${column}`)} />
                    <dd ref={board.value(`curve ${column}`)} />
                  </div>
                ))}
              </dl>
            </div>
            <div
              class="curve-plot" role="img" aria-label={text("timeline_curve_label", { name: text(`timeline_curve_${spec.key}`), unit: unitText(spec, display) })}
              style={{ "--axis": `${AXIS}px` }} ref={board.curve(spec.key)}
            />
          </div>
        );
      })}
    </>
  );
}

function limitText(limit: readonly [number, number] | null, factor: number, unit: string): string {
  if (limit === null) return "";
  const [low, high] = limit.map((value) => Number((value * factor).toPrecision(5)));
  return Number.isFinite(low) ? text("timeline_limit_range", { low: low!, high: high!, unit }) : text("timeline_limit", { high: high!, unit });
}

/** Says alarms and warnings that playback passes. */
function Said({ state }: { state: TimelineState }) {
  const [said, say] = useState("");
  useEffect(() => {
    let last_ms = -Infinity;
    return state.playback.listen((events) => {
      const event = events.filter(({ type }) => type === "alarm" || type === "warning").at(-1);
      if (event === undefined || performance.now() - last_ms < 1000) return;
      last_ms = performance.now();
      const kind = text(event.type === "alarm" ? "timeline_kind_alarm" : "timeline_kind_warning");
      say(`${kind}, ${seconds(event.t)}, ${text("timeline_line", { line: event.line ?? 0 })}: ${String(event["text"])}`);
    });
  }, [state]);
  return <p class="unseen" aria-live="polite">{said}</p>;
}
