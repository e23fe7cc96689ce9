/** The time line in words: values, what is under the pointer, what a canvas shows. */

import { type Entry, indexAt, eventText, markKind, marksNear, type Group, type Lane, type LevelLane } from "../../model/lanes.ts";
import { familyOf } from "../../model/points.ts";
import { format, seconds, unitOf, type Display } from "../../model/units.ts";
import type { RunEvent } from "../../source/messages.ts";
import type { SignalFamily } from "../../source/services.ts";
import { said } from "../../text/said.ts";
import { shortened, text } from "../../text/text.ts";
import { laneValue, levelText } from "./draw.ts";
import type { CurveSpec } from "./curves.ts";
import type { Row } from "./state.ts";

/** Events in the text under the pointer. */
const SHOWN = 8;

const SUPPLIED: readonly string[] = ["client", "device", "wire", "schedule", "fault", "program"];

/** Returns the factor from SI to what is shown of a curve. */
export function factorOf(spec: CurveSpec, display: Display): number {
  if (spec.key === "speed") return display.length === "mm" ? 1000 : 1;
  return display.angle === "deg" ? 180 / Math.PI : 1;
}

export function unitText(spec: CurveSpec, display: Display): string {
  return spec.unit === "angular_acceleration" ? `${display.angle}/s²` : unitOf(spec.unit, display);
}

export function jointValue(spec: CurveSpec, value: number, display: Display): string {
  if (Number.isNaN(value)) return "";
  if (spec.unit === "angular_acceleration") return zeroed((value * factorOf(spec, display)).toFixed(1));
  return format(value, spec.unit, display);
}

function zeroed(shown: string): string {
  return /^-0\.?0*$/.test(shown) ? shown.slice(1) : shown;
}

/** Returns the name of a row for people. */
export function rowName(row: Row, sourceLine: (line: number) => string): string {
  if (row.line > 0) return `${row.line}  ${sourceLine(row.line)}`;
  if (row.line < 0) return text("timeline_other_lines");
  switch (row.id) {
    case "moves":
      return text("timeline_moves");
    case "contacts":
      return text("timeline_contacts");
    case "messages":
      return text("timeline_messages");
    case "safety":
      return text("timeline_safety");
    default:
      if (row.group === "channels") return channelName(row.name);
      return row.group === "threads" ? text("timeline_thread", { name: row.name }) : row.name === "fault" ? text("timeline_faults") : row.name;
  }
}

/** Returns what is in a lane at a time, in lines; empty if there is nothing. */
export function tooltip(lane: Lane, t: number, reach_s: number, sourceLine: (line: number) => string, families: readonly SignalFamily[]): string {
  const withLine = (line: number) => (line > 0 ? `${text("timeline_line", { line })}  ${sourceLine(line)}` : "");
  if (lane.shape === "marks") {
    const near = marksNear(lane, t, reach_s);
    const lines = near.slice(0, SHOWN).map((event) => markLine(event));
    if (near.length > SHOWN) lines.push(text("timeline_more_here", { count: near.length - SHOWN }));
    return lines.join("\n");
  }
  const index = indexAt(lane, t);
  if (index < 0) return "";
  if (lane.shape === "levels") return levelWords(lane, index, withLine, familyOf(families, lane.name)?.unit ?? "");
  const [start, end] = [lane.start[index]!, lane.end(index)];
  const line = lane.line(index);
  if (lane.shape === "lines" && line === 0) return "";
  const when = text("timeline_from_to", { from: seconds(start), to: seconds(end), length: seconds(end - start) });
  return [lane.what(index), withLine(line), when].filter(Boolean).join("\n");
}

function levelWords(lane: LevelLane, index: number, withLine: (line: number) => string, unit: string): string {
  const cause = withLine(lane.line[index]!) || (SUPPLIED.includes(lane.by[index]!) ? text(`timeline_by_${lane.by[index]}` as "timeline_by_client") : "");
  const since = index === 0 ? text("timeline_since_start") : text("timeline_since", { t: seconds(lane.start[index]!) });
  return [`${lane.name} = ${levelText(lane, index)} ${unit}`.trim(), [since, cause].filter(Boolean).join(", "), text("timeline_changes", { count: lane.stops.length })].join("\n");
}

function markLine(event: RunEvent): string {
  const place = event.line !== undefined && event.line > 0 ? `, ${text("timeline_line", { line: event.line })}` : "";
  const words = event.type === "channel" ? said(String(event["data"])) : (faultText(event) ?? eventText(event));
  return `${seconds(event.t)}  ${kindText(markKind(event))}${place}${words === "" ? "" : `: ${visible(words)}`}`;
}

/** Returns what a fault reports, in the language of the page; undefined of other devices, whose words are their own. */
function faultText(event: RunEvent): string | undefined {
  if (event.type !== "device" || event["device"] !== "fault") return undefined;
  return `${said("fault")}: ${said(String(event["text"] ?? ""))}`;
}

/** Returns a channel by its kind, in the language of the page, and its name. */
function channelName(name: string): string {
  const [kind = "", ...rest] = name.split(" ");
  return [said(kind), ...rest].join(" ");
}

/** Returns what an entry of the table says, in the language of the page. */
export function entryText(entry: Entry): string {
  if (entry.event?.type !== "channel") return visible((entry.event && faultText(entry.event)) ?? entry.text);
  const { kind, channel, what, data } = entry.event;
  const words = said(String(data ?? ""));
  return visible(`${said(String(kind))} ${String(channel)} ${kindText(String(what))}${words === "" ? "" : `: ${words}`}`);
}

export function kindText(kind: string): string {
  const known = ["alarm", "warning", "popup", "log", "print", "device", "open", "sent", "received", "closed", "refused", "timeout", "signal", "channel", "safety", "move", "contact"];
  return known.includes(kind) ? text(`timeline_kind_${kind}` as "timeline_kind_alarm") : kind;
}

/** Line ends and tabs as they are written, so that each event is one line. */
export function visible(words: string): string {
  return shortened(words).replaceAll("\n", "\\n").replaceAll("\r", "\\r").replaceAll("\t", "\\t");
}

/** Returns what a canvas shows at a time, for those who do not see it. */
export function canvasWords(group: Group, rows: readonly Row[], t: number): string {
  const parts = rows.slice(0, 12).flatMap((row) => {
    const lane = row.lane ?? row.stale;
    if (lane === undefined || row.line !== 0) return [];
    const name = rowName(row, () => "");
    if (lane.shape === "marks") return [`${name}: ${text("timeline_count", { count: lane.events.length })}`];
    const value = laneValue(lane, t);
    if (lane.shape === "lines") return [`${name}: ${value === "" ? "–" : text("timeline_line", { line: value })}`];
    return [`${name}: ${value === "" ? "–" : value}`];
  });
  return `${text(`timeline_group_${group}`)}, ${seconds(t)}. ${parts.join("; ")}`;
}
