/** The rows of Problems: what the run has met, and what `check` finds in the text, each thing once. */

import type { AlarmReport, Contact, LeftOut, Problem, RunFinding } from "../source/messages.ts";
import type { Studio } from "./studio.ts";

export interface Findings {
  readonly alarm: AlarmReport | null;
  /** What `check` says of the alarm: a finding on its line about the same thing. */
  readonly cause: Problem | null;
  readonly contacts: readonly Contact[];
  readonly refused_connections: readonly string[];
  /** What the run has found besides. */
  readonly met: readonly RunFinding[];
  /** Of `check`, without the cause of the alarm. */
  readonly list: readonly Problem[];
  /** How many more of those there are, by severity. */
  readonly left_out: LeftOut;
}

/** Returns what is known now; reads the signals that it depends on. */
export function findingsOf(studio: Studio): Findings {
  const run = studio.run.value;
  void run?.revision.value;
  const list = studio.problems.value?.list ?? [];
  // A text that does not compile has no run of its own: what the one on the screen met says nothing of it.
  const met = studio.staleFrom.value > 0 ? null : run;
  const alarm = met?.alarm ?? null;
  const cause = alarm === null ? null : (list.find((problem) => isCause(problem, alarm)) ?? null);
  return {
    alarm, cause,
    contacts: (met?.contacts ?? []).filter((contact) => contact.is_contact),
    refused_connections: met?.ended?.refused_connections ?? [],
    met: met?.ended?.findings ?? [],
    list: cause === null ? list : list.filter((problem) => problem !== cause),
    left_out: studio.problems.value?.left_out ?? {},
  };
}

/** Errors and warnings with all that the run has met. */
export function countsOf({ alarm, contacts, met, list, left_out }: Findings): { readonly errors: number; readonly warnings: number; readonly others: number } {
  const count = (severity: Problem["severity"]) => [...list, ...met].filter((problem) => problem.severity === severity).length + (left_out[severity] ?? 0);
  return {
    errors: count("error") + (alarm === null ? 0 : 1),
    warnings: count("warning") + contacts.length,
    others: count("information") + count("hint"),
  };
}

/** Whether a finding names the name that is not defined, at the same line. */
function isCause({ line, text }: Problem, alarm: AlarmReport): boolean {
  const name = /'([^']+)' is not defined/.exec(alarm.text)?.[1];
  return line === alarm.line && name !== undefined && text.includes(`\`${name}\` is not defined`);
}
