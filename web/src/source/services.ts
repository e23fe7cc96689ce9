/**
 * What `service` requests answer: `result` of an `answer`, by the name of the service, and the arguments of each.
 *
 * Services of the text are answered for the version of the newest `program` only; another one is `refused`.
 */

import type { Json, TextEdit } from "./messages.ts";

export interface Span { readonly line: number; readonly column: number; readonly end_line: number; readonly end_column: number }

/** Offered at `line`, `column`: takes the place of `span`. `documentation` is empty until `resolve`. */
export interface Completion {
  readonly label: string;
  readonly kind:
    | "command" | "function" | "class" | "field" | "variable" | "constant" | "argument" | "keyword" | "snippet" | "module"
    | "method" | "value" | "name" | "file";
  readonly span: Span;
  readonly text: string;
  /** With places to fill in, `${1:name}`; empty if it is the text. */
  readonly snippet: string;
  readonly detail: string;
  readonly sort: string;
  /** The firmware that is chosen does not have it. */
  readonly is_missing: boolean;
  readonly is_deprecated: boolean;
  /** For `resolve`; empty if there is no more to know. */
  readonly source: string;
  readonly documentation: string;
}

export interface OutlineSymbol {
  readonly name: string; readonly kind: string; readonly detail: string;
  readonly span: Span; readonly name_span: Span; readonly children: readonly OutlineSymbol[];
}

export interface SignalFamily {
  readonly name: string;
  readonly kind: "bool" | "int" | "float";
  /** Number of points: `name` alone if it is 1, else `name[0]`, `name[1]`, ... */
  readonly size: number;
  readonly is_input: boolean;
  readonly low: number | null; readonly high: number | null; readonly unit: string;
  readonly default: boolean | number;
  readonly summary: string;
  readonly is_kept: boolean;
}

export interface Results {
  completion: readonly Completion[];
  /** Arguments `label`, `kind`, `source` of a completion. */
  resolve: { readonly documentation: string };
  hover: { readonly span: Span; readonly markdown: string } | null;
  /** `start` and `end` of parameters are places in the label, in characters from 0. */
  signature: {
    readonly label: string; readonly markdown: string; readonly active: number | null;
    readonly parameters: readonly { readonly start: number; readonly end: number; readonly markdown: string }[];
  } | null;
  definition: readonly Span[];
  references: readonly { readonly span: Span; readonly access: string; readonly is_definition: boolean }[];
  /** Without argument `new_name`: what can be renamed there; with it: the edits, or why not. */
  rename:
    | { readonly span: Span; readonly name: string; readonly refusal: string } | null
    | { readonly edits: readonly TextEdit[]; readonly refusal: string };
  /** From `line`, `column` to arguments `end_line`, `end_column`. `problems`: codes of what it mends. */
  actions: readonly {
    readonly title: string; readonly kind: string; readonly edits: readonly TextEdit[]; readonly problems: readonly string[];
    readonly is_preferred: boolean;
  }[];
  /** Of the whole text; of a range if there is a `line`, with arguments `end_line`, `end_column`. */
  format: readonly TextEdit[];
  /** Of the whole text or a range. `rows`: line, column, length, index of the type, bits of the modifiers of each token. */
  tokens: { readonly types: readonly string[]; readonly modifiers: readonly string[]; readonly rows: readonly number[] };
  /** Of the whole text or a range; times and values are those of the last run. */
  hints: readonly {
    readonly line: number; readonly column: number; readonly kind: string; readonly label: string; readonly tooltip: string;
    readonly pads_left: boolean; readonly pads_right: boolean;
  }[];
  /** What follows from argument `typed`, the character in front of `line`, `column`: indentation, the `end` of a block. */
  typing: readonly TextEdit[];
  folding: readonly { readonly line: number; readonly end_line: number; readonly kind: string }[];
  outline: readonly OutlineSymbol[];
  /** Argument `code`, such as E303. */
  explain: { readonly code: string; readonly markdown: string };
  /** As `elitescript commands --json`; with argument `name` that one, or null. */
  commands: Json;
  robots: {
    readonly robots: readonly { readonly name: string; readonly reach_m: number; readonly payload_kg: number }[];
    readonly firmwares: readonly string[];
    /** As the studio was started. */
    readonly defaults: { readonly robot: string; readonly firmware: string };
  };
  /** The URDF; with argument `file` a mesh or picture that it names, as it names it. */
  mesh: { readonly name: string; readonly text: string } | { readonly name: string; readonly base64: string };
  examples: readonly { readonly name: string; readonly title: string; readonly text: string }[];
  signals: readonly SignalFamily[];
}
