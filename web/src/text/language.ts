/** The language of the page. */

import { computed, signal } from "@preact/signals-core";

export type Language = "en" | "zh";

/** What the browser speaks, and what somebody has chosen instead of it; null: nothing. Only a choice is remembered. */
export const browserLanguage = signal<Language>("en");
export const chosenLanguage = signal<Language | null>(null);

export const language = computed(() => chosenLanguage.value ?? browserLanguage.value);

/** Begins with the language of the browser. */
export function speak(): void {
  browserLanguage.value = navigator.language.toLowerCase().startsWith("zh") ? "zh" : "en";
}

/** Returns a text with `{name}` replaced by values. */
export function filled(found: string, values: { readonly [name: string]: string | number }): string {
  return found.replace(/\{(\w+)\}/g, (_, name: string) => String(values[name] ?? ""));
}
