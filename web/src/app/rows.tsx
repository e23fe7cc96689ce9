/** Long lists: only the rows in view, and some around them, are in the document. */

import { useSignal } from "@preact/signals";
import type { ComponentChildren, HTMLAttributes, Key, TargetedKeyboardEvent } from "preact";
import { useEffect, useLayoutEffect, useRef } from "preact/hooks";

/** Height of a row in pixels; also the least size of what is clicked. */
export const ROW_PX = 26;

/** Rows in the document, at most. */
export const ROWS_MAX = 200;

const AROUND = 10;

/** The rows of a list that are in view. */
export interface View {
  readonly first: number;
  readonly last: number;
}

/** First row and the one after the last that a scrolled area shows, with some around them. */
export function rowsInView(count: number, scrolled_px: number, height_px: number, head_px = 0): View {
  const first = Math.max(Math.min(Math.floor((scrolled_px - head_px) / ROW_PX) - AROUND, count - 1), 0);
  const last = Math.min(first + Math.ceil(height_px / ROW_PX) + 2 * AROUND + 1, first + ROWS_MAX, count);
  return { first, last };
}

interface Props {
  /** Number of rows. */
  readonly count: number;
  readonly row: (index: number) => ComponentChildren;
  readonly keyOf?: (index: number) => Key;
  /** Further attributes of the element of a row: its class, what happens when it is pointed at. */
  readonly attributes?: (index: number) => HTMLAttributes<HTMLLIElement> & HTMLAttributes<HTMLTableRowElement>;
  readonly label: string;
  /** Head of a table; without it the rows are a list. */
  readonly head?: ComponentChildren;
  /** Row that is brought into view when it changes; -1: none. */
  readonly at?: number;
  readonly class?: string;
}

/** A list of buttons or a table whose rows have one button each; arrow keys go from row to row. */
export function Rows({ count, row, keyOf = (index) => index, attributes = () => ({}), label, head, at = -1, class: kind = "" }: Props) {
  const area = useRef<HTMLDivElement>(null);
  const scrolled = useSignal(0);
  const height = useSignal(400);
  const active = useRef(0);

  useLayoutEffect(() => {
    const place = area.current!;
    const watch = new ResizeObserver(() => (height.value = place.clientHeight));
    watch.observe(place);
    return () => watch.disconnect();
  }, []);

  const reveal = (index: number) => {
    const place = area.current!;
    const top = index * ROW_PX;
    const room = place.clientHeight - (head === undefined ? 0 : ROW_PX);
    if (top < place.scrollTop) place.scrollTop = top;
    else if (top + ROW_PX > place.scrollTop + room) place.scrollTop = top + ROW_PX - room;
  };
  useEffect(() => {
    if (at >= 0) reveal(at);
  }, [at]);

  const press = (event: TargetedKeyboardEvent<HTMLDivElement>) => {
    const page = Math.max(Math.floor(height.value / ROW_PX) - 1, 1);
    const by: { readonly [key: string]: number } = { ArrowUp: -1, ArrowDown: 1, PageUp: -page, PageDown: page, Home: -count, End: count };
    const step = by[event.key];
    const target = event.target as HTMLElement;
    if (step === undefined || count === 0 || target.matches("input, select")) return;
    event.preventDefault();
    const from = Number(target.closest<HTMLElement>("[data-row]")?.dataset["row"] ?? -1);
    active.current = Math.min(Math.max(from + step, 0), count - 1);
    reveal(active.current);
    scrolled.value = area.current!.scrollTop;
    // The row may not be in the document before the next frame.
    requestAnimationFrame(() => area.current?.querySelector<HTMLElement>(`[data-row="${active.current}"] button`)?.focus({ preventScroll: true }));
  };

  const { first, last } = rowsInView(count, scrolled.value, height.value);
  const indices = Array.from({ length: Math.max(last - first, 0) }, (_, index) => first + index);
  const above = first * ROW_PX;
  const below = (count - last) * ROW_PX;
  return (
    <div
      class={`rows ${kind}`} ref={area} tabIndex={0} role="group" aria-label={label} onKeyDown={press}
      onScroll={(event) => (scrolled.value = event.currentTarget.scrollTop)}
    >
      {head === undefined ? (
        <ol style={{ paddingTop: `${above}px`, paddingBottom: `${below}px` }}>
          {indices.map((index) => (
            <li key={keyOf(index)} {...attributes(index)} data-row={index} aria-setsize={count} aria-posinset={index + 1}>
              {row(index)}
            </li>
          ))}
        </ol>
      ) : (
        <table aria-rowcount={count + 1}>
          <thead>{head}</thead>
          <tbody>
            {above > 0 && <tr aria-hidden="true" style={{ height: `${above}px` }} />}
            {indices.map((index) => (
              <tr key={keyOf(index)} {...attributes(index)} data-row={index} aria-rowindex={index + 2}>
                {row(index)}
              </tr>
            ))}
            {below > 0 && <tr aria-hidden="true" style={{ height: `${below}px` }} />}
          </tbody>
        </table>
      )}
    </div>
  );
}
