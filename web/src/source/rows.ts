/**
 * Rows of samples as they come from a source: little endian, `u32` magic "ESC1", `u32` run, `u32` first tick, `u32` ticks
 * from one row to the next (0: the first column lists the ticks), `u32` rows, `u16` columns, `u16` 0; for each column
 * `u8` kind and `u8` number of its name; zeros up to a multiple of 8; the columns one after the other, each filled up to
 * a multiple of 8 bytes. A tick is 4 ms.
 */

export const TICK_S = 0.004;

/** Names of columns by their number; new ones are added at the end. SI units, base frame. */
export const COLUMNS = [
  "tick", "q1", "q2", "q3", "q4", "q5", "q6", "qd1", "qd2", "qd3", "qd4", "qd5", "qd6", "x", "y", "z", "rx", "ry", "rz", "speed",
  "qa1", "qa2", "qa3", "qa4", "qa5", "qa6", "fx", "fy", "fz", "mx", "my", "mz",
] as const;

export type Column = (typeof COLUMNS)[number];
export type Samples = Float32Array | Float64Array | Uint16Array | Int32Array;

const MAGIC = 0x31435345; // "ESC1"
const KINDS = [Float32Array, Float64Array, Uint16Array, Int32Array] as const;

export interface Rows {
  readonly run: number;
  /** Ticks of the rows, ascending. */
  readonly ticks: Int32Array;
  readonly columns: ReadonlyMap<Column, Samples>;
}

/** Reads a frame of rows; the columns are views of it. Throws an Error on any other bytes. */
export function readRows(frame: ArrayBuffer): Rows {
  const view = new DataView(frame);
  if (frame.byteLength < 24 || view.getUint32(0, true) !== MAGIC) throw new Error("no frame of rows");
  const run = view.getUint32(4, true);
  const first = view.getUint32(8, true);
  const step = view.getUint32(12, true);
  const rows = view.getUint32(16, true);
  const count = view.getUint16(20, true);
  let offset = padded(24 + 2 * count);
  if (frame.byteLength < offset) throw new Error("a frame of rows without all of its columns");
  const columns = new Map<Column, Samples>();
  for (let index = 0; index < count; index++) {
    const Kind = KINDS[view.getUint8(24 + 2 * index)];
    const name = COLUMNS[view.getUint8(25 + 2 * index)];
    if (Kind === undefined || name === undefined) throw new Error("a column of an unknown kind or name");
    const size = rows * Kind.BYTES_PER_ELEMENT;
    if (offset + size > frame.byteLength) throw new Error(`a frame of rows ends in column ${name}`);
    columns.set(name, new Kind(frame, offset, rows));
    offset = padded(offset + size);
  }
  const listed = columns.get("tick");
  const ticks = listed instanceof Int32Array ? listed : Int32Array.from({ length: rows }, (_, row) => first + row * step);
  if (step === 0 && listed === undefined) throw new Error("a frame of rows without times");
  return { run, ticks, columns };
}

function padded(size: number): number {
  return (size + 7) & ~7;
}
