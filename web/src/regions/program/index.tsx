/** Region `Program`: the editor, with what the services and the run say of the text. */

import { effect, untracked, useSignal } from "@preact/signals";
import type { TargetedKeyboardEvent } from "preact";
import { useEffect, useRef } from "preact/hooks";
import { Divider, sizeOf, type Size } from "../../app/divider.tsx";
import type { Studio } from "../../model/studio.ts";
import type { Results } from "../../source/services.ts";
import { language } from "../../text/language.ts";
import type { Texts } from "../../text/en.ts";
import { said } from "../../text/said.ts";
import { text } from "../../text/text.ts";
import { ProgramEditor } from "./editor.ts";
import "./program.css";
import { FindNode, TreeView } from "./tree.tsx";

type View = "tree" | "text" | "both";

const VIEWS: { readonly [view in View]: keyof Texts } = { tree: "tree_tab", text: "tree_text_tab", both: "tree_both_tab" };

const TREE: Size = { name: "tree", first: 0.55, least: 0.15, most: 0.85, title: "tree_tab" };

export function Program({ studio, isWide }: { studio: Studio; isWide: boolean }) {
  const place = useRef<HTMLDivElement>(null);
  const chosenView = useSignal<View | null>(null);
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
      effect(() => editor.allow(studio.canWrite.value)),
      effect(() => editor.showRow(studio.row.value)),
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

  const tree = studio.tree.value;
  const hasTree = tree !== null && studio.can("edit");
  const view = hasTree ? (chosenView.value ?? (isWide ? "both" : "tree")) : "text";
  const name = studio.file.value?.name ?? "";
  return (
    <div class="program-body">
      <div class="program-bar">
        {hasTree && <Tabs view={view} choose={(to) => (chosenView.value = to)} />}
        {hasTree && view !== "text" && tree.rows.length > 0 && <FindNode studio={studio} tree={tree} />}
        {view !== "tree" && (
          <>
            <label>
              <input type="checkbox" checked={showsTimes} onChange={() => (showsTimes.value = !showsTimes.value)} /> {text("editor_times")}
            </label>
            {studio.can("services") && (
              <label>
                <input type="checkbox" checked={showsHints} onChange={() => (showsHints.value = !showsHints.value)} /> {text("editor_hints")}
              </label>
            )}
          </>
        )}
      </div>
      <div class="program-views" style={{ "--tree": `${(100 * sizeOf(studio, TREE)).toFixed(1)}%` }}>
        {hasTree && view !== "text" && (
          <div id="program-tree" class={view === "both" ? "program-tree-pane part" : "program-tree-pane"} role="tabpanel" aria-label={text("tree_tab")}>
            {tree.rows.length > 0 ? <TreeView studio={studio} tree={tree} /> : <Broken studio={studio} name={name} />}
          </div>
        )}
        {hasTree && view === "both" && <Divider studio={studio} size={TREE} orientation="horizontal" side={1} />}
        <div id="program-text" class="program-text-pane" hidden={view === "tree"} {...(hasTree ? { role: "tabpanel", "aria-label": text("tree_text_tab") } : {})}>
          {hasTree && tree.rows.length > 0 && <p class="program-source faint">{text("tree_generated", { name })}</p>}
          <div class="program-editor" ref={place} />
        </div>
      </div>
      {(studio.text.value === "" || studio.isEmpty.value) && <Empty studio={studio} />}
    </div>
  );
}

/** Whether the tree of a task is shown, its script, or both. */
function Tabs({ view, choose }: { view: View; choose: (view: View) => void }) {
  const names = Object.keys(VIEWS) as View[];
  const press = (event: TargetedKeyboardEvent<HTMLDivElement>) => {
    const by = event.key === "ArrowRight" ? 1 : event.key === "ArrowLeft" ? -1 : 0;
    if (by === 0) return;
    event.preventDefault();
    const next = names[(names.indexOf(view) + by + names.length) % names.length]!;
    choose(next);
    event.currentTarget.querySelector<HTMLElement>(`[data-view="${next}"]`)?.focus();
  };
  return (
    <div class="program-tabs" role="tablist" aria-label={text("tree_tabs")} onKeyDown={press}>
      {names.map((name) => (
        <button
          key={name} type="button" role="tab" data-view={name} class={name === view ? "plain on" : "plain"} aria-selected={name === view}
          tabIndex={name === view ? 0 : -1} onClick={() => choose(name)}
        >
          {text(VIEWS[name])}
        </button>
      ))}
    </div>
  );
}

/** What stands in place of the tree of a file that is no task. */
function Broken({ studio, name }: { studio: Studio; name: string }) {
  const problem = studio.problems.value?.list.find(({ severity }) => severity === "error");
  return (
    <div class="empty" role="group" aria-label={text("tree_broken", { name })}>
      <p>{text("tree_broken", { name })}</p>
      {problem !== undefined && (
        <button type="button" class="place" onClick={() => (studio.goto.value = { line: problem.line, column: problem.column })}>
          {text("problem", { line: problem.line, column: problem.column, severity: text("severity_error"), code: problem.code, text: problem.text })}
        </button>
      )}
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
