/** Puts the colours in force and the language on the document. */

import { effect } from "@preact/signals-core";
import { language } from "../text/language.ts";
import { isDark, palette, systemIsDark } from "./palette.ts";

/** Follows the chosen theme, the system and the language until the returned function is called. */
export function paint(): () => void {
  const query = matchMedia("(prefers-color-scheme: dark)");
  const follow = () => (systemIsDark.value = query.matches);
  follow();
  query.addEventListener("change", follow);
  const root = document.documentElement;
  const ends = [
    effect(() => {
      root.dataset["theme"] = isDark.value ? "dark" : "light";
      root.style.colorScheme = isDark.value ? "dark" : "light";
      for (const [name, value] of Object.entries(palette.value)) {
        if (typeof value === "string") root.style.setProperty(`--${name.replaceAll("_", "-")}`, value);
        else value.forEach((colour: string, index: number) => root.style.setProperty(`--joint-${index + 1}`, colour));
      }
    }),
    effect(() => void (root.lang = language.value)),
  ];
  return () => {
    query.removeEventListener("change", follow);
    for (const end of ends) end();
  };
}
