/**
 * Overtyping: indentation, `end` and closing brackets that the editor has put in by itself take what is typed in their place, so that a
 * program typed as it stands on paper, with its own indentation and its own `end`s, is the same in the editor.
 */

import { matchBrackets } from "@codemirror/language";
import { MapMode, StateEffect, StateField, type EditorState, type Extension, type Text, type Transaction, type TransactionSpec } from "@codemirror/state";
import { EditorView } from "@codemirror/view";

interface Given {
  /** Indentation of the caret's line that came with the new line: where it ends, its columns, and how many of them were typed again. */
  readonly indentation: { readonly at: number; readonly columns: number; readonly typed: number } | null;
  /** Places of `end`s that came with their block. */
  readonly ends: readonly number[];
}

const setTyped = StateEffect.define<number>();

const NEW_LINE = /^\n[ \t]*(\n[ \t]*)?$/;
const END = /^[ \t]*end[ \t]*$/;
const OPENER = /^\s*(?:\w.*\S)?:\s*(#.*)?$/;
/** Lines that go on with a block instead of opening one. */
const CONTINUES = /^\s*(else|elif|except|finally|case)\b/;
const BLANK = /^[ \t]*$/;

const given = StateField.define<Given>({
  create: () => ({ indentation: null, ends: [] }),
  update: (known, change) => ({ indentation: indentationAfter(known, change), ends: endsAfter(known, change) }),
});

function indentationAfter({ indentation }: Given, change: Transaction): Given["indentation"] {
  for (const effect of change.effects) if (effect.is(setTyped) && indentation !== null) return { ...indentation, typed: effect.value };
  const isNew = change.docChanged && change.isUserEvent("input") && insertedBy(change).some(({ text }) => NEW_LINE.test(text));
  // What the services change behind a new line: its indentation, an `end` below.
  const isServed = indentation !== null && change.isUserEvent("input.service");
  if (isNew || isServed) {
    const at = change.state.selection.main.head;
    const { from } = change.state.doc.lineAt(at);
    const isOnlyIndented = at > from && BLANK.test(change.state.sliceDoc(from, at));
    return isOnlyIndented ? { at, columns: at - from, typed: isServed ? indentation.typed : 0 } : null;
  }
  return change.docChanged || change.selection !== undefined ? null : indentation;
}

function endsAfter({ ends }: Given, change: Transaction): readonly number[] {
  if (!change.docChanged) return ends;
  const kept = ends.map((at) => change.changes.mapPos(at, 1, MapMode.TrackDel)).filter((at) => at !== null);
  if (!change.isUserEvent("input.service")) return kept;
  for (const { from, text } of insertedBy(change)) {
    let at = from;
    for (const line of text.split("\n")) {
      if (END.test(line)) kept.push(at + line.indexOf("end"));
      at += line.length + 1;
    }
  }
  return kept;
}

function insertedBy(change: Transaction): { readonly from: number; readonly text: string }[] {
  const found: { from: number; text: string }[] = [];
  change.changes.iterChanges((_from, _to, from, _end, inserted) => found.push({ from, text: inserted.toString() }));
  return found;
}

/** Returns what a typed character does instead of being inserted at the caret, or null if it is inserted as always. */
export function overtyped(state: EditorState, at: number, character: string): TransactionSpec | null {
  const { indentation, ends } = state.field(given);
  const line = state.doc.lineAt(at);
  const before = state.sliceDoc(line.from, at);
  const isLast = BLANK.test(state.sliceDoc(at, line.to));
  if (character === "d" && isLast && before.trim() === "en") return endAgain(state.doc, ends, line.number);
  if (!BLANK.test(before)) return null;
  if (")]}".includes(character) && isLast) {
    const stepped = closerAgain(state, at, character, indentation?.at === at ? indentation.typed : 0);
    if (stepped !== null) return stepped;
  }
  if (indentation === null || indentation.at !== at) return null;
  const { columns, typed } = indentation;
  if (character === " ") return typed < columns ? { effects: setTyped.of(typed + 1) } : null;
  if (typed === 0 || typed >= columns || !levelsAbove(state.doc, line.number).has(typed)) return null;
  return { changes: { from: line.from, to: at, insert: " ".repeat(typed) + character }, selection: { anchor: line.from + typed + 1 }, userEvent: "input.type" };
}

/** Steps over an `end` below that came with its block, if this one would close the same block. */
function endAgain(doc: Text, ends: readonly number[], number: number): TransactionSpec | null {
  let below = number + 1;
  while (below <= doc.lines && BLANK.test(doc.line(below).text)) below++;
  if (below > doc.lines) return null;
  const line = doc.line(below);
  const columns = line.text.indexOf("end");
  const start = doc.line(number).from;
  if (!END.test(line.text) || !ends.includes(line.from + columns) || isOpenInside(doc, number, columns)) return null;
  return { changes: { from: start, to: line.from }, selection: { anchor: start + line.length }, userEvent: "input.type", scrollIntoView: true };
}

/** Returns whether a block that is indented deeper than `columns` is still open above a line. */
function isOpenInside(doc: Text, number: number, columns: number): boolean {
  let open = 0;
  for (let above = number - 1; above >= 1; above--) {
    const { text } = doc.line(above);
    if (BLANK.test(text)) continue;
    if (indentationOf(text) <= columns && !CONTINUES.test(text)) break;
    if (END.test(text)) open--;
    else if (OPENER.test(text) && !CONTINUES.test(text)) open++;
  }
  return open > 0;
}

/** Steps over a closing bracket in one of the next lines, if it closes what is open here; `typed` are the columns that were typed, 0 if none. */
function closerAgain(state: EditorState, at: number, character: string, typed: number): TransactionSpec | null {
  const line = state.doc.lineAt(at);
  const [space] = /^\s*/.exec(state.sliceDoc(at, Math.min(state.doc.length, at + 1000)))!;
  const to = at + space.length;
  if (!space.includes("\n") || state.sliceDoc(to, to + 1) !== character) return null;
  const match = matchBrackets(state, to + 1, -1);
  if (match === null || !match.matched || match.end === undefined || match.end.from >= at) return null;
  const columns = typed > 0 ? typed : indentationOf(state.doc.lineAt(match.end.from).text);
  return { changes: { from: line.from, to, insert: " ".repeat(columns) }, selection: { anchor: line.from + columns + 1 }, userEvent: "input.type", scrollIntoView: true };
}

/** Returns the indentations of the blocks around a line. */
function levelsAbove(doc: Text, number: number): ReadonlySet<number> {
  const levels = new Set<number>();
  let least = Infinity;
  for (let above = number - 1; above >= 1 && least > 0; above--) {
    const { text } = doc.line(above);
    const columns = indentationOf(text);
    if (BLANK.test(text) || columns >= least) continue;
    least = columns;
    levels.add(columns);
  }
  return levels;
}

function indentationOf(text: string): number {
  return /^[ \t]*/.exec(text)![0].length;
}

/** What is remembered of the text; `overtyping` has it. */
export const remembered: Extension = given;

export function overtyping(): Extension {
  return [
    given,
    EditorView.inputHandler.of((view, from, to, text) => {
      const { selection, readOnly } = view.state;
      if (readOnly || from !== to || text.length !== 1 || selection.ranges.length > 1) return false;
      const change = overtyped(view.state, from, text);
      if (change === null) return false;
      view.dispatch(change);
      return true;
    }),
  ];
}
