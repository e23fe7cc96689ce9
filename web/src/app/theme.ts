/** Puts the colours in force, the language and the title on the document. */

import { effect } from "@preact/signals";
import type { Studio } from "../model/studio.ts";
import { isDark, palette, systemIsDark } from "../style/palette.ts";
import { browserLanguage, language, text } from "../text/text.ts";

/** Begins with the language of the browser. */
export function speak(): void {
  browserLanguage.value = navigator.language.toLowerCase().startsWith("zh") ? "zh" : "en";
}

/** Follows settings and the system until the returned function is called. */
export function dress(studio: Studio): () => void {
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
    effect(() => {
      // Of several windows, the robot tells which is which.
      const robot = studio.robot.value;
      const name = studio.file.value?.name ?? (robot === "" ? studio.hello.value?.title ?? "" : "");
      const words = [name, robot, text("product")].filter(Boolean).join(" – ");
      document.title = `${studio.isModified.value ? "● " : ""}${words}`;
    }),
  ];
  return () => {
    query.removeEventListener("change", follow);
    for (const end of ends) end();
  };
}
