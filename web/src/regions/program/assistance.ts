/** Completion, hover, signatures, definitions, renaming, quick fixes and layout: the services behind the keys of the editor. */

import { autocompletion, snippet, type Completion, type CompletionContext, type CompletionResult } from "@codemirror/autocomplete";
import { ChangeSet, StateEffect, StateField, type ChangeSpec, type Extension, type Text, type TransactionSpec } from "@codemirror/state";
import { EditorView, hoverTooltip, keymap, showPanel, showTooltip, type Command, type KeyBinding, type Panel, type Tooltip } from "@codemirror/view";
import type { TextEdit } from "../../source/messages.ts";
import type { Completion as Offer, Results } from "../../source/services.ts";
import { text as shown } from "../../text/text.ts";
import { markdownNodes } from "./markdown.ts";
import { offsetOf, placeOf, rangeOf } from "./positions.ts";
import type { Services } from "./services.ts";

type Signature = NonNullable<Results["signature"]>;

/** Classes of CodeMirror's icons for our kinds. */
const ICONS: { readonly [kind: string]: string } = {
  command: "function", function: "function", method: "method", class: "class", variable: "variable", constant: "constant", argument: "property",
  keyword: "keyword", snippet: "text", module: "namespace", field: "property", value: "enum", name: "text", file: "text",
};

export function changesOf(text: Text, edits: readonly TextEdit[]): ChangeSpec[] {
  return edits.map((edit) => ({ ...rangeOf(text, edit), insert: edit.text }));
}

/** Makes edits as one step that can be undone. */
export function applyEdits(view: EditorView, edits: readonly TextEdit[]): void {
  if (edits.length > 0) view.dispatch({ changes: changesOf(view.state.doc, edits), userEvent: "input.service", scrollIntoView: true });
}

// ---------------------------------------------------------------- completion

/** Translates a snippet as other editors have it into CodeMirror's form. */
export function ownSnippet(source: string): string {
  return source
    .replace(/\$\{(\d+)\|((?:[^|\\]|\\.)*)\|\}/g, (_, number: string, choices: string) => `\${${number}:${choices.split(",")[0] ?? ""}}`)
    .replace(/\$0/g, "${}");
}

function completionSource(services: Services) {
  return async (context: CompletionContext): Promise<CompletionResult | null> => {
    const word = context.matchBefore(/\w+/);
    const before = context.state.sliceDoc(Math.max(0, context.pos - 1), context.pos);
    // Where nothing of a name is typed yet, a list would take the new line that is typed next.
    if (!context.explicit && word === null && !/["'.]/.test(before)) return null;
    const items = await services.completion(placeOf(context.state.doc, context.pos));
    if (items === null || items.length === 0) return null;
    // A name that is complete wants its blank or its new line, which must not choose from a list.
    const complete = new Set(items.filter((item) => item.snippet === "" && item.text === item.label).map((item) => item.label));
    if (!context.explicit && complete.has(word?.text ?? "")) return null;
    const from = rangeOf(context.state.doc, items[0]!.span).from;
    return { from, options: items.map((item, index) => option(services, item, items.length - index)), validFor: (typed) => /^\w*$/.test(typed) && !complete.has(typed) };
  };
}

function option(services: Services, item: Offer, rank: number): Completion {
  return {
    label: item.label,
    detail: item.detail,
    type: ICONS[item.kind] ?? "text",
    // The order of the services counts among those that fit equally well.
    boost: Math.min(99, rank / 10),
    // The place as it is now: the line may have been indented anew since the list was asked for.
    apply: (view, completion, from, to) => {
      if (item.snippet !== "") snippet(ownSnippet(item.snippet))(view, completion, from, to);
      else view.dispatch({ changes: { from, to, insert: item.text }, selection: { anchor: from + item.text.length }, userEvent: "input.complete" });
    },
    info: async () => {
      const full = item.documentation !== "" ? item : await services.resolve(item);
      return full === null || full.documentation === "" ? null : card(full.documentation);
    },
  };
}

/** Returns Markdown in an element of the tooltips' looks. */
function card(markdown: string): HTMLElement {
  const made = document.createElement("div");
  made.className = "cm-card";
  made.append(markdownNodes(markdown));
  return made;
}

// ---------------------------------------------------------------- hover

function hovers(services: Services): Extension {
  return hoverTooltip(
    async (view, at): Promise<Tooltip | null> => {
      const found = await services.hover(placeOf(view.state.doc, at));
      if (found === null) return null;
      const { from, to } = rangeOf(view.state.doc, found.span);
      return { pos: from, end: to, above: true, create: () => ({ dom: card(found.markdown) }) };
    },
    { hoverTime: 350 },
  );
}

// ---------------------------------------------------------------- signatures

const setSignature = StateEffect.define<{ readonly at: number; readonly help: Signature } | null>();

const signature = StateField.define<Tooltip | null>({
  create: () => null,
  update(tooltip, change) {
    for (const effect of change.effects) {
      if (effect.is(setSignature)) return effect.value === null ? null : { pos: effect.value.at, above: true, create: () => ({ dom: signatureCard(effect.value!.help) }) };
    }
    return tooltip !== null && change.docChanged ? { ...tooltip, pos: change.changes.mapPos(tooltip.pos) } : tooltip;
  },
  provide: (field) => showTooltip.from(field),
});

function signatureCard(help: Signature): HTMLElement {
  const made = document.createElement("div");
  made.className = "cm-card cm-signature";
  const label = made.appendChild(document.createElement("code"));
  const active = help.active === null ? undefined : help.parameters[help.active];
  const points = [...help.label];
  label.append(points.slice(0, active?.start ?? points.length).join(""));
  if (active !== undefined) {
    const strong = label.appendChild(document.createElement("strong"));
    strong.textContent = points.slice(active.start, active.end).join("");
    label.append(points.slice(active.end).join(""));
    if (active.markdown !== "") made.append(markdownNodes(active.markdown));
  }
  return made;
}

function signatures(services: Services): Extension {
  let asked = 0;
  return [
    signature,
    EditorView.updateListener.of((update) => {
      if (!update.docChanged && !update.selectionSet) return;
      const at = update.state.selection.main.head;
      const isShown = update.state.field(signature) !== null;
      const typed = update.docChanged && /[(,=]/.test(update.state.sliceDoc(at - 1, at));
      if (!isShown && !typed) return;
      const number = ++asked;
      // Behind the update, when the text is known to the source.
      queueMicrotask(async () => {
        const help = await services.signature(placeOf(update.view.state.doc, at));
        if (number === asked) update.view.dispatch({ effects: setSignature.of(help === null ? null : { at, help }) });
      });
    }),
  ];
}

const closeSignature: Command = (view) => {
  if (view.state.field(signature) === null) return false;
  view.dispatch({ effects: setSignature.of(null) });
  return true;
};

// ---------------------------------------------------------------- what follows from a character

/** The last characters of a new line, of a clause and of `end`, after which the services have something to say. */
const TRIGGERS = ["\n", ":", "d"];

/** Returns the change of edits after a character; the caret stays in its line, in front of an `end` that is put below. */
export function typedEdits(text: Text, edits: readonly TextEdit[], caret: number): TransactionSpec {
  const changes = ChangeSet.of(changesOf(text, edits), text.length);
  const around = edits.find((edit) => rangeOf(text, edit).from <= caret && caret <= rangeOf(text, edit).to && edit.text.includes("\n"));
  const anchor = around === undefined ? changes.mapPos(caret, 1) : changes.mapPos(rangeOf(text, around).from, -1) + around.text.indexOf("\n");
  return { changes, selection: { anchor }, userEvent: "input.service" };
}

function typing(services: Services): Extension {
  return EditorView.updateListener.of((update) => {
    const { doc, selection } = update.state;
    const isTyped = update.transactions.some((change) => change.isUserEvent("input"));
    if (!update.docChanged || !isTyped || update.transactions.some((change) => change.isUserEvent("input.service"))) return;
    let character = "";
    update.changes.iterChanges((_from, _to, _start, _end, inserted) => {
      const text = inserted.toString();
      // A new line comes with its indentation.
      character = /^\n[ \t]*$/.test(text) ? "\n" : text;
    });
    if (!TRIGGERS.includes(character)) return;
    const at = selection.main.head;
    // Behind the update, when the text is known to the source.
    queueMicrotask(async () => {
      const edits = await services.typing(placeOf(doc, at), character);
      if (edits !== null && edits.length > 0 && update.view.state.doc === doc) update.view.dispatch(typedEdits(doc, edits, at));
    });
  });
}

// ---------------------------------------------------------------- a line below the text in which something is typed or chosen

type Line = { readonly kind: "rename"; readonly at: number; readonly name: string } | { readonly kind: "fixes"; readonly list: Results["actions"] } | { readonly kind: "text"; readonly text: string };

const setLine = StateEffect.define<Line | null>();

function lines(services: Services): Extension {
  const field = StateField.define<Line | null>({
    create: () => null,
    update(line, change) {
      for (const effect of change.effects) if (effect.is(setLine)) return effect.value;
      return change.docChanged ? null : line;
    },
    provide: (own) => showPanel.from(own, (line) => (line === null ? null : (view) => linePanel(services, view, line))),
  });
  const close: Command = (view) => {
    if (view.state.field(field) === null) return false;
    view.dispatch({ effects: setLine.of(null) });
    return true;
  };
  return [field, keymap.of([{ key: "Escape", run: close }])];
}

function linePanel(services: Services, view: EditorView, line: Line): Panel {
  const dom = document.createElement("div");
  dom.className = "cm-line-panel";
  const close = () => {
    view.dispatch({ effects: setLine.of(null) });
    view.focus();
  };
  dom.addEventListener("keydown", (event) => {
    if (event.key === "Escape") {
      event.preventDefault();
      close();
    }
  });
  if (line.kind === "text") {
    dom.setAttribute("role", "status");
    dom.textContent = line.text;
    return { dom };
  }
  if (line.kind === "fixes") {
    for (const action of line.list) {
      const button = dom.appendChild(document.createElement("button"));
      button.type = "button";
      button.textContent = action.title;
      button.onclick = () => {
        applyEdits(view, action.edits);
        close();
      };
    }
    return { dom, mount: () => dom.querySelector("button")?.focus() };
  }
  const label = dom.appendChild(document.createElement("label"));
  label.textContent = `${shown("editor_new_name")} `;
  const input = label.appendChild(document.createElement("input"));
  input.value = line.name;
  const said = dom.appendChild(document.createElement("span"));
  said.setAttribute("role", "alert");
  input.addEventListener("keydown", async (event) => {
    if (event.key !== "Enter") return;
    event.preventDefault();
    const renaming = await services.rename(placeOf(view.state.doc, line.at), input.value);
    if (renaming === null || !("edits" in renaming)) return;
    if (renaming.refusal !== "") said.textContent = renaming.refusal;
    else {
      applyEdits(view, renaming.edits);
      close();
    }
  });
  return { dom, mount: () => input.select() };
}

// ---------------------------------------------------------------- commands

function say(view: EditorView, text: string): void {
  view.dispatch({ effects: setLine.of({ kind: "text", text }) });
}

function commands(services: Services): readonly KeyBinding[] {
  const later = (act: (view: EditorView) => Promise<void>): Command => (view) => {
    void act(view);
    return true;
  };
  const head = (view: EditorView) => placeOf(view.state.doc, view.state.selection.main.head);
  return [
    {
      key: "F12",
      run: later(async (view) => {
        const places = await services.definition(head(view));
        const place = places?.[0];
        if (place === undefined) say(view, shown("editor_no_definition"));
        else view.dispatch({ selection: { anchor: offsetOf(view.state.doc, place) }, scrollIntoView: true });
      }),
    },
    {
      key: "Shift-F12",
      run: later(async (view) => {
        const found = (await services.references(head(view))) ?? [];
        const here = view.state.selection.main.head;
        const starts = found.map((use) => rangeOf(view.state.doc, use.span).from).sort((a, b) => a - b);
        const next = starts.find((start) => start > here) ?? starts[0];
        if (next !== undefined) view.dispatch({ selection: { anchor: next }, scrollIntoView: true });
        say(view, starts.length === 1 ? shown("editor_use") : shown("editor_uses", { count: starts.length }));
      }),
    },
    {
      key: "F2",
      run: later(async (view) => {
        const word = view.state.wordAt(view.state.selection.main.head);
        if (word === null) say(view, shown("editor_no_name"));
        else view.dispatch({ effects: setLine.of({ kind: "rename", at: word.from, name: view.state.sliceDoc(word.from, word.to) }) });
      }),
    },
    {
      key: "Mod-.",
      run: later(async (view) => {
        const { from, to } = view.state.selection.main;
        const end = placeOf(view.state.doc, to);
        const list = await services.actions({ ...placeOf(view.state.doc, from), end_line: end.line, end_column: end.column });
        if (list === null || list.length === 0) say(view, shown("editor_no_fix"));
        else view.dispatch({ effects: setLine.of({ kind: "fixes", list }) });
      }),
    },
    {
      key: "Shift-Alt-f",
      run: later(async (view) => {
        const edits = await services.format();
        if (edits !== null) applyEdits(view, edits);
        say(view, edits === null || edits.length === 0 ? shown("editor_nothing_to_format") : shown("editor_formatted"));
      }),
    },
    { key: "Escape", run: closeSignature },
  ];
}

export function assistance(services: Services): { readonly extension: Extension; readonly keys: readonly KeyBinding[] } {
  return {
    extension: [
      autocompletion({ override: [completionSource(services)], icons: true, maxRenderedOptions: 60 }),
      hovers(services),
      signatures(services),
      typing(services),
      lines(services),
    ],
    keys: commands(services),
  };
}
