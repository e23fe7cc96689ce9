/** A source whose side a test speaks: what the page sends is kept, what it hears is given. */

import type { FromSource, Moment, ToSource } from "../src/source/messages.ts";
import type { Rows } from "../src/source/rows.ts";
import type { Link, Listener, Source } from "../src/source/source.ts";
import { Studio } from "../src/model/studio.ts";

export class FakeSource implements Source {
  readonly sent: ToSource[] = [];
  private listener: Listener | null = null;

  start(listener: Listener): void {
    this.listener = listener;
  }

  send(message: ToSource): void {
    this.sent.push(structuredClone(message));
  }

  close(): void {}

  say(...messages: FromSource[]): void {
    for (const message of messages) this.listener!.message(message);
  }

  rows(rows: Rows): void {
    this.listener!.rows(rows);
  }

  link(link: Link): void {
    this.listener!.linked(link);
  }

  /** Messages of a type that were sent, the oldest first. */
  all<T extends ToSource["type"]>(type: T): Extract<ToSource, { readonly type: T }>[] {
    return this.sent.filter((message): message is Extract<ToSource, { readonly type: T }> => message.type === type);
  }

  last<T extends ToSource["type"]>(type: T): Extract<ToSource, { readonly type: T }> {
    return this.all(type).at(-1)!;
  }
}

export const HELLO = {
  type: "hello", protocol: 1, product: "test", mode: "live", title: "a.script",
  abilities: ["edit", "save", "services", "seek", "step", "inputs", "connect"],
} as const satisfies FromSource;

export const FILE = { type: "file", name: "a.script", text: "one\ntwo\nthree", digest: "d1" } as const satisfies FromSource;

export function moment(t: number, line = 1, position = ""): Moment {
  return { t, line, joints: [t, 0, 0, 0, 0, 0], tcp_pose: [0, 0, 0, 0, 0, 0], globals: [], signals: {}, threads: [], ...(position === "" ? {} : { position }) };
}

export function began(run: number, version: number, same_until_s = 0): FromSource {
  return { type: "run_began", run, version, same_until_s, options: {} };
}

export function ended(run: number, t: number): FromSource {
  return { type: "run_ended", run, state: "finished", moment: moment(t) };
}

export function rows(run: number, ticks: readonly number[], q1 = 0): Rows {
  return { run, ticks: Int32Array.from(ticks), columns: new Map([["q1", Float32Array.from(ticks, (tick) => q1 + tick)]]) };
}

/** A page that has its file, and has told it. */
export function opened(): { source: FakeSource; studio: Studio } {
  const source = new FakeSource();
  const studio = new Studio(source);
  studio.start();
  source.link("open");
  source.say(HELLO, FILE);
  return { source, studio };
}

/** Lets what waits for kept promises happen. */
export async function settled(): Promise<void> {
  for (let turn = 0; turn < 8; turn++) await Promise.resolve();
}

/** The parts of a text without values, and of a hint that is not there. */
export const NO_PARTS = { template: "", values: {}, hint_template: "", hint_values: {} } as const;
/** The same of an alarm. */
export const NO_ALARM_PARTS = { template: "", values: {}, hint_parts: [] } as const;
