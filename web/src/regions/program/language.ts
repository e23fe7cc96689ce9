/** Colours, indentation and folding of the language: Python's grammar, the words of EliteScript, and what the services know of names. */

import { foldService, HighlightStyle, indentService, indentUnit, LanguageSupport, syntaxHighlighting } from "@codemirror/language";
import { pythonLanguage } from "@codemirror/lang-python";
import { RangeSetBuilder, StateEffect, StateField, type Extension, type Text } from "@codemirror/state";
import { Decoration, EditorView, type DecorationSet } from "@codemirror/view";
import { tags } from "@lezer/highlight";
import type { Results } from "../../source/services.ts";
import { rangeOf } from "./positions.ts";

export const INDENT = "  ";

/** Lines that stand one step left of the block that they end or continue. */
const CLOSERS = /^\s*(end|else|elif|except|finally|case)\b/;
const OPENER = /:\s*(#.*)?$/;

const HIGHLIGHT = HighlightStyle.define([
  { tag: [tags.keyword, tags.controlKeyword, tags.definitionKeyword, tags.operatorKeyword, tags.moduleKeyword], class: "tok-keyword" },
  { tag: [tags.string, tags.special(tags.string)], class: "tok-string" },
  { tag: [tags.number, tags.bool, tags.null], class: "tok-number" },
  { tag: [tags.comment, tags.lineComment], class: "tok-comment" },
  { tag: tags.function(tags.definition(tags.variableName)), class: "tok-definition" },
]);

/** Returns the columns by which a new line, or one that closes a block, is indented. */
export function indentationAt(text: Text, from: number, line: string): number {
  const number = text.lineAt(from).number;
  for (let above = number - 1; above >= 1; above--) {
    const before = text.line(above).text;
    if (before.trim() === "") continue;
    const columns = /^[ \t]*/.exec(before)![0].replaceAll("\t", INDENT).length;
    const opened = columns + (OPENER.test(before) ? INDENT.length : 0);
    return CLOSERS.test(line) ? Math.max(0, opened - INDENT.length) : opened;
  }
  return 0;
}

const indentation = indentService.of((context, at) => {
  const line = context.state.doc.lineAt(at);
  const typed = context.simulatedBreak === null || context.simulatedBreak !== at ? line.text : line.text.slice(at - line.from);
  const broken = context.simulatedBreak !== null && context.simulatedBreak === at;
  if (!broken) return indentationAt(context.state.doc, at, typed);
  const before = line.text.slice(0, at - line.from);
  const columns = /^[ \t]*/.exec(before)![0].replaceAll("\t", INDENT).length;
  const opened = columns + (OPENER.test(before) ? INDENT.length : 0);
  return CLOSERS.test(typed) ? Math.max(0, opened - INDENT.length) : opened;
});

// ---------------------------------------------------------------- names, as the services know them

export const setTokens = StateEffect.define<Results["tokens"]>();

const CLASSES: { readonly [type: string]: string } = {
  command: "tok-command", function: "tok-function", class: "tok-class", method: "tok-function", parameter: "tok-parameter", variable: "tok-variable",
  property: "tok-property", namespace: "tok-class", keyword: "tok-keyword", signal: "tok-signal",
};

const SHOWN_MODIFIERS = ["unused", "global", "unavailable", "definition"];

const tokens = StateField.define<DecorationSet>({
  create: () => Decoration.none,
  update(marks, change) {
    let now = marks.map(change.changes);
    for (const effect of change.effects) if (effect.is(setTokens)) now = tokenMarks(change.state.doc, effect.value);
    return now;
  },
  provide: (field) => EditorView.decorations.from(field),
});

function tokenMarks(text: Text, { types, modifiers, rows }: Results["tokens"]): DecorationSet {
  const builder = new RangeSetBuilder<Decoration>();
  for (let at = 0; at + 4 < rows.length; at += 5) {
    const [line, column, length, type, bits] = rows.slice(at, at + 5) as [number, number, number, number, number];
    const known = CLASSES[types[type] ?? ""];
    const { from, to } = rangeOf(text, { line, column, end_line: line, end_column: column + length });
    const extra = SHOWN_MODIFIERS.filter((name) => bits & (1 << modifiers.indexOf(name)) && modifiers.includes(name)).map((name) => `tok-is-${name}`);
    if (known !== undefined && to > from) builder.add(from, to, Decoration.mark({ class: [known, ...extra].join(" ") }));
  }
  return builder.finish();
}

// ---------------------------------------------------------------- folds

export const setFolds = StateEffect.define<Results["folding"]>();

const folds = StateField.define<ReadonlyMap<number, number>>({
  create: () => new Map(),
  update(known, change) {
    for (const effect of change.effects) if (effect.is(setFolds)) return new Map(effect.value.map((fold) => [fold.line, fold.end_line]));
    return change.docChanged && change.startState.doc.lines !== change.state.doc.lines ? new Map() : known;
  },
});

const folding = foldService.of((state, from) => {
  const line = state.doc.lineAt(from);
  const end = state.field(folds).get(line.number);
  return end === undefined || end <= line.number || end > state.doc.lines ? null : { from: line.to, to: state.doc.line(end).to };
});

export function eliteScript(): Extension {
  return [new LanguageSupport(pythonLanguage), syntaxHighlighting(HIGHLIGHT), indentation, indentUnit.of(INDENT), tokens, folds, folding];
}
