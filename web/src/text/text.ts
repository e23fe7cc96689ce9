/** The texts of the studio in the language of the page. */

import { en, type Texts } from "./en.ts";
import { filled, language } from "./language.ts";
import { zh } from "./zh.ts";

/** Characters of a text of a program that are shown in a row; a program may write a megabyte. */
const SHOWN_MAX = 2000;

/** Returns the begin of a text that is too long for a row. */
export function shortened(words: string): string {
  return words.length > SHOWN_MAX ? `${words.slice(0, SHOWN_MAX)}…` : words;
}

/** Returns an ISO time as the clock here shows it; a text that is no time as it is. */
export function localTime(at: string): string {
  const time = new Date(at);
  return Number.isNaN(time.getTime()) ? at : time.toLocaleString(language.value, { dateStyle: "medium", timeStyle: "short" });
}

/** Returns a text in the language of the page, with `{name}` replaced by values. */
export function text(key: keyof Texts, values: { readonly [name: string]: string | number } = {}): string {
  return filled((language.value === "zh" ? zh : en)[key], values);
}
