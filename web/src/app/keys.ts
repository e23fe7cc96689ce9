/** Keys of the page, outside of the editor, which has its own. */

import { signal } from "@preact/signals-core";
import type { Studio } from "../model/studio.ts";
import type { Texts } from "../text/en.ts";

export interface Key {
  /** As `KeyboardEvent.key`; "Mod+" for Ctrl, or Cmd on a Mac. */
  readonly key: string;
  readonly meaning: keyof Texts;
  readonly press: (studio: Studio) => void;
}

/** Whether the list of keys is shown. */
export const isHelpOpen = signal(false);

export const KEYS: readonly Key[] = [
  { key: " ", meaning: "key_run", press: (studio) => (studio.isPlaying.value ? studio.pause() : studio.play()) },
  { key: ",", meaning: "key_step_back", press: (studio) => void studio.step(-1) },
  { key: ".", meaning: "key_step", press: (studio) => void studio.step(1) },
  { key: "[", meaning: "key_event_before", press: (studio) => studio.jumpToEvent(-1) },
  { key: "]", meaning: "key_event_after", press: (studio) => studio.jumpToEvent(1) },
  { key: "f", meaning: "key_fit", press: (studio) => (studio.view.value = { to: "fit" }) },
  { key: "1", meaning: "key_front", press: (studio) => (studio.view.value = { to: "front" }) },
  { key: "2", meaning: "key_side", press: (studio) => (studio.view.value = { to: "side" }) },
  { key: "3", meaning: "key_top", press: (studio) => (studio.view.value = { to: "top" }) },
  { key: "4", meaning: "key_iso", press: (studio) => (studio.view.value = { to: "iso" }) },
  { key: "Mod+s", meaning: "key_save", press: (studio) => void studio.save() },
  { key: "Mod+Enter", meaning: "key_run_always", press: (studio) => studio.play() },
  { key: "Mod+z", meaning: "key_undo", press: (studio) => studio.undo() },
  { key: "Mod+Shift+z", meaning: "key_redo", press: (studio) => studio.redo() },
  { key: "F8", meaning: "key_problem", press: nextProblem },
  { key: "?", meaning: "key_help", press: () => (isHelpOpen.value = !isHelpOpen.value) },
];

/** Keys of the editor and the slider, for the list. */
export const OTHER_KEYS: readonly (readonly [string, keyof Texts])[] = [
  ["Escape, Tab", "key_leave_editor"],
  ["← →", "key_tick"],
  ["PageUp PageDown", "key_second"],
  ["Home End", "key_ends"],
];

/** What takes letters or Enter itself. */
const TYPED_INTO = "input:not([type=range]):not([type=checkbox]):not([type=radio]), textarea, select, [contenteditable=true], .cm-editor";
const PRESSED = "button, a, summary, input, label, select, [role=switch]";

/** Listens until the returned function is called. */
export function listen(studio: Studio): () => void {
  const press = (event: KeyboardEvent) => {
    // Wherever the focus is: it comes into the list a moment after the list.
    if (event.key === "Escape" && isHelpOpen.value) {
      isHelpOpen.value = false;
      return;
    }
    const key = keyFor(event);
    if (key === undefined || event.defaultPrevented) return;
    const target = event.target instanceof Element ? event.target : document.body;
    const isTyping = target.closest(TYPED_INTO) !== null;
    const isEverywhere = key.key === "Mod+s" || (key.key === "Mod+Enter" && target.closest(".cm-editor") === null);
    if (isTyping && !isEverywhere) return;
    if (key.key === " " && target.closest(PRESSED) !== null && target.closest("[type=range]") === null) return;
    event.preventDefault();
    key.press(studio);
  };
  window.addEventListener("keydown", press);
  return () => window.removeEventListener("keydown", press);
}

function keyFor(event: KeyboardEvent): Key | undefined {
  if (event.altKey) return undefined;
  const name = event.key.length === 1 ? event.key.toLowerCase() : event.key;
  const hasMod = event.ctrlKey || event.metaKey;
  if (hasMod && name === "y") return KEYS.find((key) => key.key === "Mod+Shift+z");
  return KEYS.find((key) => key.key === (hasMod ? `Mod+${event.shiftKey ? "Shift+" : ""}${name}` : name));
}

function nextProblem(studio: Studio): void {
  const list = studio.problems.value?.list ?? [];
  const at = studio.goto.value;
  const index = list.findIndex((problem) => at !== null && (problem.line > at.line || (problem.line === at.line && problem.column > at.column)));
  const next = list[Math.max(index, 0)];
  if (next !== undefined) studio.goto.value = { line: next.line, column: next.column };
}
