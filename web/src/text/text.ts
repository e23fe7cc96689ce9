/** The language of the page. */

import { signal } from "@preact/signals-core";
import { en, type Texts } from "./en.ts";
import { zh } from "./zh.ts";

export type Language = "en" | "zh";

export const language = signal<Language>("en");

/** Characters of a text of a program that are shown in a row; a program may write a megabyte. */
const SHOWN_MAX = 2000;

/** Returns the begin of a text that is too long for a row. */
export function shortened(words: string): string {
  return words.length > SHOWN_MAX ? `${words.slice(0, SHOWN_MAX)}…` : words;
}

/** Returns a text in the language of the page, with `{name}` replaced by values. */
export function text(key: keyof Texts, values: { readonly [name: string]: string | number } = {}): string {
  const found = (language.value === "zh" ? zh : en)[key];
  return found.replace(/\{(\w+)\}/g, (_, name: string) => String(values[name] ?? ""));
}
