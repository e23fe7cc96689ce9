/** Two texts of one file, beside each other where they differ, and the choice between them. */

import { useMemo } from "preact/hooks";
import { pairLines, type LinePair } from "../model/difference.ts";
import type { Conflict, Studio } from "../model/studio.ts";
import type { Texts } from "../text/en.ts";
import { text } from "../text/text.ts";
import { Icon } from "./icons.tsx";

/** Equal lines that are shown around a difference, and lines that are shown in all. */
const AROUND = 2;
const LINES_MAX = 200;

const WHY: { readonly [why in Conflict["why"]]: keyof Texts } = { disk: "conflict_disk", draft: "conflict_draft", save: "conflict_save" };

export function ConflictView({ studio }: { studio: Studio }) {
  const conflict = studio.conflict.value;
  if (conflict === null) return null;
  return (
    <aside class="conflict" aria-label={text("conflict_title")}>
      <p role="alert">
        <Icon name="warning" /> <strong>{text(WHY[conflict.why], { name: studio.file.value?.name ?? "" })}</strong>
      </p>
      <Differences theirs={conflict.theirs} mine={studio.text.value} />
      <p class="choices">
        <button type="button" onClick={() => studio.takeTheirs()}>{text("conflict_theirs")}</button>
        <button type="button" onClick={() => studio.keepMine()}>{text("conflict_mine")}</button>
        <span class="faint">{text("conflict_hint")}</span>
      </p>
    </aside>
  );
}

function Differences({ theirs, mine }: { theirs: string; mine: string }) {
  const rows = useMemo(() => around(pairLines(theirs, mine)), [theirs, mine]);
  return (
    <div class="differences" tabIndex={0} role="group" aria-label={text("conflict_lines")}>
      <table>
        <thead>
          <tr><th scope="col">{text("conflict_on_disk")}</th><th scope="col">{text("conflict_here")}</th><th scope="col">{text("line_text")}</th></tr>
        </thead>
        <tbody>
          {rows.slice(0, LINES_MAX).map((row, index) =>
            row === null ? (
              <tr key={index} class="gap"><td colSpan={3}>…</td></tr>
            ) : (
              <tr key={index} class={row.second === null ? "removed" : row.first === null ? "added" : ""}>
                <td class="number">{row.first ?? ""}</td>
                <td class="number">{row.second ?? ""}</td>
                <td><code>{row.second === null ? "− " : row.first === null ? "+ " : "  "}{row.text}</code></td>
              </tr>
            ),
          )}
        </tbody>
      </table>
      {rows.length > LINES_MAX && <p class="faint">{text("rows_more", { count: rows.length - LINES_MAX })}</p>}
    </div>
  );
}

/** The differences with the lines around them; null where equal lines are left out. */
function around(pairs: readonly LinePair[]): (LinePair | null)[] {
  const differs = pairs.map((pair) => pair.first === null || pair.second === null);
  const rows: (LinePair | null)[] = [];
  let lastDifference = -Infinity;
  const nextDifference = new Array<number>(pairs.length);
  for (let index = pairs.length - 1, next = Infinity; index >= 0; index--) {
    if (differs[index]) next = index;
    nextDifference[index] = next;
  }
  pairs.forEach((pair, index) => {
    if (differs[index]) lastDifference = index;
    if (nextDifference[index]! - index <= AROUND || index - lastDifference <= AROUND) rows.push(pair);
    else if (rows.at(-1) !== null) rows.push(null);
  });
  return rows;
}
