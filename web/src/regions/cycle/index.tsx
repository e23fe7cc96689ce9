/** Region `Cycle time`: how long the arm moved and stood in each line, and what differs from the run that is compared. */

import { useSignal } from "@preact/signals";
import { useMemo } from "preact/hooks";
import { Rows } from "../../app/rows.tsx";
import { cycleRows, ORDERS, type CycleOrder, type CycleView } from "../../model/cycle.ts";
import type { Studio } from "../../model/studio.ts";
import { format } from "../../model/units.ts";
import type { Texts } from "../../text/en.ts";
import { text } from "../../text/text.ts";

const HEADS: { readonly [order in CycleOrder]: keyof Texts } = {
  line: "line", moving: "moving", standing: "standing", visits: "visits", share: "share", difference: "difference",
};

export function Cycle({ studio }: { studio: Studio }) {
  const order = useSignal<CycleOrder>("share");
  const newest = studio.run.value;
  const compared = studio.compared.value;
  void newest?.revision.value;
  void compared?.revision.value;
  // The table comes at the end of a run: until then that of the run before stays, marked as stale.
  const run = newest !== null && newest.cycle.length === 0 && newest.ended === null ? (studio.before.value ?? newest) : newest;
  const isStale = run !== newest || studio.staleFrom.value > 0;
  const list = useMemo(() => (run === null ? [] : cycleRows(run, compared, order.value)), [run, run?.cycle, compared, compared?.cycle, order.value]);
  if (run === null || list.length === 0) return <p class="empty">{text("cycle_none")}</p>;
  const columns = ORDERS.filter((name) => name !== "difference" || compared !== null);
  const source = run.text.split("\n");
  return (
    <Rows
      count={list.length} label={text("rows_of_cycle")} class={isStale ? "cycle-table stale" : "cycle-table"} keyOf={(index) => list[index]!.line || -list[index]!.before!}
      head={
        <tr>
          {columns.map((name) => (
            <th key={name} scope="col" class="number" aria-sort={order.value === name ? (name === "line" ? "ascending" : "descending") : "none"}>
              <button type="button" class="plain" onClick={() => (order.value = name)}>{text(HEADS[name])}</button>
            </th>
          ))}
          <th scope="col">{text("line_text")}</th>
        </tr>
      }
      attributes={(index) => ({
        class: rowClass(studio, list[index]!.line),
        onPointerEnter: () => list[index]!.line > 0 && studio.point({ region: "cycle", line: list[index]!.line }),
        onPointerLeave: () => studio.point(null),
      })}
      row={(index) => {
        const row = list[index]!;
        return columns.map((name) => cell(studio, row, name)).concat(
          <td key="text" class="source" title={source[row.line - 1]?.trim() ?? ""}>
            {run.nodeAt(row.line) !== "" && <strong>{`${run.nodeAt(row.line)} `}</strong>}
            {row.line > 0 ? source[row.line - 1]?.trim() : text("line_gone")}
          </td>,
        );
      }}
    />
  );
}

function cell(studio: Studio, row: CycleView, name: CycleOrder) {
  switch (name) {
    case "line":
      return (
        <td key={name} class="number">
          {row.line > 0 ? (
            <button
              type="button" tabIndex={-1} class="place" title={text("next_visit")}
              onClick={() => {
                studio.visit(row.line);
                studio.goToRun({ line: row.line, column: 1 });
              }}
            >
              {row.line}
            </button>
          ) : "–"}
        </td>
      );
    case "moving":
    case "standing":
      return <td key={name} class="number">{`${format(row[name], "time")} s`}</td>;
    case "visits":
      return <td key={name} class="number">{row.visits}</td>;
    case "share":
      return (
        <td key={name} class="number share">
          <span class="bar" style={{ width: `${(100 * row.share).toFixed(1)}%` }} aria-hidden="true" />
          <span>{(100 * row.share).toFixed(1)} %</span>
        </td>
      );
    case "difference": {
      const found = row.difference ?? 0;
      const kind = Math.abs(found) < 0.0005 ? "" : found > 0 ? " longer" : " shorter";
      return <td key={name} class={`number${kind}`}>{`${kind === "" ? "" : found > 0 ? "+" : "−"}${format(Math.abs(found), "time")} s`}</td>;
    }
  }
}

function rowClass(studio: Studio, line: number): string {
  const hovered = studio.hover.value;
  const isOutlined = hovered !== null && hovered.region !== "cycle" && line > 0 && hovered.line === line;
  return `${isOutlined ? "outlined" : ""}${line > 0 && studio.moment.value?.line === line ? " now" : ""}`.trim();
}
