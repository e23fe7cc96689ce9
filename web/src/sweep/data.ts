/** The data of the page of a sweep. `elitescript.sweep.results.page` writes it and says what it holds. */

import { unpacked } from "../source/recording.ts";

export type Role = "run" | "kind" | "varied" | "time" | "measure" | "margin" | "state" | "disturbances";

/** One quantity of all shown rows; with labels, the values are their numbers. */
export interface Column {
  readonly name: string;
  readonly role: Role;
  readonly labels: readonly string[] | null;
  readonly values: Int32Array | Int16Array | Float32Array;
}

export interface ShownRun {
  readonly run: number;
  /** Address of its replay beside this page; empty without one. */
  readonly page: string;
  readonly disturbances: readonly string[];
}

export interface Kind {
  /** As in the column `kind`. */
  readonly number: number;
  readonly title: string;
  readonly text: string;
  readonly story: readonly string[];
  /** The smallest run that fails so: its page and the line that plays it again; empty without them. */
  readonly smallest: { readonly page: string; readonly command: string };
  readonly region: string;
  readonly count: number;
  readonly runs: readonly ShownRun[];
}

interface Head {
  readonly format: number;
  readonly title: string;
  readonly command: string;
  /** Line that makes the replay of a run, with `{run}` for its number; empty if there is none. */
  readonly run_command: string;
  readonly version: string;
  readonly seed: number;
  readonly runs: number;
  readonly failed: number;
  readonly interval: readonly [number, number] | null;
  /** Least, median and largest cycle time, s. */
  readonly cycle_s: readonly [number, number, number] | null;
  readonly lines: readonly string[];
  readonly rows: number;
  /** Rows that are shown, and of how many one is. */
  readonly holding: readonly [number, number];
  readonly failing: readonly [number, number];
  readonly kinds: readonly Kind[];
  readonly kinds_left_out: number;
  readonly nearest: readonly (ShownRun & { readonly property: string; readonly margin: number })[];
}

export interface Sweep extends Head {
  readonly columns: readonly Column[];
}

type Packed = Head & { readonly columns: readonly { readonly name: string; readonly role: Role; readonly type: "i32" | "i16" | "f32"; readonly labels?: readonly string[] }[] };

const FORMAT = 1;
const SIZES = { i32: 4, i16: 2, f32: 4 } as const;

/** Reads the data; throws an Error on anything else. */
export async function readSweep(packed: Uint8Array<ArrayBuffer>): Promise<Sweep> {
  const bytes = await unpacked(packed);
  const view = new DataView(bytes);
  const begin = 4 + (bytes.byteLength < 4 ? Infinity : view.getUint32(0, true));
  if (begin > bytes.byteLength) throw new Error("no sweep");
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 4, begin - 4))) as Packed;
  if (head.format !== FORMAT) throw new Error(`a sweep of format ${head.format}; this page reads format ${FORMAT}`);
  let offset = begin;
  const columns = head.columns.map(({ name, role, type, labels }): Column => {
    const size = SIZES[type] * head.rows;
    if (offset + size > bytes.byteLength) throw new Error(`the sweep ends in column ${name}`);
    // A copy begins at a multiple of its size, which a typed array asks for.
    const own = bytes.slice(offset, offset + size);
    offset += size;
    const values = type === "f32" ? new Float32Array(own) : type === "i32" ? new Int32Array(own) : new Int16Array(own);
    return { name, role, labels: labels ?? null, values };
  });
  return { ...head, columns };
}
