/** Region `Variables`: the globals of the program at the cursor, as the variable monitor of a pendant shows them. */

import { Rows } from "../../app/rows.tsx";
import type { Studio } from "../../model/studio.ts";
import { text } from "../../text/text.ts";

export function Variables({ studio }: { studio: Studio }) {
  const list = studio.moment.value?.globals ?? [];
  if (list.length === 0) return <p class="empty">{text(studio.moment.value === null ? "nothing_yet" : "variables_none")}</p>;
  const more = studio.moment.value?.left_out ?? 0;
  const rows = (
    <Rows
      count={list.length} label={text("rows_of_variables")} keyOf={(index) => list[index]!.name}
      head={<tr><th scope="col">{text("name")}</th><th scope="col">{text("value")}</th><th scope="col">{text("type")}</th></tr>}
      attributes={(index) => ({ class: list[index]!.changed ? "changed" : "" })}
      row={(index) => {
        const { name, value, type, changed } = list[index]!;
        return (
          <>
            <th scope="row">{name}</th>
            <td class="value" title={value}>
              {changed && <span class="mark" title={text("changed")}><span aria-hidden="true">●</span><span class="unseen">{text("changed")} </span></span>}
              {value}
            </td>
            <td class="faint">{type}</td>
          </>
        );
      }}
    />
  );
  return more === 0 ? rows : <div class="variables-body">{rows}<p class="left-out">{text("left_out_here", { count: more.toLocaleString("en-US") })}</p></div>;
}
