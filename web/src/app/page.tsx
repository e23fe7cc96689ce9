/** The page: all regions in their places. */

import "@preact/signals";
import type { ComponentType } from "preact";
import type { Studio } from "../model/studio.ts";
import { Cycle } from "../regions/cycle/index.tsx";
import { Messages } from "../regions/messages/index.tsx";
import { Pendant } from "../regions/pendant/index.tsx";
import { Problems } from "../regions/problems/index.tsx";
import { Program } from "../regions/program/index.tsx";
import { Robot } from "../regions/robot/index.tsx";
import { Signals } from "../regions/signals/index.tsx";
import { Threads } from "../regions/threads/index.tsx";
import { Timeline } from "../regions/timeline/index.tsx";
import { Variables } from "../regions/variables/index.tsx";
import type { Texts } from "../text/en.ts";
import { text } from "../text/text.ts";

const REGIONS: readonly (readonly [keyof Texts, string, ComponentType<{ studio: Studio }>])[] = [
  ["region_program", "program", Program],
  ["region_problems", "problems", Problems],
  ["region_robot", "robot", Robot],
  ["region_variables", "variables", Variables],
  ["region_signals", "signals", Signals],
  ["region_threads", "threads", Threads],
  ["region_timeline", "timeline", Timeline],
  ["region_messages", "messages", Messages],
  ["region_cycle", "cycle", Cycle],
  ["region_pendant", "pendant", Pendant],
];

export function Page({ studio }: { studio: Studio }) {
  return (
    <main>
      {REGIONS.map(([key, name, Region]) => (
        <section key={name} class={name} aria-label={text(key)}>
          <h2>{text(key)}</h2>
          <Region studio={studio} />
        </section>
      ))}
    </main>
  );
}
