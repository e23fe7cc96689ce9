/** All that the page knows, and what people can do with it. Regions read its signals and call its methods. */

import { computed, signal } from "@preact/signals-core";
import type {
  Ability, ControlAction, ControllerState, FromSource, Json, Moment, ProgramTree, RunOptions, Scene, Service, Six, TextEdit, ToSource, Value,
} from "../source/messages.ts";
import { TICK_S, type Rows } from "../source/rows.ts";
import { fromBase64, readRecording } from "../source/recording.ts";
import type { Results } from "../source/services.ts";
import type { Link, Listener, Source } from "../source/source.ts";
import { said } from "../text/said.ts";
import { text as words } from "../text/text.ts";
import { type Alignment, aligned, recordingIn, runOf } from "./compare.ts";
import { firstChange } from "./difference.ts";
import { History } from "./history.ts";
import { nextStop } from "./lanes.ts";
import { Typing } from "./redraws.ts";
import { Refused, Requests, type Request } from "./requests.ts";
import { Run, type RunEnded } from "./run.ts";
import { Settings } from "./settings.ts";
import { nextBegin, nodeOf, rowOf } from "./tree.ts";
import { WINDOW_S } from "./view.ts";

export type { Display } from "./units.ts";

export type Hello = Extract<FromSource, { type: "hello" }>;
export type FileInfo = Extract<FromSource, { type: "file" }>;

/** What the pointer or the caret is at: nothing scrolls because of it. */
export interface Hover {
  readonly t?: number;
  /** In the text that ran, or in that of `version`. */
  readonly line?: number;
  readonly version?: number;
  /** Region in which it is, which does not mark it itself. */
  readonly region: string;
}

/** What is drawn: exact where the source has answered for this time. */
export interface Shown {
  readonly t: number;
  readonly joints: Six;
  readonly exact: boolean;
}

/** A run that another is compared with. */
export interface Compared {
  readonly title: string;
  readonly run: Run;
}

export interface Place {
  readonly line: number;
  readonly column: number;
  /** Of the text in which that is, which may have changed since; the present one where there is none. */
  readonly version?: number;
}

/** What other regions do with the editor; each is one step of its undo. */
export interface Editor {
  apply(edits: readonly TextEdit[]): void;
  /** Replaces the whole text, such as with the file's. */
  replace(text: string): void;
  /** Inserts lines below the caret's line, indented like it. */
  insert(lines: string): void;
  focus(): void;
}

export type ViewName = "fit" | "front" | "side" | "top" | "iso";

export interface Notice {
  readonly id: number;
  readonly severity: "information" | "warning" | "error";
  readonly text: string;
}

/** Two texts of one file, of which people choose: nothing is overwritten before. */
export interface Conflict {
  /** The file has changed while the text was edited, since a draft of it was kept, or was found changed by Save. */
  readonly why: "disk" | "draft" | "save";
  readonly theirs: string;
  readonly digest: string;
}

/** Longest pause between an edit and its message; the first edit after a pause is sent at once. */
export const EDIT_MS = 80;

/** From when on the run on the screen is called stale, if no newer one has begun. */
export const STALE_MS = 400;

/** Notices that are kept. */
const NOTICES_MAX = 20;

/** Texts that were told and wait for their runs. */
const TOLD_MAX = 100;

/** End of a run where the options have none. */
export const LIMIT_S = 120;

export class Studio implements Listener {
  readonly source: Source;
  readonly link = signal<Link>("connecting");
  readonly hello = signal<Hello | null>(null);
  readonly scene = signal<Scene | null>(null);
  readonly file = signal<FileInfo | null>(null);
  /** The text of the editor, and its version, which the options raise too. */
  readonly text = signal("");
  readonly version = signal(0);
  /** Of the newest text that was checked. */
  readonly problems = signal<Extract<FromSource, { type: "problems" }> | null>(null);
  private readonly chosen = new History<RunOptions>({});
  /** What was chosen here; the rest is as the command line gave it. */
  readonly options = this.chosen.value;
  readonly canUndo = this.chosen.canUndo;
  readonly canRedo = this.chosen.canRedo;
  /** The newest run, and the one before it, whose rest is stale while the newest is not that far. */
  readonly run = signal<Run | null>(null);
  readonly before = signal<Run | null>(null);
  /** The run with which the newest is compared, and what it is; null if none is. */
  readonly comparing = signal<Compared | null>(null);
  /** How the times of both are laid over each other. */
  readonly alignment = signal<Alignment>("time");
  /** Whether a run is being recorded for a page or a comparison. */
  readonly isRecording = signal(false);
  /** Time that is shown, s: a whole number of ticks, or the end. */
  readonly cursor = signal(0);
  readonly hover = signal<Hover | null>(null);
  /** Newest exact state; of the cursor where `isExact`. */
  readonly moment = signal<Moment | null>(null);
  /** Run of which the moment is. */
  private readonly momentRun = signal(0);
  readonly controller = signal<ControllerState | null>(null);
  /** With "live": the present state, also while the cursor is at an earlier time. */
  readonly present = signal<Moment | null>(null);
  /** With "live": whether the cursor goes with the controller's time. */
  readonly isFollowing = signal(true);
  /** Where a click in another region sends the editor; each click is a new object. */
  readonly goto = signal<Place | null>(null);
  /** Whether the cursor goes on by itself (`playback.ts` moves it), and how fast; 1 is real time. */
  readonly isPlaying = signal(false);
  readonly rate = signal(1);
  /** Thread whose statements `step` goes by. */
  readonly thread = signal("main");
  /** What a key asks the view of the arm for; each press is a new object. */
  readonly view = signal<{ readonly to: ViewName } | null>(null);
  readonly settings = new Settings();
  readonly display = this.settings.display;
  /** Times of the lane that is chosen in the time line, ascending; set by that region. */
  laneStops: (() => ArrayLike<number> | null) | null = null;
  /** The keys of the editor, which go before pictures. */
  readonly typing = new Typing();
  /** Set by the region Program while it is there. */
  editor: Editor | null = null;
  readonly notices = signal<readonly Notice[]>([]);
  readonly conflict = signal<Conflict | null>(null);
  /** When a draft that is shown instead of the file was kept; null if none is. */
  readonly draftAt = signal<string | null>(null);
  readonly isSaving = signal(false);
  private readonly isOverdue = signal(false);

  private readonly requests = new Requests(
    (message) => this.transmit(message),
    () => (this.link.value === "lost" ? words("link_lost") : null),
  );
  /** Texts by version, of which a run may begin. */
  private readonly told = new Map<number, { readonly text: string; readonly tree: ProgramTree | null }>();
  private readonly watching: () => void;
  private nextNotice = 1;
  /** The time that people chose: the cursor is there as soon as the run is that long; Infinity: at its end. */
  private wanted_s = 0;
  private lastAligned: { readonly other: Run; readonly ended: RunEnded; readonly run: Run } | null = null;
  private isSeeking = false;
  private seeksAgain = false;
  private isUntold = false;
  private quiet: ReturnType<typeof setTimeout> | undefined;
  private overdue: ReturnType<typeof setTimeout> | undefined;
  private isOpening = false;
  /** The run whose computation Stop has ended. */
  private halted: Run | null = null;
  private steps = 0;

  constructor(source: Source) {
    this.source = source;
    this.watching = this.settings.watch((values) => this.transmit({ type: "settings", values }));
  }

  start(): void {
    this.source.start(this);
  }

  close(): void {
    this.watching();
    this.pause();
    this.requests.drop("closed");
    clearTimeout(this.quiet);
    clearTimeout(this.overdue);
    this.source.close();
  }

  can(ability: Ability): boolean {
    return this.hello.value?.abilities.includes(ability) ?? false;
  }

  // ---------------------------------------------------------------- what follows from it

  /** The run with which the newest is compared, in its times; null if none is. */
  readonly compared = computed((): Run | null => {
    const other = this.comparing.value?.run ?? null;
    const run = this.run.value;
    void run?.revision.value;
    if (other === null || run === null || run.ended === null || this.alignment.value === "time") return other;
    const last = this.lastAligned;
    if (last?.other !== other || last.ended !== run.ended) this.lastAligned = { other, ended: run.ended, run: aligned(other, run) };
    return this.lastAligned!.run;
  });

  /** Which controller this is about, by model and address; "" if about none. */
  readonly robot = computed(() => {
    if (this.hello.value?.mode !== "connected") return "";
    const controller = this.controller.value;
    return controller === null ? this.hello.value.title : [controller.model, controller.address].filter(Boolean).join(" · ");
  });

  /** Last time of the slider, s: of the newest run, or of the one before while that was longer and the newest grows. */
  readonly end = computed(() => {
    const run = this.run.value;
    void run?.revision.value;
    if (run === null) return 0;
    return run.ended === null ? Math.max(run.known_s, this.before.value?.known_s ?? 0) : run.known_s;
  });

  /** Whether `moment` is the state at the cursor. */
  readonly isExact = computed(() => {
    const moment = this.moment.value;
    return moment !== null && this.momentRun.value === (this.run.value?.number ?? 0) && Math.abs(moment.t - this.cursor.value) < TICK_S / 4;
  });

  /** Whether the text differs from the file. */
  readonly isModified = computed(() => {
    const file = this.file.value;
    return file !== null && (file.is_new === true ? this.text.value !== "" || file.text !== "" : this.text.value !== file.text);
  });

  /** The graphical program of which the text is the script; null for a text that people write. */
  readonly tree = computed(() => this.file.value?.tree ?? null);

  /** Whether people edit the text. */
  readonly canWrite = computed(() => this.can("edit") && this.tree.value === null);

  /** The row of the tree that is looked at; 0: none. */
  readonly row = signal(0);

  /** The run of the text on the screen, whose lines are those of the tree; null if there is none. */
  readonly runOfTree = computed((): Run | null => {
    const run = this.run.value;
    return run !== null && run.tree !== null && run.tree === this.tree.value ? run : null;
  });

  /** Rows of the tree in which threads are at the cursor; the first is that of the main thread, 0 if it is in none. */
  readonly rowsNow = computed((): readonly number[] => {
    const tree = this.tree.value;
    const run = this.runOfTree.value;
    if (tree === null || run === null) return [];
    void run.revision.value;
    const t = this.cursor.value;
    const moment = this.isExact.value ? this.moment.value : null;
    const others = [...run.lines.keys()].filter((name) => name !== "main");
    const lines = moment !== null && moment.line > 0
      ? [moment.line, ...moment.threads.filter(({ name }) => name !== "main").map(({ line }) => line)]
      : run.ended?.state === "finished" && t >= run.known_s ? [] : [run.lineAt(t), ...others.map((name) => run.lineAt(t, name))];
    return lines.map((line) => rowOf(tree, line));
  });

  /** Whether the text holds nothing yet, as far as the source has said. */
  readonly isEmpty = computed(() => this.problems.value?.start !== undefined);

  /** First line of the text that the run on the screen is not of; 0 if it is of this text. */
  readonly staleFrom = computed(() => {
    const run = this.run.value;
    // A controller's run is of the program there.
    if (run === null || this.can("live") || run.version === this.version.value || run.text === this.text.value) return 0;
    const problems = this.problems.value;
    const isRefused = problems !== null && problems.version === this.version.value && !problems.compiles;
    return isRefused || this.isOverdue.value ? firstChange(run.text, this.text.value) : 0;
  });

  /** The node of a line of the present text, as people say it; "" where it is no graphical program. */
  nodeAt(line: number): string {
    return nodeOf(this.tree.value, line);
  }

  /** The same of a line of the text that ran. */
  nodeInRun(line: number): string {
    return this.run.value?.nodeAt(line) ?? "";
  }

  /** The run that is known at a time: while the newest is not that far, the one before, which is stale there. */
  runAt(t: number): Run | null {
    const run = this.run.value;
    const before = this.before.value;
    return run !== null && run.ended === null && t > run.known_s && before !== null && before.known_s > run.known_s ? before : run;
  }

  // ---------------------------------------------------------------- the text

  /** Takes a new text of the editor. */
  edit(text: string): void {
    if (this.tree.value !== null) return;
    if (text === this.text.value && this.version.value > 0) return;
    this.typing.key(performance.now());
    this.text.value = text;
    this.changed();
  }

  /** Makes the edits of a finding as one step of the editor's undo; of a text that has changed since, none. */
  fix(version: number, edits: readonly TextEdit[]): void {
    if (version === this.version.value) this.editor?.apply(edits);
  }

  /** Replaces the text, as one step of the editor's undo where there is an editor. */
  replace(text: string): void {
    this.editor?.replace(text);
    this.edit(text);
  }

  /** Writes the file. A conflict is shown; other reasons become notices. Returns whether it was written. */
  async save(): Promise<boolean> {
    const file = this.file.value;
    if (file === null || !this.can("save") || this.isSaving.value) return false;
    if (file.tree !== undefined) {
      this.notice("information", words("tree_is_source"));
      return false;
    }
    const text = this.text.value;
    this.isSaving.value = true;
    try {
      const answer = await this.requests.send({ type: "save", ask: 0, text, seen: file.digest });
      if (answer.type === "saved") this.settleFile({ ...file, text, digest: answer.digest, is_new: false });
      return true;
    } catch (error) {
      const conflict = error instanceof Refused ? error.answer.conflict : undefined;
      if (conflict === undefined) this.notice("error", words("not_saved", { why: reason(error) }));
      else this.conflict.value = { why: "save", theirs: conflict.text, digest: conflict.digest };
      return false;
    } finally {
      this.isSaving.value = false;
    }
  }

  /** Keeps the text of the editor; the next Save writes it over what the file holds now. */
  keepMine(): void {
    const conflict = this.conflict.value;
    const file = this.file.value;
    this.conflict.value = null;
    if (conflict === null || file === null) return;
    this.settleFile({ ...file, text: conflict.theirs, digest: conflict.digest });
  }

  /** Puts the file's text into the editor, whose undo brings the other one back. */
  takeTheirs(): void {
    const conflict = this.conflict.value;
    const file = this.file.value;
    this.conflict.value = null;
    if (file === null) return;
    if (conflict !== null) this.settleFile({ ...file, text: conflict.theirs, digest: conflict.digest });
    this.draftAt.value = null;
    this.replace(conflict?.theirs ?? file.text);
  }

  /** Opens a program of the folder, or begins a new one; drafts of the present one are kept by the source. */
  async open(name: string): Promise<void> {
    this.flush();
    this.isOpening = true;
    try {
      await this.requests.send({ type: "open", ask: 0, name });
    } catch (error) {
      this.notice("error", words("not_opened", { name, why: reason(error) }));
    } finally {
      this.isOpening = false;
    }
  }

  // ---------------------------------------------------------------- options and inputs of the run

  /** Changes options; undefined: as the command line gave it. Changes in a row with the same `key` are one step of undo. */
  setOptions(change: { readonly [key in keyof RunOptions]?: RunOptions[key] | undefined }, key = ""): void {
    const options: { [name: string]: unknown } = { ...this.options.value };
    for (const [name, value] of Object.entries(change)) {
      if (value === undefined) delete options[name];
      else options[name] = value;
    }
    this.chosen.set(options as RunOptions, key);
    this.changed();
  }

  /** Lets a signal take a value from outside at a time of the run; with `live` now. */
  setInput(name: string, value: Value, at_s = this.cursor.value): void {
    if (this.can("signals")) {
      this.requests.send({ type: "signal", ask: 0, name, value }).catch((error: unknown) => this.notice("error", reason(error)));
      return;
    }
    const others = (this.options.value.inputs ?? []).filter((input) => input.name !== name || Math.abs(input.at_s - at_s) > TICK_S / 4);
    this.setOptions({ inputs: [...others, { name, value, at_s }].sort((a, b) => a.at_s - b.at_s) }, `${name} ${at_s}`);
  }

  removeInput(index: number): void {
    const inputs = (this.options.value.inputs ?? []).filter((_, other) => other !== index);
    this.setOptions({ inputs: inputs.length > 0 ? inputs : undefined });
  }

  /** Takes back the last change of options or inputs. */
  undo(): void {
    if (this.chosen.undo()) this.changed();
  }

  redo(): void {
    if (this.chosen.redo()) this.changed();
  }

  /** Lets a run that has reached its limit go on for as long again. */
  goOn(): void {
    const run = this.run.value;
    if (run?.ended?.state !== "time_limit") return;
    const until_s = 2 * Math.max(run.known_s, this.options.value.until_s ?? LIMIT_S);
    run.ended = null;
    run.revision.value++;
    this.transmit({ type: "go_on", run: run.number, until_s });
  }

  // ---------------------------------------------------------------- compare and share

  /** Lays a run over the newest; null: none. */
  compareWith(run: Run | null, title = ""): void {
    this.comparing.value = run === null ? null : { run, title };
  }

  /** Compares with the run before the last edit. */
  compareBefore(): void {
    this.compareWith(this.before.value, words("compare_before"));
  }

  /** Compares with a run of the text that the file holds. */
  async compareSaved(): Promise<void> {
    const file = this.file.value;
    if (file !== null) await this.compareText(file.name, file.text, words("compare_saved"));
  }

  /** Compares with a recorded page, or with a run of a program, or a trace, which the source reads. */
  async compareFile(file: { readonly name: string; text(): Promise<string> }): Promise<void> {
    const text = await file.text();
    const found = recordingIn(text);
    if (found === null && this.can("record")) return this.compareText(file.name, text, file.name);
    try {
      if (found === null) throw new Error(words("compare_no_recording"));
      this.compareRecorded(await readRecording(fromBase64(found)), file.name);
    } catch (error) {
      this.notice("error", words("not_compared", { name: file.name, why: reason(error) }));
    }
  }

  private async compareText(name: string, text: string, title: string): Promise<void> {
    try {
      const content = await this.record({ type: "record", ask: 0, name, text, form: "recording" });
      this.compareRecorded(await readRecording(fromBase64(content)), title);
    } catch (error) {
      this.notice("error", words("not_compared", { name, why: reason(error) }));
    }
  }

  private compareRecorded([first]: Awaited<ReturnType<typeof readRecording>>, title: string): void {
    if (first !== undefined) this.compareWith(runOf(first), title);
  }

  /** Returns the text of a page of the run as the text of the editor does it now; null, with a notice, if it cannot be had. */
  async page(): Promise<string | null> {
    try {
      return await this.record({ type: "record", ask: 0, name: this.file.value?.name ?? "program.script", text: this.text.value, form: "page" });
    } catch (error) {
      this.notice("error", words("no_page", { why: reason(error) }));
      return null;
    }
  }

  private async record(message: Extract<ToSource, { type: "record" }>): Promise<string> {
    this.isRecording.value = true;
    try {
      const answer = await this.requests.send(message);
      if (answer.type !== "recorded") throw new Error(answer.type);
      return answer.content;
    } finally {
      this.isRecording.value = false;
    }
  }

  // ---------------------------------------------------------------- time

  /** Shows a time, the nearest tick; the exact state follows. At the end it stays with the end of a run that grows. */
  setCursor(t: number): void {
    this.isFollowing.value = false;
    this.wanted_s = t >= this.end.value && t > 0 ? Infinity : Math.max(Math.round(t / TICK_S) * 4 / 1000, 0);
    this.place();
    this.seek();
  }

  /** Shows a time on the way of playback, which need not be a tick; `asks`: for the exact state too. */
  advance(t: number, asks: boolean): void {
    this.wanted_s = t;
    this.cursor.value = t;
    if (asks) this.seek();
  }

  /** Plays from the cursor, from 0 at the end, and computes again what Stop has ended; goes with the controller's time where time goes on by itself. */
  play(): void {
    if (this.can("live")) {
      this.isFollowing.value = true;
      return;
    }
    if (this.run.value !== null && this.run.value === this.halted) {
      this.halted = null;
      this.changed();
    }
    if (this.run.value?.ended != null && this.cursor.value >= this.end.value) this.setCursor(0);
    this.isPlaying.value = true;
  }

  /** Holds the cursor. */
  pause(): void {
    this.isFollowing.value = false;
    this.isPlaying.value = false;
  }

  /** What the button Pause does: pauses the program of a controller that may be commanded, else the picture. */
  pressPause(): void {
    if (this.can("control")) this.command("pause");
    else this.pause();
  }

  /** What the button Stop does: stops the program of a controller that may be commanded, else playback. */
  pressStop(): void {
    if (this.can("control")) this.command("stop");
    else this.stopAll();
  }

  private command(action: ControlAction): void {
    this.requests.send({ type: "control", ask: 0, action }).catch((error: unknown) => this.notice("warning", reason(error)));
  }

  /** Ends playback and a computation that goes on; the cursor goes to 0, or on with a controller's time. */
  stopAll(): void {
    if (this.can("live")) {
      this.isFollowing.value = true;
      return;
    }
    this.pause();
    if (this.run.value?.ended === null) this.halted = this.run.value;
    this.transmit({ type: "stop" });
    this.setCursor(0);
  }

  /** Goes to the next (1) or previous (-1) beginning of a statement of the chosen thread. Several in a row follow one another. */
  async step(by: 1 | -1): Promise<void> {
    this.pause();
    this.steps += by;
    if (Math.abs(this.steps) > 1 || this.isStepping) return;
    this.isStepping = true;
    const run = this.run.value;
    try {
      while (this.steps !== 0) {
        const next = this.steps > 0 ? 1 : -1;
        this.steps -= next;
        await this.stepOnce(next);
      }
    } catch (error) {
      this.steps = 0;
      // A run that has been replaced meanwhile is not worth a word.
      if (run === this.run.value) this.notice("warning", reason(error));
    } finally {
      this.isStepping = false;
    }
  }

  /** Goes to the next (1) or previous (-1) event, contact or begin of a move, or to that of the chosen lane. */
  jumpToEvent(by: 1 | -1): void {
    const stops = this.laneStops?.() ?? null;
    const t = stops === null ? this.run.value?.eventBeside(this.cursor.value, by) : nextStop(stops, this.cursor.value, by);
    if (t != null) this.jump(t);
  }

  /** What a click on a place in time does: pauses, moves the cursor, and sends the editor to the line if there is one. */
  jump(t: number, place: Place | null = null): void {
    this.pause();
    this.setCursor(t);
    if (place !== null) this.goToRun(place);
  }

  /** Sends the editor to a place of the text that ran. */
  goToRun({ line, column }: Place): void {
    const run = this.run.value;
    if (line > 0) this.goto.value = { line, column, ...(run === null ? {} : { version: run.version }) };
  }

  /** What a click on a line does: the cursor goes to its next visit, after the last to its first. */
  visit(line: number): void {
    const run = this.run.value;
    const t = run?.visitAfter(line, run.lineAt(this.cursor.value) === line ? this.cursor.value : -1);
    if (t != null) this.jump(t);
  }

  /** What a click on a row of the tree does: it is looked at, and the cursor goes to its next begin, after the last to its first. */
  visitRow(row: number): void {
    const tree = this.tree.value;
    const run = this.runOfTree.value;
    const again = this.row.value === row;
    this.row.value = row;
    if (tree === null || run === null || this.can("live")) return;
    const t = nextBegin(tree, run, row, again ? this.cursor.value : -1);
    if (t !== null) this.jump(t);
  }

  /** Points at a time, a line or both, without moving anything; null: at nothing. */
  point(hover: Hover | null): void {
    this.hover.value = hover;
  }

  /** Asks for rows of a stretch of the newest run; they are in its samples when the promise is kept. */
  async detail(from_s: number, to_s: number, step_s: number): Promise<void> {
    const run = this.run.value;
    if (run !== null && this.can("seek")) await this.requests.send({ type: "detail", ask: 0, run: run.number, from_s, to_s, step_s });
  }

  // ---------------------------------------------------------------- requests and notices

  /** Asks the source about the present text; rejects with its reason where it refuses. */
  ask<S extends Service>(service: S, given: { readonly [name: string]: Json } = {}): Promise<Results[S] | null> {
    this.flush();
    const asked = this.request({ type: "service", ask: 0, service, version: this.version.value, ...given });
    return asked.then((message) => (message.type === "answer" ? (message.result as unknown as Results[S]) : null));
  }

  /** Sends a message that is answered with the same `ask`; rejects where it is refused or not answered. */
  request(message: Request): Promise<FromSource> {
    return this.requests.send(message);
  }

  /** Sends a message that nothing answers, such as those of jogging. */
  send(message: Exclude<ToSource, { readonly ask: number }>): void {
    this.transmit(message);
  }

  notice(severity: Notice["severity"], text: string): void {
    const others = this.notices.value.filter((notice) => notice.text !== text);
    this.notices.value = [...others, { id: this.nextNotice++, severity, text }].slice(-NOTICES_MAX);
  }

  dismiss(id: number): void {
    this.notices.value = this.notices.value.filter((notice) => notice.id !== id);
  }

  // ---------------------------------------------------------------- what the source says

  message(message: FromSource): void {
    switch (message.type) {
      case "hello":
        this.hello.value = message;
        if (message.settings !== undefined) this.settings.take(message.settings);
        // A source that was lost knows nothing of what was done meanwhile, and begins with a file of its own choice.
        this.awaitsFile = this.file.value !== null && this.can("edit");
        if (this.version.value > 0) this.tellNow();
        return;
      case "scene":
        this.scene.value = message;
        return;
      case "file":
        this.takeFile(message);
        return;
      case "file_changed":
        this.takeChange(message);
        return;
      case "problems":
        if (message.version !== this.version.value) return;
        this.problems.value = message;
        if (message.start !== undefined) this.beginAnew(message.start);
        return;
      case "run_began":
        this.begin(message);
        return;
      case "moment":
        this.present.value = message.moment;
        this.follow(message.moment);
        this.controller.value = message.controller;
        return;
      case "notice":
        this.notice(message.severity, message.text);
        return;
      case "refused":
        if (!this.requests.settle(message)) this.notice("error", message.text);
        return;
      case "state":
      case "answer":
      case "done":
      case "saved":
      case "detail_ended":
      case "recorded":
        this.requests.settle(message);
        return;
      default: {
        const run = this.run.value;
        if (run === null || message.run !== run.number) return;
        run.take(message);
        this.grow();
      }
    }
  }

  /** The text holds nothing: what ran before is no run of it. */
  private beginAnew(start: Moment): void {
    this.pause();
    this.parked ??= this.run.value;
    this.run.value = this.before.value = null;
    this.momentRun.value = 0;
    this.moment.value = start;
    this.cursor.value = this.wanted_s = 0;
  }

  rows(rows: Rows): void {
    if (rows.run !== this.run.value?.number) return;
    this.run.value.takeRows(rows);
    if (this.can("live")) this.run.value.samples.forget(this.run.value.samples.end_s - WINDOW_S);
    this.grow();
  }

  linked(link: Link): void {
    this.link.value = link;
    if (link !== "lost") return;
    // What was known of a controller may be wrong by now.
    if (this.controller.value !== null) this.controller.value = { ...this.controller.value, link: "lost" };
    this.steps = 0;
    this.requests.drop(words("link_lost"));
  }

  // ---------------------------------------------------------------- inside

  private isStepping = false;
  /** The run of the text before it was emptied: the next one may begin with its rows. */
  private parked: Run | null = null;
  /** From a new greeting until the source has the file of the page open again. */
  private awaitsFile = false;

  private transmit(message: ToSource): void {
    this.source.send(message);
  }

  /** Another text or other options: a new version, which is told. */
  private changed(): void {
    this.version.value++;
    this.isOverdue.value = false;
    clearTimeout(this.overdue);
    this.overdue = setTimeout(() => (this.isOverdue.value = this.run.value?.version !== this.version.value), STALE_MS);
    this.tell();
  }

  /** Tells the text: at once after a pause, else at the end of the pause. */
  private tell(): void {
    this.isUntold = true;
    if (this.quiet !== undefined) return;
    this.tellNow();
    this.quiet = setTimeout(() => {
      this.quiet = undefined;
      if (this.isUntold) this.tell();
    }, EDIT_MS);
  }

  /** Tells a text that was not told yet: what is asked is about it. */
  private flush(): void {
    if (this.isUntold) this.tellNow();
  }

  private tellNow(): void {
    // A text is kept as a draft of the file that the source has open.
    this.isUntold = this.awaitsFile;
    if (!this.can("edit") || this.awaitsFile) return;
    this.told.set(this.version.value, { text: this.text.value, tree: this.tree.value });
    if (this.told.size > TOLD_MAX) this.told.delete(this.told.keys().next().value!);
    this.transmit({ type: "program", version: this.version.value, text: this.text.value, options: this.options.value });
  }

  private takeFile(file: FileInfo): void {
    const was = this.file.value;
    if (this.awaitsFile && !this.isOpening && was !== null && was.name !== file.name) {
      this.request({ type: "open", ask: 0, name: was.name }).catch((error: unknown) => {
        if (this.link.value === "open") this.notice("error", words("not_opened", { name: was.name, why: reason(error) }));
      });
      return;
    }
    const isAgain = was !== null && was.name === file.name && !this.isOpening;
    if (this.awaitsFile) {
      this.awaitsFile = false;
      if (isAgain) this.tellNow();
    }
    if (isAgain) {
      // After a lost link: the text of the page is newer than what the source has kept.
      if (file.digest !== was.digest) this.takeChange({ type: "file_changed", name: file.name, text: file.text, digest: file.digest, ...(file.tree === undefined ? {} : { tree: file.tree }) });
      return;
    }
    this.file.value = file;
    this.row.value = 0;
    this.conflict.value = null;
    this.draftAt.value = null;
    const { draft } = file;
    if (draft !== undefined && draft.text !== file.text) {
      this.draftAt.value = draft.at;
      if (draft.seen !== file.digest) this.conflict.value = { why: "draft", theirs: file.text, digest: file.digest };
    }
    this.isPlaying.value = false;
    // A controller goes on, whatever file is open.
    if (was !== null && !this.can("live")) this.restart();
    if (was !== null) this.chosen.reset({});
    this.text.value = draft?.text ?? file.text;
    this.changed();
  }

  /** Forgets the runs of another program. */
  private restart(): void {
    this.run.value = this.parked = null;
    this.before.value = null;
    this.comparing.value = null;
    this.problems.value = null;
    this.moment.value = null;
    this.wanted_s = 0;
    this.cursor.value = 0;
  }

  private takeChange(change: Extract<FromSource, { type: "file_changed" }>): void {
    const file = this.file.value;
    if (file === null || file.name !== change.name || change.digest === file.digest) return;
    if (change.tree !== undefined && change.text !== undefined) {
      this.takeTree({ ...file, text: change.text, digest: change.digest, tree: change.tree });
    } else if (change.text === undefined && file.tree !== undefined) {
      // What it was is still shown: a tool that writes it may take it away for a moment.
      this.notice("warning", words("file_gone", { name: file.name }));
    } else if (change.text === undefined) {
      this.settleFile({ ...file, text: "", digest: change.digest, is_new: true });
      this.notice("warning", words("file_gone", { name: file.name }));
    } else if (this.text.value === change.text) {
      this.settleFile({ ...file, text: change.text, digest: change.digest, is_new: false });
    } else if (!this.isModified.value) {
      this.settleFile({ ...file, text: change.text, digest: change.digest, is_new: false });
      this.replace(change.text);
      this.notice("information", words("file_read_again", { name: file.name }));
    } else {
      this.conflict.value = { why: "disk", theirs: change.text, digest: change.digest };
    }
  }

  /** Another tool has written the task: its script runs again. */
  private takeTree(file: FileInfo): void {
    this.file.value = file;
    this.row.value = Math.min(this.row.value, file.tree!.rows.length);
    this.text.value = file.text;
    this.changed();
    this.notice("information", words("file_read_again", { name: file.name }));
  }

  private settleFile(file: FileInfo): void {
    const { draft: _, ...known } = file;
    this.file.value = known;
    this.conflict.value = null;
    if (this.text.value === file.text) this.draftAt.value = null;
  }

  private begin(message: Extract<FromSource, { type: "run_began" }>): void {
    const last = this.run.value ?? this.parked;
    this.parked = null;
    // By the time that it begins the text may be another one.
    const present = { text: this.text.value, tree: this.tree.value };
    const { text, tree } = this.told.get(message.version) ?? (message.version === this.version.value ? present : (last ?? { text: "", tree: null }));
    for (const version of this.told.keys()) if (version < message.version) this.told.delete(version);
    const run = new Run(message.run, message.version, message.options, text, tree);
    const before = this.before.value;
    // A run that was replaced early shows less than the one before it.
    const fuller = last !== null && (last.ended !== null || before === null || last.known_s >= before.known_s) ? last : before;
    const base = last !== null && last.known_s >= message.same_until_s ? last : fuller;
    if (base !== null) run.continueFrom(base, message.same_until_s);
    // The time of a controller that begins anew has nothing to do with that before.
    this.before.value = this.can("live") ? null : fuller;
    this.run.value = run;
    if (message.version === this.version.value) this.isOverdue.value = false;
    this.grow();
  }

  /** With "live": the cursor goes with the controller's time. */
  private follow(moment: Moment): void {
    if (!this.isFollowing.value) return;
    this.moment.value = moment;
    this.momentRun.value = this.run.value?.number ?? 0;
    this.wanted_s = moment.t;
    this.cursor.value = moment.t;
  }

  /** The run is longer or has ended: the cursor goes where it was wanted, and its state is asked for. */
  private grow(): void {
    if (this.can("live")) return;
    this.place();
    if (!this.isExact.value) this.seek();
  }

  private place(): void {
    this.cursor.value = Math.min(this.wanted_s, this.end.value);
  }

  private show(moment: Moment): void {
    this.moment.value = moment;
    this.momentRun.value = this.run.value?.number ?? 0;
  }

  /** Asks for the state at the cursor: one question at a time, then the newest. */
  private seek(): void {
    const run = this.run.value;
    if (run === null) return;
    const { last } = run;
    if (last !== null && Math.abs(last.t - this.cursor.value) < TICK_S / 4) {
      this.show(last);
      return;
    }
    if (!this.can("seek") || this.link.value !== "open" || (run.ended === null && run.known_s < this.cursor.value)) return;
    if (this.isSeeking) {
      this.seeksAgain = true;
      return;
    }
    this.isSeeking = true;
    this.seeksAgain = false;
    this.requests
      .send({ type: "seek", ask: 0, run: run.number, t: this.cursor.value })
      .then((answer) => {
        // What a step has found since is more exact: it knows the statement.
        if (answer.type === "state" && answer.run === this.run.value?.number && !this.isExact.value) this.show(answer.moment);
      })
      .catch((error: unknown) => {
        if (run === this.run.value && this.link.value === "open") this.notice("warning", words("no_state", { why: reason(error) }));
      })
      .finally(() => {
        this.isSeeking = false;
        if (this.seeksAgain && !this.isExact.value) this.seek();
      });
  }

  private async stepOnce(by: 1 | -1): Promise<void> {
    const run = this.run.value;
    if (run === null || !this.can("step")) return;
    const position = this.isExact.value ? this.moment.value?.position : undefined;
    const answer = await this.requests.send({
      type: "step", ask: 0, run: run.number, by, thread: this.thread.value, t: this.cursor.value, ...(position === undefined ? {} : { position }),
    });
    if (answer.type !== "state" || answer.run !== this.run.value?.number) return;
    this.wanted_s = answer.moment.t;
    this.cursor.value = answer.moment.t;
    this.show(answer.moment);
  }
}

function reason(error: unknown): string {
  return said(error instanceof Error ? error.message : String(error));
}
