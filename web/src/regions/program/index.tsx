/** Region `Program`: the editor, with what the services and the run say of the text. */

import { effect, untracked, useSignal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import type { Studio } from "../../model/studio.ts";
import type { Results } from "../../source/services.ts";
import { language } from "../../text/language.ts";
import { text } from "../../text/text.ts";
import { ProgramEditor } from "./editor.ts";
import "./program.css";

export function Program({ studio }: { studio: Studio }) {
  const place = useRef<HTMLDivElement>(null);
  const showsTimes = useSignal(false);
  const showsHints = useSignal(true);

  useEffect(() => {
    const editor = new ProgramEditor(place.current!, studio);
    const ends = [
      effect(() => {
        void language.value;
        untracked(() => editor.name());
      }),
      effect(() => editor.show({ times: showsTimes.value, hints: showsHints.value })),
      effect(() => editor.take(studio.text.value)),
      effect(() => {
        const version = studio.version.value;
        untracked(() => editor.begin(version));
      }),
      effect(() => editor.allow(studio.can("edit"))),
      effect(() => editor.problems(studio.problems.value)),
      effect(() => editor.services(studio.version.value, studio.can("services"))),
      effect(() => editor.runs()),
      effect(() => editor.go(studio.goto.value)),
    ];
    return () => {
      for (const end of ends) end();
      editor.close();
    };
  }, [studio]);

  return (
    <div class="program-body">
      <div class="program-bar">
        <label>
          <input type="checkbox" checked={showsTimes} onChange={() => (showsTimes.value = !showsTimes.value)} /> {text("editor_times")}
        </label>
        {studio.can("services") && (
          <label>
            <input type="checkbox" checked={showsHints} onChange={() => (showsHints.value = !showsHints.value)} /> {text("editor_hints")}
          </label>
        )}
      </div>
      <div class="program-editor" ref={place} />
      {studio.text.value === "" && <Empty studio={studio} />}
    </div>
  );
}

/** What stands in an editor without a program. */
function Empty({ studio }: { studio: Studio }) {
  const examples = useSignal<Results["examples"]>([]);
  const canAsk = studio.can("services");
  useEffect(() => {
    if (canAsk) void studio.ask("examples").then((found) => (examples.value = found ?? []), () => {});
  }, [canAsk]);
  if (!studio.can("edit")) return <p class="program-empty">{text(studio.hello.value?.mode === "connected" ? "editor_on_controller" : "editor_no_text")}</p>;
  return (
    <div class="program-empty">
      <p>{text("editor_empty")}</p>
      <ul>
        {examples.value.map((example) => (
          <li key={example.name}>
            <button type="button" onClick={() => studio.editor?.replace(example.text)}>
              {example.title}
            </button>
          </li>
        ))}
      </ul>
    </div>
  );
}
