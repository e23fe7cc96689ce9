/**
 * A recording as its bytes: gzip of `u32` length of the head, the head (JSON), and the columns of the rows of each run.
 * `elitescript.conversation.recording` writes it and says what it holds.
 */

import type { FromSource, Moment } from "./messages.ts";
import { COLUMNS, type Column, type Rows, type Samples } from "./rows.ts";

export interface RecordedRun {
  /** From `hello` to `run_ended`, without rows. */
  readonly said: readonly FromSource[];
  /** The moment before the program began, if it is known. */
  readonly first: Moment | null;
  /** Changes of program globals. */
  readonly globals: readonly { readonly name: string; readonly t: readonly number[]; readonly value: readonly string[]; readonly type: readonly string[] }[];
  /** What threads wait for, from a time on. */
  readonly waits: readonly { readonly thread: string; readonly t: readonly number[]; readonly value: readonly string[] }[];
  readonly rows: Rows;
}

interface Head {
  readonly format: number;
  readonly runs: readonly (Omit<RecordedRun, "rows" | "first"> & {
    readonly first?: Moment;
    readonly rows: { readonly count: number; readonly columns: readonly { readonly name: string; readonly step: number; readonly order: number }[] };
  })[];
}

const FORMAT = 1;

/** Reads a recording; throws an Error on anything else. */
export async function readRecording(packed: Uint8Array<ArrayBuffer>): Promise<readonly RecordedRun[]> {
  const bytes = await unpacked(packed);
  const view = new DataView(bytes);
  const begin = 4 + (bytes.byteLength < 4 ? Infinity : view.getUint32(0, true));
  if (begin > bytes.byteLength) throw new Error("no recording");
  const head = JSON.parse(new TextDecoder().decode(new Uint8Array(bytes, 4, begin - 4))) as Head;
  if (head.format !== FORMAT) throw new Error(`a recording of format ${head.format}; this page reads format ${FORMAT}`);
  let offset = begin;
  return head.runs.map((run) => {
    const { count } = run.rows;
    const columns = new Map<Column, Samples>();
    for (const { name, step, order } of run.rows.columns) {
      const column = COLUMNS.find((known) => known === name);
      if (column === undefined) throw new Error(`a recording with a column ${name}`);
      const size = (step === 0 ? 8 : 4) * count;
      if (offset + size > bytes.byteLength) throw new Error(`the recording ends in column ${name}`);
      columns.set(column, step === 0 ? floats(view, offset, count) : decoded(new Uint8Array(bytes, offset, size), count, step, order));
      offset += size;
    }
    const ticks = Int32Array.from(columns.get("tick") ?? []);
    columns.delete("tick");
    const number = run.said.find((message) => message.type === "run_began")?.run ?? 0;
    return { said: run.said, first: run.first ?? null, globals: run.globals, waits: run.waits, rows: { run: number, ticks, columns } };
  });
}

/** The bytes of a text in base 64. */
export function fromBase64(text: string): Uint8Array<ArrayBuffer> {
  const found = atob(text.trim());
  const bytes = new Uint8Array(found.length);
  for (let index = 0; index < found.length; index++) bytes[index] = found.charCodeAt(index);
  return bytes;
}

/** The content of a gzip stream. */
export async function unpacked(packed: Uint8Array<ArrayBuffer>): Promise<ArrayBuffer> {
  try {
    return await new Response(new Blob([packed]).stream().pipeThrough(new DecompressionStream("gzip"))).arrayBuffer();
  } catch {
    throw new Error("no recording, or a damaged one");
  }
}

function floats(view: DataView, offset: number, count: number): Float64Array {
  return Float64Array.from({ length: count }, (_, row) => view.getFloat64(offset + 8 * row, true));
}

/** Values whose folded differences are in four planes of bytes, the lowest first. */
function decoded(planes: Uint8Array, count: number, step: number, order: number): Float64Array {
  const values = new Float64Array(count);
  for (let row = 0; row < count; row++) {
    const folded = planes[row]! + 0x100 * planes[count + row]! + 0x10000 * planes[2 * count + row]! + 0x1000000 * planes[3 * count + row]!;
    values[row] = folded % 2 === 0 ? folded / 2 : -(folded + 1) / 2;
  }
  for (let pass = 0; pass < order; pass++) {
    let sum = 0;
    for (let row = 0; row < count; row++) values[row] = sum += values[row]!;
  }
  // The inverse of a step is a whole number: dividing by it gives the nearest float of a decimal fraction.
  const scale = Math.round(1 / step);
  for (let row = 0; row < count; row++) values[row] = values[row]! / scale;
  return values;
}
