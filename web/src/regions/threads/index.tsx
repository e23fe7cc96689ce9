/** Region `Threads`: where each thread is at the cursor and what it waits for; the chosen one is that which steps go by. */

import type { Studio } from "../../model/studio.ts";
import type { ThreadState } from "../../source/messages.ts";
import { TICK_S } from "../../source/rows.ts";
import { said } from "../../text/said.ts";
import { text } from "../../text/text.ts";

const MAIN: ThreadState = { name: "main", line: 0, waits_for: "", function: "" };

export function Threads({ studio }: { studio: Studio }) {
  const list = threadsNow(studio);
  return (
    <div class="rows" tabIndex={0} role="group" aria-label={text("rows_of_threads")}>
      <table class="threads-table">
        <thead>
          <tr>
            <th scope="col">{text("thread")}</th><th scope="col" class="number">{text("line")}</th>
            <th scope="col">{text("waits_for")}</th><th scope="col">{text("function")}</th>
          </tr>
        </thead>
        <tbody>{list.map((thread) => <Row key={thread.name} studio={studio} thread={thread} />)}</tbody>
      </table>
    </div>
  );
}

function Row({ studio, thread }: { studio: Studio; thread: ThreadState }) {
  const { name, line } = thread;
  const wait = [said(thread.waits_for), thread.because ?? ""].filter((part) => part !== "").join(": ");
  return (
    <tr onPointerEnter={() => line > 0 && studio.point({ region: "threads", line })} onPointerLeave={() => studio.point(null)}>
      <th scope="row">
        <label>
          <input type="radio" name="thread" checked={studio.thread.value === name} aria-label={text("step_by", { name })} onChange={() => (studio.thread.value = name)} />
          {name}
        </label>
      </th>
      <td class="number">
        {line > 0 && <button type="button" class="place" title={studio.nodeInRun(line)} onClick={() => studio.goToRun({ line, column: 1 })}>{line}</button>}
      </td>
      <td title={wait}>{wait}</td>
      <td class="faint">{thread.function}</td>
    </tr>
  );
}

/** Exact where the state is; else the lines that the run has at the cursor. A single thread is at the alarm's line from the alarm on. */
function threadsNow(studio: Studio): readonly ThreadState[] {
  const alarm = studio.staleFrom.value > 0 ? null : studio.run.value?.alarm;
  void studio.run.value?.revision.value;
  const found = threadsAt(studio);
  if (alarm == null || alarm.line === 0 || studio.cursor.value < alarm.t - TICK_S / 4) return found;
  return found.length === 1 ? found.map((only) => ({ ...only, line: alarm.line, waits_for: "" })) : found;
}

function threadsAt(studio: Studio): readonly ThreadState[] {
  const moment = studio.moment.value;
  if (moment !== null && studio.isExact.value && moment.threads.length > 0) return moment.threads;
  const run = studio.run.value;
  void run?.revision.value;
  const known = [...(run?.lines.keys() ?? [])]
    .map((name) => ({ ...MAIN, name, line: run!.lineAt(studio.cursor.value, name) }))
    .filter((thread) => thread.line > 0 || thread.name === "main");
  return known.length > 0 ? known : [MAIN];
}
