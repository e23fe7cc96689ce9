/** The state of the run in words. */

import { countsOf, findingsOf } from "../model/findings.ts";
import { LIMIT_S, type Studio } from "../model/studio.ts";
import { said } from "../text/said.ts";
import { text } from "../text/text.ts";

export interface RunState {
  readonly kind: "none" | "busy" | "good" | "warning" | "error";
  readonly text: string;
  /** Whether it is of an earlier text. */
  readonly isStale: boolean;
}

/** Where a run has ended: its line, or the node of a graphical program. */
function atLine(studio: Studio, kind: "alarm" | "stuck", t: string, line: number): string {
  const node = studio.nodeInRun(line);
  return node === "" ? text(`state_${kind}`, { t, line }) : text(`state_${kind}_node`, { t, node });
}

const short = (t: number) => t.toFixed(1);

export function runState(studio: Studio): RunState {
  const run = studio.run.value;
  void run?.revision.value;
  const problems = studio.problems.value;
  const isStale = studio.staleFrom.value > 0;
  const state = (kind: RunState["kind"], words: string): RunState => ({ kind, text: words, isStale });
  if (studio.hello.value === null) return state("none", text("state_connecting"));
  if (studio.can("live")) {
    const moment = studio.moment.value;
    const link = studio.controller.value?.link ?? "connecting";
    if (moment === null || link === "connecting") return state("none", text("state_connecting"));
    if (link === "lost") return state("error", text("state_lost", { t: short(moment.t) }));
    return state("good", text("state_live", { t: short(moment.t) }));
  }
  if (run === null && studio.isEmpty.value) return state("none", text("state_empty"));
  if (run === null) return problems?.compiles === false ? state("error", text("state_not_compiled")) : state("none", text("state_no_run"));
  if (isStale) return state("warning", text("state_stale", { line: studio.staleFrom.value }));
  const { ended } = run;
  if (ended === null) {
    const before = studio.before.value?.ended == null ? 0 : studio.before.value.known_s;
    const expected = before > run.known_s ? before : (run.options.until_s ?? LIMIT_S);
    return state("busy", text(before > run.known_s ? "state_of_about" : "state_of_limit", { t: short(run.known_s), end: short(expected) }));
  }
  const t = short(ended.moment.t);
  switch (ended.state) {
    case "finished": {
      // What has errors or warnings does not look good, though it has finished; notes do not count.
      const { errors, warnings } = countsOf(findingsOf(studio));
      const words = [text("state_finished", { t }), problemCount(studio)].filter(Boolean).join(text("list_separator"));
      return state(errors > 0 ? "error" : warnings > 0 ? "warning" : "good", words);
    }
    case "stopped":
      return state("none", text("state_stopped", { t }));
    case "alarm":
      return state("error", atLine(studio, "alarm", short(ended.alarm?.t ?? ended.moment.t), ended.alarm?.line ?? ended.moment.line));
    case "time_limit":
      return state("warning", text("state_time_limit", { t }));
    case "stuck":
      return state("error", atLine(studio, "stuck", t, ended.moment.line));
    case "killed":
      return state("error", text("state_killed", { why: said(ended.killed ?? "") }));
  }
}

/** The number of rows of Problems in words: "2 errors, 1 warning"; empty if there are none. */
export function problemCount(studio: Studio): string {
  const { errors, warnings, others } = countsOf(findingsOf(studio));
  const parts = [
    errors > 0 ? text(errors === 1 ? "error_one" : "error_many", { count: errors }) : "",
    warnings > 0 ? text(warnings === 1 ? "warning_one" : "warning_many", { count: warnings }) : "",
    others > 0 ? text(others === 1 ? "hint_one" : "hint_many", { count: others }) : "",
  ];
  return parts.filter(Boolean).join(text("list_separator"));
}
