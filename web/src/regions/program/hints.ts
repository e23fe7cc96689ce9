/** Hints between the characters of the text: units, names of arguments, times of the last run. */

import { RangeSetBuilder, StateEffect, StateField, type Extension, type Text } from "@codemirror/state";
import { Decoration, EditorView, WidgetType, type DecorationSet } from "@codemirror/view";
import type { Results } from "../../source/services.ts";
import { offsetOf } from "./positions.ts";

export const setHints = StateEffect.define<Results["hints"]>();

class HintWidget extends WidgetType {
  readonly label: string;
  readonly tooltip: string;

  constructor(label: string, tooltip: string) {
    super();
    this.label = label;
    this.tooltip = tooltip;
  }

  override eq(other: HintWidget): boolean {
    return other.label === this.label && other.tooltip === this.tooltip;
  }

  override toDOM(): HTMLElement {
    const made = document.createElement("span");
    made.className = "cm-hint";
    made.textContent = this.label;
    made.title = this.tooltip;
    // A look, not text of the program: screen readers read what can be edited.
    made.setAttribute("aria-hidden", "true");
    return made;
  }
}

const field = StateField.define<DecorationSet>({
  create: () => Decoration.none,
  update(drawn, change) {
    for (const effect of change.effects) if (effect.is(setHints)) return draw(change.state.doc, effect.value);
    return drawn.map(change.changes);
  },
  provide: (own) => EditorView.decorations.from(own),
});

function draw(text: Text, hints: Results["hints"]): DecorationSet {
  const builder = new RangeSetBuilder<Decoration>();
  for (const hint of hints) {
    const at = offsetOf(text, hint);
    builder.add(at, at, Decoration.widget({ widget: new HintWidget(hint.label, hint.tooltip), side: hint.kind === "argument" ? -1 : 1 }));
  }
  return builder.finish();
}

export function inlayHints(): Extension {
  return field;
}
