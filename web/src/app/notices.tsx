/** What the source or the page has to say: shown until it is dismissed. */

import type { Studio } from "../model/studio.ts";
import { said } from "../text/said.ts";
import { localTime, text } from "../text/text.ts";
import { Icon } from "./icons.tsx";

/** Shown at a time, the newest. */
const SHOWN_MAX = 3;

export function Notices({ studio }: { studio: Studio }) {
  const all = studio.notices.value;
  const shown = all.slice(-SHOWN_MAX);
  const earlier = all.length - shown.length;
  const isLost = studio.link.value === "lost";
  const draftAt = studio.draftAt.value;
  if (all.length === 0 && !isLost && draftAt === null) return null;
  return (
    <div class="notices">
      {isLost && (
        <p class="notice warning" role="alert">
          <Icon name="warning" /> <span>{text("link_lost_long")}</span>
        </p>
      )}
      {draftAt !== null && studio.conflict.value === null && (
        <p class="notice information">
          <Icon name="information" /> <span>{text("draft_shown", { at: localTime(draftAt) })}</span>
          <button type="button" onClick={() => studio.takeTheirs()}>{text("draft_drop")}</button>
          <button type="button" onClick={() => (studio.draftAt.value = null)}>{text("draft_keep")}</button>
        </p>
      )}
      {earlier > 0 && <p class="notice">{text(earlier === 1 ? "notices_one" : "notices_more", { count: earlier })}</p>}
      {shown.map((notice) => (
        <p key={notice.id} class={`notice ${notice.severity}`} role={notice.severity === "error" ? "alert" : "status"}>
          <Icon name={notice.severity} /> <span>{said(notice.text)}</span>
          <button type="button" class="plain" aria-label={text("dismiss")} title={text("dismiss")} onClick={() => studio.dismiss(notice.id)}>
            <Icon name="close" />
          </button>
        </p>
      ))}
    </div>
  );
}
