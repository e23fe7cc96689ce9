/** The editor of CodeMirror, joined to the model of the page. */

import { closeBrackets, closeBracketsKeymap, completionKeymap } from "@codemirror/autocomplete";
import { defaultKeymap, history, historyKeymap, indentWithTab } from "@codemirror/commands";
import { bracketMatching, codeFolding, foldGutter, foldKeymap, indentOnInput } from "@codemirror/language";
import { lintGutter, nextDiagnostic, previousDiagnostic, setDiagnostics, type Diagnostic } from "@codemirror/lint";
import { highlightSelectionMatches, search, searchKeymap } from "@codemirror/search";
import { Compartment, EditorState, Transaction, type Text } from "@codemirror/state";
import {
  drawSelection, dropCursor, EditorView, highlightActiveLine, highlightActiveLineGutter, highlightSpecialChars, keymap, lineNumbers, rectangularSelection,
} from "@codemirror/view";
import { untracked } from "@preact/signals-core";
import type { Run } from "../../model/run.ts";
import type { Place, Studio } from "../../model/studio.ts";
import type { Problem, TextEdit } from "../../source/messages.ts";
import { language } from "../../text/language.ts";
import { PHRASES } from "../../text/phrases.ts";
import { linesOf, rowOf } from "../../model/tree.ts";
import { text as shown } from "../../text/text.ts";
import { applyEdits, assistance } from "./assistance.ts";
import { inlayHints, setHints } from "./hints.ts";
import { eliteScript, setFolds, setTokens } from "./language.ts";
import { NO_MARKS, runMarks, setMarks, type LineMarks } from "./marks.ts";
import { overtyping } from "./overtyping.ts";
import { offsetOf, rangeOf } from "./positions.ts";
import { Services } from "./services.ts";
import { Versions } from "./versions.ts";

const REGION = "program";
/** Quiet time after a key before names, hints and folds are asked for, ms: problems and the run come first. */
const SERVICES_PAUSE_MS = 150;

export class ProgramEditor {
  private readonly studio: Studio;
  private readonly view: EditorView;
  private readonly asked: Services;
  private readonly versions = new Versions();
  private readonly editable = new Compartment();
  private readonly undoable = new Compartment();
  private readonly phrases = new Compartment();
  private options = { times: false, hints: true };
  private timer: ReturnType<typeof setTimeout> | undefined;
  private hovered = 0;
  private isTaking = false;

  constructor(parent: HTMLElement, studio: Studio) {
    this.studio = studio;
    this.asked = new Services(studio);
    const { extension, keys } = assistance(this.asked);
    this.view = new EditorView({
      parent,
      state: EditorState.create({
        doc: studio.text.peek(),
        extensions: [
          runMarks(),
          lineNumbers(),
          foldGutter(),
          codeFolding(),
          lintGutter(),
          this.undoable.of(history()),
          drawSelection(),
          dropCursor(),
          rectangularSelection(),
          EditorState.allowMultipleSelections.of(true),
          highlightSpecialChars(),
          highlightActiveLine(),
          highlightActiveLineGutter(),
          highlightSelectionMatches(),
          bracketMatching(),
          // Before the closing of brackets: what stands below the caret is overtyped, too.
          overtyping(),
          closeBrackets(),
          indentOnInput(),
          this.phrases.of([]),
          search({ top: true }),
          EditorState.languageData.of(() => [{ closeBrackets: { brackets: ["(", "[", "{", "'", '"'] }, indentOnInput: /^\s*(end|else|elif|except|finally)$/, commentTokens: { line: "#" } }]),
          eliteScript(),
          inlayHints(),
          extension,
          this.editable.of(editing(true)),
          // Before the editor's own keys: Ctrl+Enter would insert a line.
          keymap.of([
            { key: "Mod-Enter", run: () => (studio.play(), true) },
            { key: "F8", run: nextDiagnostic, shift: previousDiagnostic },
            ...keys,
            ...closeBracketsKeymap,
            ...completionKeymap,
            ...searchKeymap,
            ...historyKeymap,
            ...foldKeymap,
            indentWithTab,
            ...defaultKeymap,
          ]),
          EditorView.contentAttributes.of(() => ({ "aria-label": shown("editor_name"), spellcheck: "false", autocorrect: "off", autocapitalize: "off" })),
          EditorView.updateListener.of((update) => {
            if (update.selectionSet && update.transactions.some((change) => change.isUserEvent("select"))) this.lookAt(update.state.doc.lineAt(update.state.selection.main.head).number);
            if (!update.docChanged) return;
            for (const transaction of update.transactions) this.versions.changed(transaction.changes);
            if (!this.isTaking) this.studio.edit(update.state.doc.toString());
          }),
          EditorView.domEventHandlers({
            mousemove: (event) => this.pointAt(event),
            mouseleave: () => this.pointAt(null),
            mouseup: (event, view) => this.clicked(event, view),
          }),
        ],
      }),
    });
    // The scrolling area can be scrolled by keyboard where its text cannot be edited.
    this.view.scrollDOM.tabIndex = 0;
    this.view.scrollDOM.setAttribute("role", "group");
    studio.editor = {
      apply: (edits: readonly TextEdit[]) => {
        applyEdits(this.view, edits);
        this.view.focus();
      },
      replace: (whole: string) => this.view.dispatch({ changes: { from: 0, to: this.view.state.doc.length, insert: whole }, userEvent: "input.replace" }),
      insert: (lines: string) => this.insert(lines),
      focus: () => this.view.focus(),
    };
  }

  close(): void {
    clearTimeout(this.timer);
    this.studio.editor = null;
    this.view.destroy();
  }

  // ---------------------------------------------------------------- what the model says

  /** Names the parts in the language of the page. */
  name(): void {
    this.view.scrollDOM.setAttribute("aria-label", shown("editor_scroller"));
    // Attributes of the text are asked for again; an open panel keeps its language.
    this.view.dispatch({ effects: this.phrases.reconfigure(EditorState.phrases.of(language.peek() === "zh" ? PHRASES : {})) });
  }

  show(options: { readonly times: boolean; readonly hints: boolean }): void {
    this.options = options;
    untracked(() => {
      this.runs();
      this.services(this.studio.version.value, this.studio.can("services"));
    });
  }

  /** Takes a text that did not come from this editor: that of a file that was opened, behind which undo never goes back. */
  take(whole: string): void {
    const known = this.view.state.doc;
    if (known.length === whole.length && known.toString() === whole) return;
    this.isTaking = true;
    try {
      this.view.dispatch({
        changes: { from: 0, to: known.length, insert: whole },
        selection: { anchor: 0 },
        effects: this.undoable.reconfigure([]),
        annotations: Transaction.addToHistory.of(false),
      });
      this.view.dispatch({ effects: this.undoable.reconfigure(history()) });
    } finally {
      this.isTaking = false;
    }
  }

  /** Takes note of the text that a version stands for: from now on its lines are followed. */
  begin(version: number): void {
    this.take(this.studio.text.peek());
    this.versions.begin(version, this.view.state.doc);
  }

  allow(canEdit: boolean): void {
    this.view.dispatch({ effects: this.editable.reconfigure(editing(canEdit)) });
  }

  problems(found: { readonly version: number; readonly list: readonly Problem[] } | null): void {
    const doc = this.view.state.doc;
    const shownProblems = (found?.list ?? []).map((problem): Diagnostic => {
      const { from, to } = rangeOf(doc, problem);
      const { fix } = problem;
      return {
        from,
        to: Math.max(to, Math.min(from + 1, doc.lineAt(from).to)),
        severity: problem.severity === "information" ? "info" : problem.severity,
        source: problem.code,
        message: problem.hint === "" ? problem.text : `${problem.text}\n${shown("editor_hint", { hint: problem.hint })}`,
        ...(fix === undefined ? {} : { actions: [{ name: fix.title, apply: () => this.studio.fix(found!.version, fix.edits) }] }),
      };
    });
    this.view.dispatch(setDiagnostics(this.view.state, shownProblems));
  }

  /** Asks for names, hints and folds of a version, once it is quiet. */
  services(version: number, canAsk: boolean): void {
    clearTimeout(this.timer);
    if (!canAsk) return;
    this.timer = setTimeout(async () => {
      const none = Promise.resolve([]);
      const [tokens, folds, hints] = await Promise.all([this.asked.tokens(), this.asked.folding(), this.options.hints ? this.asked.hints() : none]);
      if (version !== this.studio.version.peek()) return;
      this.view.dispatch({
        effects: [...(tokens === null ? [] : [setTokens.of(tokens)]), ...(folds === null ? [] : [setFolds.of(folds)]), ...(hints === null ? [] : [setHints.of(hints)])],
      });
    }, SERVICES_PAUSE_MS);
  }

  /** Marks what the run says; reads the signals that it depends on. */
  runs(): void {
    const { studio } = this;
    const run = studio.run.value;
    const hover = studio.hover.value;
    const moment = studio.moment.value;
    void run?.revision.value;
    const doc = this.view.state.doc;
    const pointed = hover === null || hover.region === REGION || hover.line === undefined ? 0 : hover.line;
    const outlined = this.versions.now(hover?.version ?? run?.version ?? 0, pointed, doc);
    const tree = studio.tree.value;
    const node = new Set(tree === null ? [] : linesOf(tree, studio.row.value));
    if (run === null) {
      this.mark({ ...NO_MARKS, node, outlined });
      return;
    }
    this.versions.forget(run.version);
    const now = (line: number) => this.versions.now(run.version, line, doc);
    const ran = new Set<number>();
    for (const known of this.linesOf(run)) ran.add(now(known));
    const threads = moment === null ? [] : [moment.line, ...moment.threads.filter((thread) => thread.name !== "main").map((thread) => thread.line)];
    const marks: LineMarks = {
      ran,
      at: threads.map(now),
      alarm: run.alarm === null ? 0 : now(run.alarm.line),
      alarm_text: run.alarm?.text ?? "",
      node,
      outlined,
      times: this.options.times ? new Map(run.cycle.map((row) => [now(row.line), timeOf(row)] as const).map(([line, time]) => [line, withShare(time, run.known_s)])) : new Map(),
    };
    this.mark(marks);
  }

  /** Shows marks, if they or the text are others than last time: most messages of a run change none. */
  private mark(marks: LineMarks): void {
    const { doc } = this.view.state;
    const content = JSON.stringify([[...marks.ran], marks.at, marks.alarm, marks.alarm_text, [...marks.node], marks.outlined, [...marks.times]]);
    if (this.marked.doc === doc && this.marked.content === content) return;
    this.marked = { doc, content };
    this.view.dispatch({ effects: setMarks.of(marks) });
  }

  private marked: { readonly doc: Text | null; readonly content: string } = { doc: null, content: "" };

  /** Lines that ran, each once: pointing at something else does not go through all visits again. */
  private linesOf(run: Run): ReadonlySet<number> {
    const revision = run.revision.peek();
    if (this.ran.run !== run || this.ran.revision !== revision) {
      this.ran = { run, revision, lines: new Set([...run.lines.values()].flatMap(({ line }) => [...new Set(line)])) };
    }
    return this.ran.lines;
  }

  private ran: { readonly run: Run | null; readonly revision: number; readonly lines: ReadonlySet<number> } = { run: null, revision: 0, lines: new Set() };

  /** Puts the caret at a place, or where it is now; a line that is gone is nowhere. */
  go(place: Place | null): void {
    if (place === null) return;
    const { doc } = this.view.state;
    const line = place.version === undefined ? place.line : this.versions.now(place.version, place.line, doc);
    if (line === 0) return;
    const anchor = offsetOf(doc, { ...place, line });
    this.view.dispatch({ selection: { anchor }, effects: EditorView.scrollIntoView(anchor, { y: "center" }) });
    this.lookAt(line);
    // In a layout that shows the tree alone there is no text to go to.
    if (this.view.dom.offsetParent !== null) this.view.focus();
  }

  /** Brings the lines of a row of the tree into view. */
  showRow(row: number): void {
    const tree = this.studio.tree.peek();
    const line = tree === null ? 0 : (linesOf(tree, row)[0] ?? 0);
    if (line === 0 || line > this.view.state.doc.lines) return;
    // The row may be that of a line which is in view already, where the caret was put.
    const { from } = this.view.state.doc.line(line);
    this.view.dispatch({ effects: EditorView.scrollIntoView(from, { y: "nearest", yMargin: 60 }) });
  }

  private lookAt(line: number): void {
    const tree = this.studio.tree.peek();
    if (tree !== null) this.studio.row.value = rowOf(tree, line);
  }

  // ---------------------------------------------------------------- what people do here

  private pointAt(event: MouseEvent | null): void {
    const at = event === null ? null : this.view.posAtCoords({ x: event.clientX, y: event.clientY }, false);
    const line = at === null ? 0 : this.lineThatRan(this.view.state.doc.lineAt(at).number);
    if (line === this.hovered) return;
    this.hovered = line;
    this.studio.point(line === 0 ? null : { line, region: REGION });
  }

  /** A click in the text shows the next visit of the line. */
  private clicked(event: MouseEvent, view: EditorView): void {
    if (event.button !== 0 || !view.state.selection.main.empty || this.studio.can("live")) return;
    const at = view.posAtCoords({ x: event.clientX, y: event.clientY });
    const line = at === null ? 0 : this.lineThatRan(view.state.doc.lineAt(at).number);
    const run = this.studio.run.peek();
    if (line === 0 || run === null) return;
    const visits: number[] = [];
    for (const known of run.lines.values()) known.line.forEach((other, index) => other === line && visits.push(known.t[index]!));
    visits.sort((a, b) => a - b);
    const next = visits.find((t) => t > this.studio.cursor.peek() + 1e-6) ?? visits[0];
    if (next !== undefined) this.studio.jump(next);
    // What takes no time has no visits, but the node of the line has begun.
    else if (this.studio.tree.peek() !== null) this.studio.visitRow(this.studio.row.peek());
  }

  private lineThatRan(line: number): number {
    const run = this.studio.run.peek();
    return run === null ? 0 : this.versions.then(run.version, line, this.view.state.doc);
  }

  private insert(lines: string): void {
    const { doc, selection } = this.view.state;
    const line = doc.lineAt(selection.main.head);
    const indentation = /^\s*/.exec(line.text)![0] + (/:\s*(#.*)?$/.test(line.text) ? "  " : "");
    const inserted = lines.split("\n").map((row) => indentation + row).join("\n");
    const isBlank = line.text.trim() === "";
    const change = isBlank ? { from: line.from, to: line.to, insert: inserted } : { from: line.to, insert: `\n${inserted}` };
    const end = change.from + change.insert.length;
    this.view.dispatch({ changes: change, selection: { anchor: end }, userEvent: "input.insert", scrollIntoView: true });
  }
}

function editing(canEdit: boolean) {
  return [EditorState.readOnly.of(!canEdit), EditorView.contentAttributes.of({ "aria-readonly": String(!canEdit) })];
}

function timeOf(row: { readonly moving_s: number; readonly standing_s: number; readonly visits: number }) {
  const total = row.moving_s + row.standing_s;
  return { total, label: shown("editor_line_time", { moving: row.moving_s.toFixed(3), standing: row.standing_s.toFixed(3), visits: row.visits }) };
}

function withShare(time: { readonly total: number; readonly label: string }, known_s: number) {
  return { text: `${time.total.toFixed(time.total < 10 ? 2 : 1)} s`, label: time.label, share: known_s > 0 ? time.total / known_s : 0 };
}

