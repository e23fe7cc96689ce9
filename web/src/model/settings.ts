/** What the page remembers from one start to the next. The source keeps it, because the address of the page changes. */

import { effect, signal } from "@preact/signals-core";
import type { Json } from "../source/messages.ts";
import { theme, type Theme } from "../style/palette.ts";
import { chosenLanguage, type Language } from "../text/language.ts";
import type { Display } from "./units.ts";

/** After the last change. */
export const TELL_MS = 300;

export class Settings {
  readonly display = signal<Display>({ angle: "deg", length: "mm" });
  /** Sizes of panes by name, as fractions of the window. */
  readonly sizes = signal<{ readonly [name: string]: number }>({});
  /** Sections by name that are open or closed otherwise than at first. */
  readonly open = signal<{ readonly [name: string]: boolean }>({});
  private known = "";
  private timer: ReturnType<typeof setTimeout> | undefined;

  /** Calls `tell` with all values a moment after the last change; returns what ends that. */
  watch(tell: (values: { readonly [key: string]: Json }) => void): () => void {
    this.known = JSON.stringify(this.values());
    return effect(() => {
      const values = this.values();
      clearTimeout(this.timer);
      this.timer = setTimeout(() => {
        const said = JSON.stringify(values);
        if (said !== this.known) tell(values);
        this.known = said;
      }, TELL_MS);
    });
  }

  values(): { readonly [key: string]: Json } {
    return {
      theme: theme.value, ...(chosenLanguage.value === null ? {} : { language: chosenLanguage.value }), angle: this.display.value.angle, length: this.display.value.length,
      sizes: this.sizes.value, open: this.open.value,
    };
  }

  /** Takes what the source remembers; what has another form is left as it is. */
  take(values: { readonly [key: string]: Json }): void {
    const { theme: shade, language: words, angle, length, sizes, open } = values;
    if (shade === "system" || shade === "light" || shade === "dark") theme.value = shade satisfies Theme;
    if (words === "en" || words === "zh") chosenLanguage.value = words satisfies Language;
    const display = this.display.value;
    this.display.value = {
      angle: angle === "rad" || angle === "deg" ? angle : display.angle,
      length: length === "m" || length === "mm" ? length : display.length,
    };
    this.sizes.value = { ...this.sizes.value, ...entries(sizes, (value): value is number => typeof value === "number" && value > 0 && value < 1) };
    this.open.value = { ...this.open.value, ...entries(open, (value): value is boolean => typeof value === "boolean") };
    this.known = JSON.stringify(this.values());
  }
}

function entries<T extends Json>(found: Json | undefined, fits: (value: Json) => value is T): { [name: string]: T } {
  const kept: { [name: string]: T } = {};
  if (typeof found === "object" && found !== null && !Array.isArray(found)) {
    for (const [name, value] of Object.entries(found)) if (fits(value)) kept[name] = value;
  }
  return kept;
}
