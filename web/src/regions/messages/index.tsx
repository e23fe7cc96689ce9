/** Region `Messages`: what the program wrote and what was reported, in the order of time; each row is a place in time. */

import { useSignal } from "@preact/signals";
import { Rows } from "../../app/rows.tsx";
import { lastAtOrBefore, type LeftOut } from "../../model/run.ts";
import { innerNode } from "../../model/tree.ts";
import type { Studio } from "../../model/studio.ts";
import { seconds, size } from "../../model/units.ts";
import type { RunEvent } from "../../source/messages.ts";
import type { Texts } from "../../text/en.ts";
import { shortened, text } from "../../text/text.ts";

const KINDS = ["log", "print", "popup", "warning", "device", "safety", "alarm"] as const;

type Kind = (typeof KINDS)[number];

const NAMES: { readonly [kind in Kind]: keyof Texts } = {
  log: "kind_log", print: "kind_print", popup: "kind_popup", warning: "kind_warning", device: "kind_device", safety: "kind_safety", alarm: "kind_alarm",
};

export function Messages({ studio }: { studio: Studio }) {
  const hidden = useSignal<ReadonlySet<string>>(new Set());
  const run = studio.run.value;
  void run?.revision.value;
  const all = run?.messages ?? [];
  const present = KINDS.filter((kind) => all.some((event) => event.type === kind));
  const shown = hidden.value.size === 0 ? all : all.filter((event) => !hidden.value.has(event.type));
  const toggle = (kind: Kind) => {
    const others = new Set(hidden.value);
    if (!others.delete(kind)) others.add(kind);
    hidden.value = others;
  };
  if (all.length === 0) return <p class="empty">{text("messages_none")}</p>;
  const at = lastAtOrBefore(shown.map((event) => event.t), studio.cursor.value);
  return (
    <div class="messages-body">
      {present.length > 1 && (
        <div class="filters" role="group" aria-label={text("messages_filter")}>
          {present.map((kind) => (
            <button key={kind} type="button" class="filter" aria-pressed={!hidden.value.has(kind)} onClick={() => toggle(kind)}>{text(NAMES[kind])}</button>
          ))}
        </div>
      )}
      <Rows
        count={shown.length} label={text("rows_of_messages")} at={at}
        attributes={(index) => ({
          class: rowClass(studio, shown[index]!, index, at),
          onPointerEnter: () => point(studio, shown[index]!),
          onPointerLeave: () => studio.point(null),
        })}
        row={(index) => <Message studio={studio} event={shown[index]!} />}
      />
      {run?.leftOut != null && <p class="left-out">{inWords(run.leftOut)}</p>}
    </div>
  );
}

function Message({ studio, event }: { studio: Studio; event: RunEvent }) {
  const said = words(event);
  const line = event.line ?? 0;
  return (
    <button
      type="button" tabIndex={-1} class="message" title={said} onClick={() => studio.jump(event.t, { line, column: 1 })}
      onFocus={() => point(studio, event)} onBlur={() => studio.point(null)}
    >
      <span class="number time">{seconds(event.t)}</span>
      <span class="number line">{line > 0 ? innerNode(studio.nodeInRun(line)) || text("line_short", { line }) : ""}</span>
      <span class={`kind ${level(event)}`}>{text(NAMES[event.type as Kind])}</span>
      <span class="said">{said}</span>
    </button>
  );
}

/** What is missing in the list. */
function inWords({ events, bytes, from_s }: LeftOut): string {
  if (events === 0) return text("messages_cut", { size: size(bytes) });
  return text("messages_left_out", { count: events.toLocaleString("en-US"), size: size(bytes), t: seconds(from_s) });
}

/** What an event says, as one text. */
function words(event: RunEvent): string {
  const parts = [event["device"], event["title"], event["mode"], event["code"], event["text"]].filter((part) => typeof part === "string" && part !== "");
  const said = shortened(parts.join(": "));
  return event.cut === undefined ? said : text("message_cut", { said, count: event.cut.toLocaleString("en-US") });
}

function level(event: RunEvent): string {
  if (event.type === "alarm") return "error";
  if (event.type === "warning" || event.type === "safety") return event["severity"] === "error" ? "error" : "warning";
  return typeof event["level"] === "string" ? event["level"] : "info";
}

function rowClass(studio: Studio, event: RunEvent, index: number, at: number): string {
  const hovered = studio.hover.value;
  const isOutlined = hovered !== null && hovered.region !== "messages" && hovered.line !== undefined && hovered.line === event.line;
  return [index > at ? "later" : index === at ? "now" : "", isOutlined ? "outlined" : ""].filter(Boolean).join(" ");
}

function point(studio: Studio, event: RunEvent): void {
  const { line = 0 } = event;
  studio.point({ region: "messages", t: event.t, ...(line > 0 ? { line } : {}) });
}

