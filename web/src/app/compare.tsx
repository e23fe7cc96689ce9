/** Which run the newest is compared with, how their times are laid over each other, and how much they differ. */

import { signal, useSignal } from "@preact/signals";
import type { Alignment } from "../model/compare.ts";
import type { Studio } from "../model/studio.ts";
import { format } from "../model/units.ts";
import { text } from "../text/text.ts";
import { Icon } from "./icons.tsx";

export const isCompareOpen = signal(false);

export function ComparePanel({ studio }: { studio: Studio }) {
  const isDragged = useSignal(false);
  if (!isCompareOpen.value) return null;
  const comparing = studio.comparing.value;
  const take = (file: File | undefined) => {
    if (file !== undefined) void studio.compareFile(file);
  };
  return (
    <aside
      class={isDragged.value ? "options compare dragged" : "options compare"} aria-label={text("compare_title")}
      onDragOver={(event) => {
        event.preventDefault();
        isDragged.value = true;
      }}
      onDragLeave={() => (isDragged.value = false)}
      onDrop={(event) => {
        event.preventDefault();
        isDragged.value = false;
        take(event.dataTransfer?.files[0]);
      }}
    >
      <span class="tools" role="group" aria-label={text("compare")}>
        <span class="label">{text("compare")}</span>
        {studio.can("edit") && (
          <button type="button" disabled={studio.before.value === null} onClick={() => studio.compareBefore()}>{text("compare_before")}</button>
        )}
        {studio.can("edit") && studio.can("record") && (
          <button type="button" disabled={studio.isRecording.value} onClick={() => void studio.compareSaved()}>{text("compare_saved")}</button>
        )}
        <label class="file-choice" title={text("compare_file_hint")}>
          <span>{text("compare_file")}</span>
          <input
            type="file" class="unseen" aria-label={text("compare_file")} accept=".html,.script,.csv,.jsonl"
            onChange={(event) => {
              take(event.currentTarget.files?.[0]);
              event.currentTarget.value = "";
            }}
          />
        </label>
      </span>
      {comparing !== null && (
        <>
          <span class="compared-name">{comparing.title}</span>
          <Difference studio={studio} />
          <select
            aria-label={text("align")} title={text("align")} value={studio.alignment.value}
            onChange={(event) => (studio.alignment.value = event.currentTarget.value as Alignment)}
          >
            <option value="time">{text("align_time")}</option>
            <option value="visit">{text("align_visit")}</option>
          </select>
          <button type="button" onClick={() => studio.compareWith(null)}>{text("compare_nothing")}</button>
        </>
      )}
      <button type="button" class="tool plain" aria-label={text("close")} title={text("close")} onClick={() => (isCompareOpen.value = false)}><Icon name="close" /></button>
    </aside>
  );
}

/** How much longer the newest run takes. */
function Difference({ studio }: { studio: Studio }) {
  const run = studio.run.value;
  void run?.revision.value;
  const other = studio.comparing.value?.run;
  if (run?.ended == null || other === undefined) return null;
  const longer = run.known_s - other.known_s;
  const words = Math.abs(longer) < 0.0005 ? text("compare_same") : text(longer > 0 ? "compare_longer" : "compare_shorter", { t: format(Math.abs(longer), "time") });
  return <span class="compared-time">{words}</span>;
}

/** Writes the run as a page, into the folder of downloads. */
export async function saveAsPage(studio: Studio): Promise<void> {
  const page = await studio.page();
  if (page === null) return;
  const link = document.createElement("a");
  link.href = URL.createObjectURL(new Blob([page], { type: "text/html" }));
  link.download = `${(studio.file.value?.name ?? "run").replace(/\.[^.]*$/, "").replaceAll("/", "-")}.plot.html`;
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60_000);
}
