/** Region `Problems`: what the run has met, its alarm first, and what `check` finds in the text. */

import type { ComponentChildren } from "preact";
import { Icon, type IconName } from "../../app/icons.tsx";
import { type Findings, findingsOf } from "../../model/findings.ts";
import type { Studio } from "../../model/studio.ts";
import { seconds, withUnit } from "../../model/units.ts";
import type { AlarmReport, Contact, Problem, RunFinding } from "../../source/messages.ts";
import type { Texts } from "../../text/en.ts";
import { said } from "../../text/said.ts";
import { shortened, text } from "../../text/text.ts";

/** Rows in the document; more problems than that are counted. */
const ROWS_MAX = 200;

const SEVERITIES: { readonly [severity in Problem["severity"]]: keyof Texts } = {
  error: "severity_error", warning: "severity_warning", information: "severity_information", hint: "severity_hint",
};

export function Problems({ studio }: { studio: Studio }) {
  const version = studio.problems.value?.version ?? 0;
  const found = findingsOf(studio);
  const rows = [...runProblems(studio, found, version), ...found.list.map((problem, index) => <Finding key={`check ${index}`} studio={studio} problem={problem} version={version} />)];
  const more = Math.max(0, rows.length - ROWS_MAX) + Object.values(found.left_out).reduce((sum, count) => sum + count, 0);
  if (studio.isEmpty.value) return <p class="empty">{text("problems_empty")}</p>;
  if (rows.length === 0) {
    const rules = studio.problems.value?.rules;
    return (
      <p class="empty">
        {text(nothingFound(studio))}
        {rules !== undefined && ` ${text("problems_rules", { count: rules })}`}
      </p>
    );
  }
  return (
    <div class="rows problems-list" tabIndex={0} role="group" aria-label={text("rows_of_problems")}>
      <ul>{rows.slice(0, ROWS_MAX)}</ul>
      {more > 0 && <p class="faint">{text("rows_more", { count: more })}</p>}
    </div>
  );
}

/** What no finding means: of the text alone it says nothing of a run. */
function nothingFound(studio: Studio): keyof Texts {
  const run = studio.run.value;
  if (studio.problems.value === null) return run === null ? "problems_unknown" : "problems_trace";
  if (run?.ended == null || studio.staleFrom.value > 0) return "problems_text";
  return run.ended.state === "finished" ? "problems_none" : "problems_so_far";
}

function runProblems(studio: Studio, { alarm, cause, contacts, met, refused_connections: refused }: Findings, version: number): ComponentChildren[] {
  return [
    ...(alarm === null ? [] : [<AlarmRow key="alarm" studio={studio} alarm={alarm} cause={cause} version={version} />]),
    ...contacts.map((contact, index) => <ContactRow key={`contact ${index}`} studio={studio} contact={contact} />),
    ...met.map((found, index) => <MetRow key={`met ${index}`} studio={studio} found={found} />),
    ...(refused.length === 0 ? [] : [
      <li key="refused" class="problem information">
        <Icon name="information" />
        <div>
          <p>{text("refused_connections", { where: refused.map(said).join(", ") })}</p>
          <p class="faint">{text("refused_hint")}</p>
        </div>
      </li>,
    ]),
  ];
}

interface RowProps {
  readonly studio: Studio;
  readonly kind: IconName;
  readonly severity: string;
  readonly line: number;
  /** Of the text that was checked; that of the run where there is none. */
  readonly version?: number;
  readonly words: string;
  readonly t?: number;
  readonly press: () => void;
  readonly children?: ComponentChildren;
}

function Row({ studio, kind, severity, line, version, words, t, press, children }: RowProps) {
  const hovered = studio.hover.value;
  const isOutlined = hovered !== null && hovered.region !== "problems" && hovered.line === line && line > 0;
  const point = () => studio.point({ region: "problems", line, ...(version === undefined ? {} : { version }), ...(t === undefined ? {} : { t }) });
  return (
    <li class={`problem ${severity}${isOutlined ? " outlined" : ""}`} onPointerEnter={point} onPointerLeave={() => studio.point(null)}>
      <Icon name={kind} />
      <div>
        <button type="button" class="place" onClick={press} onFocus={point} onBlur={() => studio.point(null)}>{words}</button>
        {children}
      </div>
    </li>
  );
}

function Finding({ studio, problem, version }: { studio: Studio; problem: Problem; version: number }) {
  const node = studio.nodeAt(problem.line);
  const words = text(node === "" ? "problem" : "problem_node", {
    node, line: problem.line, column: problem.column, severity: text(SEVERITIES[problem.severity]), code: problem.code, text: shortened(problem.text),
  });
  const icon = problem.severity === "hint" ? "information" : problem.severity;
  return (
    <Row studio={studio} kind={icon} severity={problem.severity} line={problem.line} version={version} words={words} press={() => go(studio, problem, version)}>
      <Advice studio={studio} problem={problem} version={version} />
    </Row>
  );
}

/** What to do: the hint and the fix of a finding. */
function Advice({ studio, problem: { hint, fix }, version }: { studio: Studio; problem: Problem; version: number }) {
  return (
    <>
      {hint !== "" && <p class="faint">{hint}</p>}
      {fix !== undefined && studio.canWrite.value && (
        <button type="button" class="fix" title={fix.title} onClick={() => studio.fix(version, fix.edits)}>{text("fix")}</button>
      )}
    </>
  );
}

/** `cause`: what `check` says of the same, whose advice stands here too. */
function AlarmRow({ studio, alarm, cause, version }: { studio: Studio; alarm: AlarmReport; cause: Problem | null; version: number }) {
  const node = studio.nodeInRun(alarm.line);
  const words = text(node === "" ? "alarm" : "alarm_node", { node, line: alarm.line, column: alarm.column, code: alarm.code, text: shortened(alarm.text), t: seconds(alarm.t) });
  return (
    <Row studio={studio} kind="error" severity="error" line={alarm.line} t={alarm.t} words={words} press={() => studio.jump(alarm.t, alarm)}>
      {alarm.limit !== undefined && <p>{alarm.limit}</p>}
      {alarm.hints.map((hint, index) => <p key={index} class="faint">{hint}</p>)}
      {cause !== null && <Advice studio={studio} problem={alarm.hints.includes(cause.hint) ? { ...cause, hint: "" } : cause} version={version} />}
    </Row>
  );
}

function ContactRow({ studio, contact }: { studio: Studio; contact: Contact }) {
  const node = studio.nodeInRun(contact.line);
  const words = text(node === "" ? "contact" : "contact_node", {
    node, line: contact.line, first: contact.first, second: contact.second, t: seconds(contact.start_s),
    depth: withUnit(Math.abs(contact.distance_m), "length", studio.display.value),
  });
  return (
    <Row
      studio={studio} kind="contact" severity="warning" line={contact.line} t={contact.t} words={words}
      press={() => studio.jump(contact.t, { line: contact.line, column: 1 })}
    />
  );
}

function MetRow({ studio, found: { severity, code, line, t, count, text: said, hint } }: { studio: Studio; found: RunFinding }) {
  const node = studio.nodeInRun(line);
  const words = text(node === "" ? (count > 1 ? "met_often" : "met") : count > 1 ? "met_often_node" : "met_node", {
    node, line, severity: text(SEVERITIES[severity]), code, t: seconds(t), count, text: shortened(said),
  });
  return (
    <Row
      studio={studio} kind={severity === "hint" ? "information" : severity} severity={severity} line={line} t={t} words={words}
      press={() => studio.jump(t, { line, column: 1 })}
    >
      {hint !== "" && <p class="faint">{hint}</p>}
    </Row>
  );
}

function go(studio: Studio, { line, column }: Problem, version: number): void {
  studio.goto.value = { line, column, version };
}
