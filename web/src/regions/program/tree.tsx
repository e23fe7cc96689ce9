/** The tree of a graphical program: which node runs, which did not, what is wrong with it; linked with text and time. */

import { useComputed, useSignal, useSignalEffect } from "@preact/signals";
import { untracked } from "@preact/signals-core";
import type { TargetedKeyboardEvent, TargetedMouseEvent } from "preact";
import { useLayoutEffect, useMemo, useRef } from "preact/hooks";
import { Icon } from "../../app/icons.tsx";
import { ROW_PX, rowsInView } from "../../app/rows.tsx";
import { type Findings, findingsOf } from "../../model/findings.ts";
import type { Studio } from "../../model/studio.ts";
import { canRun, lineToShow, placeOf, rowOf, rowsThatRan, rowsWith, shownFor, shownRows } from "../../model/tree.ts";
import type { Problem, ProgramTree } from "../../source/messages.ts";
import { kindOf, summaryOf } from "../../text/nodes.ts";
import { text } from "../../text/text.ts";

const REGION = "tree";
const SEVERITIES = ["error", "warning", "information", "hint"] as const satisfies readonly Problem["severity"][];

/** What was found at a node: the worst of it, and all of it in words. */
interface AtNode {
  severity: Problem["severity"];
  readonly texts: string[];
}

export function TreeView({ studio, tree }: { studio: Studio; tree: ProgramTree }) {
  const area = useRef<HTMLDivElement>(null);
  const scrolled = useSignal(0);
  const height = useSignal(400);
  const folded = useSignal<ReadonlySet<number>>(new Set());
  const run = studio.runOfTree.value;
  const revision = run?.revision.value ?? 0;
  const shown = useMemo(() => shownRows(tree, folded.value), [tree, folded.value]);
  const at = useMemo(() => new Map(shown.map((row, index) => [row, index])), [shown]);
  const ran = useMemo(() => (run === null ? null : rowsThatRan(tree, run)), [tree, run, revision]);
  const found = useComputed(() => atNodes(tree, findingsOf(studio)));
  const present = studio.rowsNow.value;
  const isOver = run !== null && run.ended !== null;
  const chosen = Math.min(studio.row.value, tree.rows.length);
  const active = chosen > 0 ? shownFor(tree, folded.value, chosen) : 1;

  useLayoutEffect(() => {
    const place = area.current!;
    const watch = new ResizeObserver(() => (height.value = place.clientHeight));
    watch.observe(place);
    return () => watch.disconnect();
  }, []);

  const reveal = (row: number) => {
    const place = area.current;
    const top = (shownRows(tree, folded.peek()).indexOf(row)) * ROW_PX;
    if (place === null || top < 0) return;
    if (top < place.scrollTop) place.scrollTop = top;
    else if (top + ROW_PX > place.scrollTop + place.clientHeight) place.scrollTop = top + ROW_PX - place.clientHeight;
    scrolled.value = place.scrollTop;
  };
  const unfoldTo = (row: number) => {
    const open = new Set(folded.peek());
    for (let outer = placeOf(tree, row).parent; outer > 0; outer = placeOf(tree, outer).parent) open.delete(outer);
    if (open.size !== folded.peek().size) folded.value = open;
  };
  useSignalEffect(() => {
    const row = studio.row.value;
    if (row > 0 && row <= tree.rows.length) untracked(() => (unfoldTo(row), reveal(row)));
  });
  const now = useComputed(() => studio.rowsNow.value[0] ?? 0);
  useSignalEffect(() => {
    const row = now.value;
    if (row > 0 && row <= tree.rows.length) untracked(() => reveal(shownFor(tree, folded.peek(), row)));
  });

  const fold = (row: number, isFolded: boolean) => {
    const next = new Set(folded.peek());
    if (isFolded) next.add(row);
    else next.delete(row);
    folded.value = next;
  };
  const look = (row: number) => {
    studio.row.value = row;
    point(row);
  };
  const point = (row: number) => {
    const line = lineToShow(tree, studio.runOfTree.peek(), row);
    studio.point(line > 0 ? { region: REGION, line } : null);
  };
  const press = (event: TargetedKeyboardEvent<HTMLDivElement>) => {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const place = placeOf(tree, active);
    const hasInside = place.last > active;
    const page = Math.max(Math.floor(height.value / ROW_PX) - 1, 1);
    const by: { readonly [key: string]: number } = { ArrowUp: -1, ArrowDown: 1, PageUp: -page, PageDown: page, Home: -shown.length, End: shown.length };
    const step = by[event.key];
    if (step !== undefined) look(shown[Math.min(Math.max((at.get(active) ?? 0) + step, 0), shown.length - 1)]!);
    else if (event.key === "ArrowLeft" && hasInside && !folded.value.has(active)) fold(active, true);
    else if (event.key === "ArrowLeft" && place.parent > 0) look(place.parent);
    else if (event.key === "ArrowRight" && hasInside && folded.value.has(active)) fold(active, false);
    else if (event.key === "ArrowRight" && hasInside) look(active + 1);
    else if (event.key === "Enter" || event.key === " ") studio.visitRow(active);
    else if (event.key !== "ArrowLeft" && event.key !== "ArrowRight") return;
    event.preventDefault();
  };
  const click = (event: TargetedMouseEvent<HTMLDivElement>) => {
    const target = event.target as HTMLElement;
    const row = Number(target.closest<HTMLElement>("[data-row]")?.dataset["row"] ?? 0);
    if (row === 0) return;
    if (target.closest(".fold-mark") !== null && placeOf(tree, row).last > row) fold(row, !folded.value.has(row));
    else studio.visitRow(row);
  };

  const { first, last } = rowsInView(shown.length, scrolled.value, height.value);
  const rows = shown.slice(first, last);
  // What the keyboard is at is named to readers of the screen, also while it is scrolled away.
  if (at.has(active) && !rows.includes(active)) rows.push(active);
  const main = present[0] ?? 0;
  const mainShown = main > 0 ? shownFor(tree, folded.value, main) : 0;
  const others = new Set(present.slice(1).map((row) => shownFor(tree, folded.value, row)));
  return (
    <div
      class="rows program-tree" ref={area} role="tree" tabIndex={0} aria-label={text("tree_name")} aria-activedescendant={`tree-row-${active}`}
      onKeyDown={press} onClick={click} onScroll={(event) => (scrolled.value = event.currentTarget.scrollTop)} onPointerLeave={() => studio.point(null)}
    >
      <div class="tree-rows" role="presentation" style={{ height: `${shown.length * ROW_PX}px` }}>
        {rows.map((row) => {
          const node = tree.rows[row - 1]!;
          const place = placeOf(tree, row);
          const hasInside = place.last > row;
          const isFolded = folded.value.has(row);
          const neverRan = isOver && ran !== null && !node.is_suppressed && !ran.has(row) && canRun(tree, row);
          const finding = worst(found.value, row, isFolded ? place.last : row);
          const kinds = [
            "tree-row", row === chosen ? "chosen" : "", row === mainShown ? "now" : others.has(row) ? "thread" : "",
            neverRan ? "never" : "", node.is_suppressed ? "suppressed" : "",
          ];
          return (
            <div
              key={row} id={`tree-row-${row}`} data-row={row} role="treeitem" class={kinds.filter(Boolean).join(" ")}
              aria-level={node.level + 1} aria-setsize={place.size} aria-posinset={place.position} aria-selected={row === chosen}
              {...(hasInside ? { "aria-expanded": !isFolded } : {})} {...(row === mainShown ? { "aria-current": "true" as const } : {})}
              style={{ top: `${at.get(row)! * ROW_PX}px`, paddingLeft: `${6 + Math.min(node.level, 12) * 14}px` }} onPointerEnter={() => point(row)}
            >
              <span class="fold-mark" aria-hidden="true">{hasInside && <Icon name={isFolded ? "closed" : "open"} />}</span>
              <span class="number tree-number">{row}</span>{" "}
              <span class="tree-kind">{kindOf(node.kind)}</span>{" "}
              {node.name !== "" && <strong title={node.name}>{node.name}</strong>}{" "}
              <span class="tree-summary faint" title={summaryOf(node.summary)}>{summaryOf(node.summary)}</span>{" "}
              {row === mainShown && <span class="unseen">{text("tree_runs")}</span>}
              {neverRan && <span class="tree-never" title={text("tree_never_hint")}>{text("tree_never")}</span>}
              {finding !== undefined && (
                <span class={`tree-finding ${finding.severity}`} title={finding.texts.join("\n")}>
                  <Icon name={finding.severity === "hint" ? "information" : finding.severity} />
                  <span class="unseen">{finding.texts.join("; ")}</span>
                </span>
              )}
            </div>
          );
        })}
      </div>
    </div>
  );
}

/** A field that goes from one node to the next which it finds. */
export function FindNode({ studio, tree }: { studio: Studio; tree: ProgramTree }) {
  const words = useSignal("");
  const named = (row: number) => {
    const { kind, name, summary } = tree.rows[row - 1]!;
    return `${row} ${kindOf(kind)} ${name} ${summaryOf(summary)}`;
  };
  const found = useComputed(() => rowsWith(tree, words.value, named)).value;
  const go = (by: 1 | -1) => {
    const row = studio.row.peek();
    const next = by > 0 ? (found.find((other) => other > row) ?? found[0]) : (found.findLast((other) => other < row) ?? found.at(-1));
    if (next !== undefined) studio.row.value = next;
  };
  return (
    <span class="tree-find" role="search">
      <input
        type="text" spellcheck={false} autocomplete="off" aria-label={text("tree_find")} placeholder={text("tree_find")} value={words.value}
        onInput={(event) => (words.value = event.currentTarget.value)}
        onKeyDown={(event) => {
          if (event.key === "Enter") go(event.shiftKey ? -1 : 1);
          else if (event.key === "Escape") words.value = "";
        }}
      />
      {words.value.trim() !== "" && <span class="faint" role="status">{text("tree_found", { count: found.length })}</span>}
    </span>
  );
}

function atNodes(tree: ProgramTree, { alarm, contacts, met, list }: Findings): ReadonlyMap<number, AtNode> {
  const found = new Map<number, AtNode>();
  const add = (line: number, severity: Problem["severity"], words: string) => {
    const row = rowOf(tree, line);
    if (row === 0) return;
    const known = found.get(row);
    if (known === undefined) found.set(row, { severity, texts: [words] });
    else {
      known.texts.push(words);
      if (SEVERITIES.indexOf(severity) < SEVERITIES.indexOf(known.severity)) known.severity = severity;
    }
  };
  if (alarm !== null) add(alarm.line, "error", `${alarm.code} ${alarm.text}`);
  for (const { line, severity, code, text: words } of [...met, ...list]) add(line, severity, `${text(`severity_${severity}`)} ${code}: ${words}`);
  for (const { line, first, second } of contacts) add(line, "warning", text("tree_contact", { first, second }));
  return found;
}

/** What was found from one row to another: where rows are folded, that of those in them. */
function worst(found: ReadonlyMap<number, AtNode>, first: number, last: number): AtNode | undefined {
  if (first === last) return found.get(first);
  const inside = [...found].filter(([row]) => row >= first && row <= last).map(([, one]) => one);
  if (inside.length === 0) return undefined;
  const severity = SEVERITIES.find((name) => inside.some((one) => one.severity === name))!;
  return { severity, texts: inside.flatMap((one) => one.texts) };
}
