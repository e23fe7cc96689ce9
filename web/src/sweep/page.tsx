/** The page of a sweep: numbers, words, failures, plots, one run. */

import { useSignal, useSignalEffect } from "@preact/signals";
import { useEffect, useId, useRef } from "preact/hooks";
import { palette, theme, type Theme } from "../style/palette.ts";
import { chosenLanguage, language } from "../text/language.ts";
import type { Column, Kind, ShownRun } from "./data.ts";
import { binned, shown, shownValue } from "./numbers.ts";
import { colours, drawShape, histogram, Scatter, SHAPES } from "./plots.ts";
import { KINDS_COLOURED, type Colouring, type State } from "./state.ts";
import { text, type SweepTexts } from "./texts.ts";

interface Props {
  readonly state: State;
}

export function Page({ state }: Props) {
  return (
    <div class="sweep">
      <Head state={state} />
      <main>
        <Summary state={state} />
        <Failures state={state} />
        <div class="plots">
          <Histogram state={state} />
          <ScatterPlot state={state} />
        </div>
        <Chosen state={state} />
      </main>
    </div>
  );
}

function percent(share: number): string {
  return `${shown(Number((100 * share).toPrecision(2)))} %`;
}

function Head({ state: { sweep } }: Props) {
  const themes: readonly Theme[] = ["system", "light", "dark"];
  const { interval, cycle_s } = sweep;
  const next = language.value === "zh" ? "en" : "zh";
  return (
    <header class="head">
      <h1>{sweep.title}</h1>
      <dl class="numbers">
        <Figure name={text("runs")} value={sweep.runs.toLocaleString("en-US")} />
        <Figure name={text("hold")} value={(sweep.runs - sweep.failed).toLocaleString("en-US")} kind="good" />
        <Figure name={text("fail")} value={sweep.failed.toLocaleString("en-US")} kind={sweep.failed > 0 ? "error" : ""} />
        {interval !== null && (
          <Figure
            name={text("interval")}
            value={sweep.failed === 0 ? text("below", { high: percent(interval[1]) }) : text("range", { low: percent(interval[0]), high: percent(interval[1]) })}
          />
        )}
        {cycle_s !== null && <Figure name={text("cycle")} value={`${shown(cycle_s[1])} s`} more={text("cycle_range", { least: shown(cycle_s[0]), most: shown(cycle_s[2]) })} />}
        <Figure name={text("seed")} value={String(sweep.seed)} />
      </dl>
      <div class="tools">
        <Choice label={text("theme")} value={theme.value} options={themes.map((name) => [name, text(`theme_${name}`)])} onChoose={(name) => (theme.value = name as Theme)} />
        <button type="button" lang={next} onClick={() => (chosenLanguage.value = next)}>
          {text("other_language")}
        </button>
      </div>
    </header>
  );
}

function Figure({ name, value, more = "", kind = "" }: { name: string; value: string; more?: string; kind?: string }) {
  return (
    <div>
      <dt>{name}</dt>
      <dd class={kind}>{value}</dd>
      {more !== "" && <dd class="more">{more}</dd>}
    </div>
  );
}

/** A labelled list of choices; those in one group follow each other. */
function Choice({ label, value, options, onChoose }: { label: string; value: string; options: readonly (readonly [string, string, string?])[]; onChoose: (value: string) => void }) {
  const id = useId();
  const groups = new Map<string, (readonly [string, string, string?])[]>();
  for (const option of options) groups.set(option[2] ?? "", [...(groups.get(option[2] ?? "") ?? []), option]);
  const item = ([key, words]: readonly [string, string, string?]) => (
    <option key={key} value={key} selected={key === value}>
      {words}
    </option>
  );
  return (
    <span class="choice">
      <label for={id}>{label}</label>
      <select id={id} value={value} onChange={(event) => onChoose(event.currentTarget.value)}>
        {[...groups].map(([name, list]) => (name === "" ? list.map(item) : <optgroup key={name} label={name}>{list.map(item)}</optgroup>))}
      </select>
    </span>
  );
}

function Summary({ state: { sweep } }: Props) {
  return (
    <section aria-label={text("summary")} class="card summary">
      <h2>{text("summary")}</h2>
      {/* These words are those of the command line. */}
      <div lang="en" class="lines" tabIndex={0} role="group" aria-label={text("summary")}>
        {sweep.lines.map((line, index) => (line === "" ? <div key={index} class="gap" /> : <p key={index} style={{ paddingLeft: `${line.length - line.trimStart().length}ch` }}>{line.trim()}</p>))}
      </div>
      {sweep.command !== "" && <Command words={sweep.command} />}
    </section>
  );
}

function Command({ words }: { words: string }) {
  const isCopied = useSignal(false);
  const copy = async () => {
    await navigator.clipboard.writeText(words);
    isCopied.value = true;
  };
  return (
    <p class="command">
      <code lang="en" tabIndex={0}>{words}</code>
      {"clipboard" in navigator && (
        <button type="button" onClick={() => void copy()}>
          <span role="status">{text(isCopied.value ? "copied" : "copy")}</span>
        </button>
      )}
    </p>
  );
}

function RunLink({ state, entry, isLast }: { state: State; entry: ShownRun; isLast: boolean }) {
  const { run } = entry;
  const mark = isLast ? "" : ", ";
  if (entry.page !== "") {
    return (
      <>
        <a href={entry.page} title={text("replay_hint", { run })}>
          {text("replay", { run })}
        </a>
        {mark}
      </>
    );
  }
  return (
    <>
      <button type="button" class="link" title={text("choose_hint", { run })} onClick={() => reveal(state, run)}>
        {run}
      </button>
      {mark}
    </>
  );
}

function reveal(state: State, run: number): void {
  state.choose(run);
  document.getElementById("chosen")?.scrollIntoView({ block: "nearest" });
}

/** The shape and colour of a kind in the plots. */
function Key({ place }: { place: number }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  useSignalEffect(() => {
    const g = canvas.current!.getContext("2d")!;
    const { holding, failing } = colours(palette.value);
    const ratio = devicePixelRatio;
    canvas.current!.width = canvas.current!.height = 14 * ratio;
    g.scale(ratio, ratio);
    if (place < 0) {
      g.fillStyle = holding;
      g.fillRect(4, 4, 6, 6);
      return;
    }
    g.lineWidth = 1.6;
    g.strokeStyle = failing[place]!;
    drawShape(g, SHAPES[place]!, 7, 7, 4);
  });
  return <canvas ref={canvas} class="key" aria-hidden="true" />;
}

function Failures({ state }: Props) {
  const { sweep } = state;
  return (
    <section aria-label={text("failures")} class="card failures">
      <h2>{text("failures")}</h2>
      {sweep.kinds.length === 0 ? (
        <p class="faint">{text("no_failures")}</p>
      ) : (
        <div class="scrolled" tabIndex={0} role="group" aria-label={text("failures")}>
          <table>
            <thead>
              <tr>
                <th class="number" scope="col">{text("count")}</th>
                <th scope="col">{text("what")}</th>
                <th scope="col">{text("replays")}</th>
              </tr>
            </thead>
            <tbody>{sweep.kinds.map((kind, place) => <KindRow key={kind.number} state={state} kind={kind} place={place} />)}</tbody>
          </table>
        </div>
      )}
      {sweep.kinds_left_out > 0 && <p class="faint">{text("kinds_left_out", { count: sweep.kinds_left_out })}</p>}
      {sweep.nearest.length > 0 && (
        <>
          <h3>{text("nearest")}</h3>
          <ul class="nearest">
            {sweep.nearest.map((entry) => (
              <li key={entry.property}>
                <RunLink state={state} entry={entry} isLast /> · {text("nearest_text", { margin: shown(entry.margin) })} · <code lang="en">{entry.property}</code>
              </li>
            ))}
          </ul>
        </>
      )}
    </section>
  );
}

function KindRow({ state, kind, place }: { state: State; kind: Kind; place: number }) {
  return (
    <tr>
      <td class="number">
        <Key place={state.colouring.value === "result" ? 0 : Math.min(place, KINDS_COLOURED)} />
        {kind.count.toLocaleString("en-US")}
      </td>
      <td lang="en">
        <div class="title">{kind.title}</div>
        {kind.story.length > 0 ? kind.story.map((line, index) => <p key={index}>{line}</p>) : kind.text !== "" && <p>{kind.text}</p>}
        {kind.smallest.page !== "" && <p lang={language.value}><a href={kind.smallest.page}>{text("smallest")}</a></p>}
        {kind.smallest.command !== "" && <Command words={kind.smallest.command} />}
        {kind.region !== "" && <p class="faint">{kind.region}</p>}
      </td>
      <td class="runs">
        {kind.runs.map((entry, index) => <RunLink key={entry.run} state={state} entry={entry} isLast={index === kind.runs.length - 1} />)}
        {kind.count > kind.runs.length && " …"}
      </td>
    </tr>
  );
}

// ---------------------------------------------------------------- plots

function nameOf({ name, role }: Column): string {
  if (role === "time") return text("time_s");
  if (role === "state") return text("state");
  if (role === "disturbances") return text("disturbances");
  return role === "margin" ? text("margin_of", { property: name }) : name;
}

function options(state: State): readonly (readonly [string, string, string])[] {
  return state.quantities.map((column, index) => [String(index), nameOf(column), text(`role_${column.role}` as keyof SweepTexts)]);
}

function QuantityChoice({ state, label, of }: { state: State; label: string; of: { value: Column } }) {
  return (
    <Choice
      label={label} value={String(state.quantities.indexOf(of.value))} options={options(state)}
      onChoose={(index) => (of.value = state.quantities[Number(index)]!)}
    />
  );
}

/** Calls what makes a plot with the size of its place, and again whenever that or a signal that it reads changes. */
function usePlot(make: (parent: HTMLElement, size: { width: number; height: number }) => () => void) {
  const place = useRef<HTMLDivElement>(null);
  const width = useSignal(0);
  useEffect(() => {
    const watch = new ResizeObserver(() => (width.value = Math.floor(place.current!.clientWidth)));
    watch.observe(place.current!);
    return () => watch.disconnect();
  }, []);
  useSignalEffect(() => {
    if (width.value < 40) return;
    const height = Math.round(Math.min(Math.max(width.value * 0.62, 240), 420));
    const end = make(place.current!, { width: width.value, height });
    return end;
  });
  return place;
}

function Sampled({ state: { sweep } }: Props) {
  if (sweep.rows >= sweep.runs) return null;
  return <p class="faint">{text("sampled", { shown: sweep.rows, runs: sweep.runs, holding: sweep.holding[1], failing: sweep.failing[1] })}</p>;
}

function Histogram({ state }: Props) {
  const place = usePlot((parent, size) => {
    const column = state.histogram.value;
    const words = { x: nameOf(column), y: text("runs_axis") };
    const plot = histogram(parent, size, binned(state.sweep, column), column, words, palette.value);
    return () => plot.destroy();
  });
  const { runs, failed } = state.sweep;
  return (
    <section aria-label={text("histogram")} class="card">
      <h2>{text("histogram")}</h2>
      <div class="choices">
        <QuantityChoice state={state} label={text("quantity")} of={state.histogram} />
        <span class="legend"><Key place={-1} /> {text("holds")}</span>
        <span class="legend"><span class="block" aria-hidden="true" /> {text("fails")}</span>
      </div>
      <div class="plot" ref={place} role="img" aria-label={text("histogram_of", { name: nameOf(state.histogram.value), count: runs, failing: failed })} />
      <Sampled state={state} />
    </section>
  );
}

function ScatterPlot({ state }: Props) {
  const scatter = useRef<Scatter | null>(null);
  const isEnlarged = useSignal(false);
  const place = usePlot((parent, size) => {
    isEnlarged.value = false;
    state.colouring.value;
    const words = { x: nameOf(state.across.value), y: nameOf(state.up.value) };
    const made = new Scatter(parent, size, state, words, palette.value, (found) => (isEnlarged.value = found));
    scatter.current = made;
    return () => made.plot.destroy();
  });
  useSignalEffect(() => {
    state.row.value;
    scatter.current?.plot.redraw(false);
  });
  const { runs, failed } = state.sweep;
  return (
    <section aria-label={text("scatter")} class="card">
      <h2>{text("scatter")}</h2>
      <div class="choices">
        <QuantityChoice state={state} label={text("across")} of={state.across} />
        <QuantityChoice state={state} label={text("up")} of={state.up} />
        <Choice
          label={text("colour")} value={state.colouring.value} options={[["result", text("by_result")], ["kind", text("by_kind")]]}
          onChoose={(name) => (state.colouring.value = name as Colouring)}
        />
        <button type="button" disabled={!isEnlarged.value} onClick={() => scatter.current?.reset()}>{text("everything")}</button>
      </div>
      <div class="plot" ref={place} role="img" aria-label={text("scatter_of", { x: nameOf(state.across.value), y: nameOf(state.up.value), count: runs, failing: failed })} />
      <p class="faint">{text(isEnlarged.value ? "enlarged_hint" : "drag_hint")}</p>
    </section>
  );
}

// ---------------------------------------------------------------- one run

function Chosen({ state }: Props) {
  const id = useId();
  const found = state.chosen.value;
  const row = state.row.value;
  return (
    <section aria-label={text("run")} class="card chosen" id="chosen">
      <h2>{text("run")}</h2>
      <div class="choices">
        <span class="choice">
          <label for={id}>{text("choose")}</label>
          <input id={id} type="text" inputMode="numeric" size={8} value={found?.run ?? ""} onChange={(event) => {
            const run = Number(event.currentTarget.value.trim());
            if (event.currentTarget.value.trim() !== "" && Number.isInteger(run)) state.choose(run);
          }} />
        </span>
        <button type="button" disabled={state.failing.length === 0} onClick={() => state.step(-1)}>{text("previous")}</button>
        <button type="button" disabled={state.failing.length === 0} onClick={() => state.step(1)}>{text("next")}</button>
      </div>
      <div role="status">
        {state.missing.value !== null && <p class="error">{text("not_shown", { run: state.missing.value })}</p>}
        {found === null ? state.missing.value === null && <p class="faint">{text("none_chosen")}</p> : (
          <p class={found.kind === null ? "good" : "error"} lang={found.kind === null ? language.value : "en"}>
            {found.kind === null ? text(state.kinds[row]! < 0 ? "holds" : "fails") : found.kind.title}
          </p>
        )}
      </div>
      {found !== null && (
        <>
          <dl class="values">
            {state.quantities.map((column) => (
              <div key={`${column.role} ${column.name}`}>
                <dt>{nameOf(column)}</dt>
                <dd>{shownValue(column, row) || "–"}</dd>
              </div>
            ))}
          </dl>
          {found.shown !== null && found.shown.disturbances.length > 0 && (
            <>
              <h3>{text("disturbed")}</h3>
              <ul lang="en">{found.shown.disturbances.map((words, index) => <li key={index}>{words}</li>)}</ul>
            </>
          )}
          {found.shown !== null && found.shown.page !== "" && <p><a href={found.shown.page}>{text("open_replay")}</a></p>}
          <Again state={state} run={found.run} />
        </>
      )}
    </section>
  );
}

function Again({ state: { sweep }, run }: { state: State; run: number }) {
  if (sweep.run_command === "") return null;
  const words = sweep.run_command.replaceAll("{run}", String(run));
  return (
    <>
      <h3>{text("again")}</h3>
      <Command key={words} words={words} />
    </>
  );
}
