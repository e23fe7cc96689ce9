/** Puts the colours in force, the language and the title on the document of the studio. */

import { effect } from "@preact/signals";
import type { Studio } from "../model/studio.ts";
import { paint } from "../style/paint.ts";
import { text } from "../text/text.ts";

/** Follows settings and the system until the returned function is called. */
export function dress(studio: Studio): () => void {
  const ends = [
    paint(),
    effect(() => {
      // Of several windows, the robot tells which is which.
      const robot = studio.robot.value;
      const name = studio.file.value?.name ?? (robot === "" ? studio.hello.value?.title ?? "" : "");
      const words = [name, robot, text("product")].filter(Boolean).join(" – ");
      document.title = `${studio.isModified.value ? "● " : ""}${words}`;
    }),
  ];
  return () => {
    for (const end of ends) end();
  };
}
