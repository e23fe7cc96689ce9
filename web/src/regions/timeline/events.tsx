/** The events of a run as a table: what the lanes show, for those who read it. */

import { useMemo, useState } from "preact/hooks";
import { seconds } from "../../model/units.ts";
import { text } from "../../text/text.ts";
import { entryText, kindText } from "./describe.ts";
import type { TimelineState } from "./state.ts";

/** Rows in the document. */
const PAGE = 100;

export function Events({ state }: { state: TimelineState }) {
  const [isOpen, setOpen] = useState(false);
  const run = state.studio.run.value;
  const count = run === null || run.revision.value < 0 ? 0 : run.events.length + run.moves.length + run.contacts.filter((contact) => contact.is_contact).length;
  return (
    <details class="timeline-events" onToggle={(event) => setOpen((event.currentTarget as HTMLDetailsElement).open)}>
      <summary>{text("timeline_events", { count })}</summary>
      {isOpen && <EventTable state={state} count={count} />}
    </details>
  );
}

function EventTable({ state, count }: { state: TimelineState; count: number }) {
  const { studio } = state;
  const run = studio.run.value;
  const entries = useMemo(() => state.lanesOf(run)?.entries() ?? [], [run, count]);
  const [page, setPage] = useState<number | null>(null);
  // Until people turn pages, the one with the cursor.
  const first = entries.findIndex(({ t }) => t >= studio.cursor.value);
  const last = Math.max(Math.ceil(entries.length / PAGE) - 1, 0);
  const shown = Math.min(page ?? Math.floor((first < 0 ? Math.max(entries.length - 1, 0) : first) / PAGE), last);
  return (
    <div class="event-table" tabIndex={0} role="group" aria-label={text("timeline_events", { count })}>
      {last > 0 && (
        <p class="event-pages">
          <button type="button" class="timeline-tool" disabled={shown === 0} onClick={() => setPage(shown - 1)}>{text("timeline_page_before")}</button>
          {text("timeline_page", { page: shown + 1, pages: last + 1 })}
          <button type="button" class="timeline-tool" disabled={shown === last} onClick={() => setPage(shown + 1)}>{text("timeline_page_after")}</button>
        </p>
      )}
      <table>
        <thead>
          <tr>
            <th scope="col">{text("timeline_head_time")}</th>
            <th scope="col">{text("timeline_head_kind")}</th>
            <th scope="col">{text("timeline_head_line")}</th>
            <th scope="col">{text("timeline_head_text")}</th>
          </tr>
        </thead>
        <tbody>
          {entries.slice(shown * PAGE, (shown + 1) * PAGE).map((entry, index) => (
            <tr
              key={shown * PAGE + index} class={`kind-${entry.kind}`}
              onPointerEnter={() => studio.point({ t: entry.t, ...(entry.line > 0 ? { line: entry.line } : {}), region: "timeline" })} onPointerLeave={() => studio.point(null)}
            >
              <td>
                <button type="button" class="event-time" onClick={() => studio.jump(entry.t, entry.line > 0 ? { line: entry.line, column: 1 } : null)}>{seconds(entry.t)}</button>
              </td>
              <td>{kindText(entry.kind)}</td>
              <td class="number">{entry.line > 0 ? entry.line : ""}</td>
              <td class="event-text">{entryText(entry)}</td>
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  );
}
