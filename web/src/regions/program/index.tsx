/** Region `Program`: the editor, with what the services and the run say of the text. */

import { effect, untracked, useSignal } from "@preact/signals";
import { useEffect, useRef } from "preact/hooks";
import type { Studio } from "../../model/studio.ts";
import type { Results } from "../../source/services.ts";
import { language } from "../../text/language.ts";
import { said } from "../../text/said.ts";
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
      {(studio.text.value === "" || studio.isEmpty.value) && <Empty studio={studio} />}
    </div>
  );
}

/** The first lines of a program that somebody begins to write. */
const BEGIN = 'def program():\n  textmsg("hello")\nend\n';
/** Programs of the folder that can be chosen; the field with the name of the file has all of them. */
const PROGRAMS_MAX = 200;

/** What stands in an editor without a program: three ways to begin. */
function Empty({ studio }: { studio: Studio }) {
  const examples = useSignal<Results["examples"]>([]);
  const canAsk = studio.can("services");
  useEffect(() => {
    if (canAsk) void studio.ask("examples").then((found) => (examples.value = found ?? []), () => {});
  }, [canAsk]);
  if (!studio.can("edit")) return <p class="program-empty">{text(studio.hello.value?.mode === "connected" ? "editor_on_controller" : "editor_no_text")}</p>;
  const begin = (program: string) => {
    // Comments that stand there already stay.
    const known = studio.text.value.trimEnd();
    studio.editor?.replace(known === "" ? program : `${known}\n\n${program}`);
    studio.editor?.focus();
  };
  const others = (studio.hello.value?.programs ?? []).filter((name) => name !== studio.file.value?.name);
  return (
    <div class="program-empty" role="group" aria-label={text("editor_empty")}>
      <p>{text("editor_empty")}</p>
      <ul>
        <li><button type="button" onClick={() => begin(BEGIN)}>{text("editor_write")}</button></li>
        <li>
          {others.length === 0 ? text("editor_open_folder") : (
            <select aria-label={text("editor_open")} value="" onChange={({ currentTarget }) => void studio.open(currentTarget.value)}>
              <option value="">{text("editor_open")}</option>
              {others.slice(0, PROGRAMS_MAX).map((name) => <option key={name} value={name}>{name}</option>)}
            </select>
          )}
        </li>
        {examples.value.map((example) => (
          <li key={example.name}>
            <button type="button" onClick={() => begin(example.text)}>
              {text("editor_example", { title: said(example.title) })}
            </button>
          </li>
        ))}
      </ul>
    </div>
  );
}
