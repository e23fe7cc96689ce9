/** What the parts of the time line share. */

import { computed, signal } from "@preact/signals-core";
import { Details } from "../../model/detail.ts";
import { GROUPS, inOrder, Lanes, lanesByLine, type Group, type Lane } from "../../model/lanes.ts";
import { Playback, type Frames, type Stretch } from "../../model/playback.ts";
import type { Run } from "../../model/run.ts";
import type { Studio } from "../../model/studio.ts";
import { TimeView } from "../../model/view.ts";
import type { SignalFamily } from "../../source/services.ts";

/** One row of the lanes: the same thing in up to three runs. */
export interface Row {
  readonly id: string;
  readonly group: Group;
  readonly name: string;
  readonly lane: Lane | undefined;
  /** Of the run before, which is shown where the newest has not come to yet. */
  readonly stale: Lane | undefined;
  /** Of the run with which the newest is compared. */
  readonly compared: Lane | undefined;
  /** Line whose lane it is, below that of its thread; 0: a lane of its own, -1: all other lines. */
  readonly line: number;
}

/** Rows of a group that are shown without asking for more. */
const SHOWN: { readonly [group in Group]: number } = { threads: 5, moves: 9, messages: 9, signals: 10, channels: 8, devices: 8 };

/** Lanes of single lines of a thread. */
const LINES_MOST = 22;

/** Curves by key, with their columns, quantity and whether they are shown at first. */
export const CURVES = [
  { key: "q", columns: ["q1", "q2", "q3", "q4", "q5", "q6"], unit: "angle", isShown: true },
  { key: "qd", columns: ["qd1", "qd2", "qd3", "qd4", "qd5", "qd6"], unit: "angular_speed", isShown: false },
  { key: "qdd", columns: ["qdd1", "qdd2", "qdd3", "qdd4", "qdd5", "qdd6"], unit: "angular_acceleration", isShown: false },
  { key: "error", columns: ["error1", "error2", "error3", "error4", "error5", "error6"], unit: "angle", isShown: false },
  { key: "speed", columns: ["speed"], unit: "speed", isShown: true },
] as const;

export type CurveKey = (typeof CURVES)[number]["key"];

export class TimelineState {
  readonly studio: Studio;
  readonly view = new TimeView();
  readonly playback: Playback;
  readonly details: Details;
  /** Row whose events `[` and `]` go by; null: all. */
  readonly chosen = signal<string | null>(null);
  /** Groups with all of their rows, and threads with a lane for each line. */
  readonly expanded = signal<ReadonlySet<string>>(new Set());
  /** Families of signals, for their units. */
  readonly families = signal<readonly SignalFamily[]>([]);
  /** Whether the curves are scaled to their limits. */
  readonly showsLimits = signal(false);
  /** Width of the stretch in view, px. */
  readonly width = signal(600);
  private readonly known = new WeakMap<Run, Lanes>();

  constructor(studio: Studio, frames: Frames) {
    this.studio = studio;
    this.playback = new Playback(studio, frames);
    studio.laneStops = () => this.rows.value.find(({ id }) => id === this.chosen.value)?.lane?.stops ?? null;
    this.details = new Details((from_s, to_s, step_s) => studio.detail(from_s, to_s, step_s));
  }

  /** The run that is drawn behind the newest: the compared one, or the one before where the newest has not come to yet. */
  readonly ghost = computed<{ readonly run: Run; readonly from_s: number } | null>(() => {
    const { run, before, compared } = this.studio;
    if (compared.value !== null) return { run: compared.value, from_s: 0 };
    const newest = run.value;
    void newest?.revision.value;
    const last = before.value;
    return newest !== null && newest.ended === null && last !== null && last.known_s > newest.known_s ? { run: last, from_s: newest.known_s } : null;
  });

  /** All rows, grouped and in order. */
  readonly rows = computed<readonly Row[]>(() => {
    const run = this.studio.run.value;
    void run?.revision.value;
    const compared = this.studio.compared.value;
    void compared?.revision.value;
    const ghost = this.ghost.value;
    const stale = ghost !== null && ghost.run !== compared ? ghost.run : null;
    const found = new Map<string, { lane?: Lane; stale?: Lane; compared?: Lane }>();
    const take = (key: "lane" | "stale" | "compared", from: Run | null) => {
      for (const lane of this.lanesOf(from)?.all ?? []) found.set(lane.id, { ...found.get(lane.id), [key]: lane });
    };
    take("lane", run);
    take("stale", stale);
    take("compared", compared);
    const rows = [...found].map(([id, lanes]): Row => {
      const any = (lanes.lane ?? lanes.stale ?? lanes.compared)!;
      return { id, group: any.group, name: any.name, lane: lanes.lane, stale: lanes.stale, compared: lanes.compared, line: 0 };
    });
    rows.sort((a, b) => inOrder((a.lane ?? a.stale ?? a.compared)!, (b.lane ?? b.stale ?? b.compared)!));
    return rows.flatMap((row) => (this.expanded.value.has(row.id) && run !== null ? [row, ...linesOf(run, row)] : [row]));
  });

  /** Rows of each group, as far as they are shown, and how many more there are. */
  readonly groups = computed(() =>
    GROUPS.map((group) => {
      const rows = this.rows.value.filter((row) => row.group === group);
      const own = rows.filter((row) => row.line === 0);
      const isOpen = this.expanded.value.has(group);
      // One or two more take no more room than the button.
      const most = own.length <= SHOWN[group] + 2 ? own.length : SHOWN[group];
      const hidden = new Set(isOpen ? [] : own.slice(most).map((row) => row.name));
      return { group, rows: isOpen ? rows : rows.filter((row) => !hidden.has(row.line === 0 ? row.name : threadOf(row))), more: own.length - most, isOpen };
    }).filter(({ rows }) => rows.length > 0),
  );

  readonly curves = computed(() => {
    const run = this.studio.run.value;
    void run?.revision.value;
    const open = this.studio.settings.open.value;
    return CURVES.filter(({ key, isShown }) => (open[`curve_${key}`] ?? isShown) && (key !== "error" || run?.samples.has("qa1") === true));
  });

  lanesOf(run: Run | null): Lanes | null {
    if (run === null) return null;
    const known = this.known.get(run) ?? new Lanes(run);
    this.known.set(run, known);
    return known;
  }

  toggle(key: string): void {
    const expanded = new Set(this.expanded.value);
    if (!expanded.delete(key)) expanded.add(key);
    this.expanded.value = expanded;
  }

  toggleCurve(key: CurveKey): void {
    const open = this.studio.settings.open;
    const isShown = CURVES.find((curve) => curve.key === key)!.isShown;
    open.value = { ...open.value, [`curve_${key}`]: !(open.value[`curve_${key}`] ?? isShown) };
  }

  /** Repeats the selected stretch, or ends that. */
  toggleLoop(): void {
    const { loop } = this.playback;
    loop.value = loop.value === null ? this.view.selected.value : null;
  }

  select(stretch: Stretch | null): void {
    if (stretch === null) this.view.selected.value = null;
    else this.view.select(stretch[0], stretch[1]);
    if (this.playback.loop.value !== null) this.playback.loop.value = this.view.selected.value;
  }
}

function linesOf(run: Run, row: Row): Row[] {
  return lanesByLine(run, row.name, LINES_MOST).map((lane) => ({
    id: lane.id, group: row.group, name: lane.name, lane, stale: undefined, compared: undefined, line: lane.name === "" ? -1 : Number(lane.name),
  }));
}

function threadOf(row: Row): string {
  return row.id.replace(/^line (.*) \d*$/, "$1");
}
