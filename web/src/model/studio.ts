/** All that the page knows, and what people can do with it. Regions read its signals and call its methods. */

import { computed, signal } from "@preact/signals-core";
import type { Ability, ControllerState, FromSource, Json, Moment, Problem, RunOptions, Scene, Service, Six, ToSource } from "../source/messages.ts";
import type { Rows } from "../source/rows.ts";
import type { Link, Listener, Source } from "../source/source.ts";
import { Run } from "./run.ts";

export type Hello = Extract<FromSource, { type: "hello" }>;
export type FileInfo = Extract<FromSource, { type: "file" }>;

/** What the pointer or the caret is at: nothing scrolls because of it. */
export interface Hover {
  readonly t?: number;
  readonly line?: number;
  /** Region in which it is, which does not mark it itself. */
  readonly region: string;
}

/** What is drawn: exact where the source has answered for this time. */
export interface Shown {
  readonly t: number;
  readonly joints: Six;
  readonly exact: boolean;
}

export interface Place {
  readonly line: number;
  readonly column: number;
}

export class Studio implements Listener {
  readonly source: Source;
  readonly link = signal<Link>("connecting");
  readonly hello = signal<Hello | null>(null);
  readonly scene = signal<Scene | null>(null);
  readonly file = signal<FileInfo | null>(null);
  /** The text of the editor, and its version. */
  readonly text = signal("");
  readonly version = signal(0);
  readonly problems = signal<{ readonly version: number; readonly list: readonly Problem[]; readonly compiles: boolean } | null>(null);
  readonly options = signal<RunOptions>({});
  /** The newest run, and the one before it, whose rest is stale while the newest is not that far. */
  readonly run = signal<Run | null>(null);
  readonly before = signal<Run | null>(null);
  /** The run with which the newest is compared, if it is. */
  readonly compared = signal<Run | null>(null);
  /** Time that is shown, s. */
  readonly cursor = signal(0);
  readonly hover = signal<Hover | null>(null);
  /** Exact state at the cursor; null until the source has answered. */
  readonly moment = signal<Moment | null>(null);
  readonly controller = signal<ControllerState | null>(null);
  /** Where a click in another region sends the editor; each click is a new object. */
  readonly goto = signal<Place | null>(null);
  readonly notices = signal<readonly { readonly severity: string; readonly text: string }[]>([]);

  private nextAsk = 1;
  private readonly asked = new Map<number, { resolve: (message: FromSource) => void; reject: (reason: Error) => void }>();
  private seekAsk = 0;

  constructor(source: Source) {
    this.source = source;
  }

  start(): void {
    this.source.start(this);
  }

  can(ability: Ability): boolean {
    return this.hello.value?.abilities.includes(ability) ?? false;
  }

  /** Last time of the slider, s. */
  readonly end = computed(() => {
    const run = this.run.value;
    void run?.revision.value;
    return run?.known_s ?? 0;
  });

  // ---------------------------------------------------------------- what people do

  /** Takes a new text of the editor. */
  edit(text: string): void {
    if (text === this.text.value && this.version.value > 0) return;
    this.text.value = text;
    this.version.value++;
    this.tell();
  }

  setOptions(change: Partial<RunOptions>): void {
    this.options.value = { ...this.options.value, ...change };
    this.version.value++;
    this.tell();
  }

  /** Shows a time; the exact state follows. */
  setCursor(t: number): void {
    this.cursor.value = Math.min(Math.max(t, 0), this.end.value);
    this.seek();
  }

  /** Asks the source; rejects with its reason where it refuses. */
  ask(service: Service, given: { readonly [name: string]: Json } = {}): Promise<Json> {
    const asked = this.request({ type: "service", ask: 0, service, version: this.version.value, ...given });
    return asked.then((message) => (message.type === "answer" ? message.result : null));
  }

  /** Sends a message that is answered with the same `ask`. */
  request(message: Extract<ToSource, { readonly ask: number }>): Promise<FromSource> {
    const ask = this.nextAsk++;
    return new Promise((resolve, reject) => {
      this.asked.set(ask, { resolve, reject });
      this.source.send({ ...message, ask });
    });
  }

  // ---------------------------------------------------------------- what the source says

  message(message: FromSource): void {
    switch (message.type) {
      case "hello":
        this.hello.value = message;
        return;
      case "scene":
        this.scene.value = message;
        return;
      case "file":
        this.file.value = message;
        this.edit(message.draft?.text ?? message.text);
        return;
      case "problems":
        if (message.version === this.version.value) this.problems.value = message;
        return;
      case "run_began":
        this.before.value = this.run.value ?? this.before.value;
        this.run.value = new Run(message.run, message.version, message.options);
        return;
      case "moment":
        this.moment.value = message.moment;
        this.controller.value = message.controller;
        return;
      case "notice":
        this.notices.value = [...this.notices.value, message];
        return;
      case "state":
        if (message.ask === this.seekAsk && message.run === this.run.value?.number) this.moment.value = message.moment;
        this.settle(message.ask, message);
        return;
      case "refused":
        if (message.ask === undefined) this.notices.value = [...this.notices.value, { severity: "error", text: message.text }];
        else this.settle(message.ask, message);
        return;
      case "answer":
      case "done":
      case "saved":
      case "detail_ended":
        this.settle(message.ask, message);
        return;
      default:
        if ("run" in message && message.run === this.run.value?.number) this.run.value.take(message);
    }
  }

  rows(rows: Rows): void {
    if (rows.run === this.run.value?.number) this.run.value.takeRows(rows);
  }

  linked(link: Link): void {
    this.link.value = link;
  }

  private tell(): void {
    if (this.can("edit")) this.source.send({ type: "program", version: this.version.value, text: this.text.value, options: this.options.value });
  }

  private seek(): void {
    const run = this.run.value;
    if (run === null || !this.can("seek")) return;
    this.seekAsk = this.nextAsk++;
    this.source.send({ type: "seek", run: run.number, ask: this.seekAsk, t: this.cursor.value });
  }

  private settle(ask: number, message: FromSource): void {
    const waiting = this.asked.get(ask);
    this.asked.delete(ask);
    if (message.type === "refused") waiting?.reject(new Error(message.text));
    else waiting?.resolve(message);
  }
}
