/** The page: all regions in their places, wide, medium or narrow. */

import { useSignal } from "@preact/signals";
import type { ComponentChildren } from "preact";
import { useEffect, useState } from "preact/hooks";
import type { Studio } from "../model/studio.ts";
import { Cycle } from "../regions/cycle/index.tsx";
import { Messages } from "../regions/messages/index.tsx";
import { Pendant } from "../regions/pendant/index.tsx";
import { Problems } from "../regions/problems/index.tsx";
import { Program } from "../regions/program/index.tsx";
import { Robot } from "../regions/robot/index.tsx";
import { Signals } from "../regions/signals/index.tsx";
import { Threads } from "../regions/threads/index.tsx";
import { Timeline, TimelineTools } from "../regions/timeline/index.tsx";
import { Variables } from "../regions/variables/index.tsx";
import { speak } from "../text/language.ts";
import { text } from "../text/text.ts";
import { Announcer } from "./announcer.tsx";
import { ComparePanel } from "./compare.tsx";
import { ConflictView } from "./conflict.tsx";
import { Divider, sizeOf, type Size } from "./divider.tsx";
import { Help } from "./help.tsx";
import { listen } from "./keys.ts";
import { Notices } from "./notices.tsx";
import { OptionsPanel } from "./options.tsx";
import { isOpen, Region } from "./region.tsx";
import { problemCount } from "./state.ts";
import { dress } from "./theme.ts";
import { Toolbar } from "./toolbar.tsx";

export type Layout = "wide" | "medium" | "narrow";

/** Widths in CSS pixels from which on a layout begins. */
export const WIDE_PX = 1100;
export const MEDIUM_PX = 760;

export function layoutFor(width_px: number): Layout {
  return width_px >= WIDE_PX ? "wide" : width_px >= MEDIUM_PX ? "medium" : "narrow";
}

const SIZES = {
  left: { name: "left", first: 0.34, least: 0.15, most: 0.6, title: "region_program" },
  right: { name: "right", first: 0.23, least: 0.12, most: 0.4, title: "region_signals" },
  problems: { name: "problems", first: 0.22, least: 0.1, most: 0.8, title: "region_problems" },
  time: { name: "time", first: 0.33, least: 0.1, most: 0.7, title: "region_timeline" },
  lists: { name: "lists", first: 0.13, least: 0.08, most: 0.5, title: "region_messages" },
  cycle: { name: "cycle", first: 0.45, least: 0.15, most: 0.85, title: "region_cycle" },
} as const satisfies { readonly [name: string]: Size };

const percent = (fraction: number) => `${(100 * fraction).toFixed(1)}%`;

export function Page({ studio }: { studio: Studio }) {
  useState(speak);
  const layout = useSignal<Layout>(layoutFor(window.innerWidth));
  useEffect(() => {
    const measure = () => (layout.value = layoutFor(window.innerWidth));
    const guard = (event: BeforeUnloadEvent) => {
      // The source keeps a draft of every text that it has heard of.
      if (studio.isModified.value && studio.link.value !== "open") event.preventDefault();
    };
    window.addEventListener("resize", measure);
    window.addEventListener("beforeunload", guard);
    const ends = [dress(studio), listen(studio)];
    return () => {
      window.removeEventListener("resize", measure);
      window.removeEventListener("beforeunload", guard);
      for (const end of ends) end();
    };
  }, [studio]);
  return (
    <div class={`page ${layout.value}`}>
      <Toolbar studio={studio} isNarrow={layout.value === "narrow"} />
      <OptionsPanel studio={studio} />
      <ComparePanel studio={studio} />
      <Notices studio={studio} />
      <ConflictView studio={studio} />
      <Panes studio={studio} layout={layout.value} />
      <Help />
      <Announcer studio={studio} />
    </div>
  );
}

function Panes({ studio, layout }: { studio: Studio; layout: Layout }) {
  const isNarrow = layout === "narrow";
  const isConnected = studio.hello.value?.mode === "connected";
  const fold = (name: string) => ({ key: `${isNarrow ? "narrow" : "wide"}.${name}`, isOpen: !isNarrow });
  const folds = { variables: fold("variables"), signals: fold("signals"), threads: fold("threads"), messages: fold("messages"), cycle: fold("cycle") };
  const areListsOpen = isOpen(studio, folds.messages) || isOpen(studio, folds.cycle);
  const between = (size: Size, orientation: "vertical" | "horizontal", side: 1 | -1) =>
    isNarrow ? null : <Divider key={`${size.name} divider`} studio={studio} size={size} orientation={orientation} side={side} />;

  const pendant = isConnected && (
    <Region key="pendant" studio={studio} name="pendant" title="region_pendant"><Pendant studio={studio} /></Region>
  );
  const left = (
    <div key="left" class="pane pane-left">
      <Region studio={studio} name="program" title="region_program"><Program studio={studio} isWide={layout === "wide"} /></Region>
      {between(SIZES.problems, "horizontal", -1)}
      <Region studio={studio} name="problems" title="region_problems" badge={<ProblemBadge studio={studio} />}><Problems studio={studio} /></Region>
    </div>
  );
  const robot = (
    <div key="robot" class="pane pane-middle">
      <Region studio={studio} name="robot" title="region_robot"><Robot studio={studio} /></Region>
      {pendant}
    </div>
  );
  const right = (
    <div key="right" class="pane pane-right">
      <Region studio={studio} name="variables" title="region_variables" fold={folds.variables}><Variables studio={studio} /></Region>
      <Region studio={studio} name="signals" title="region_signals" fold={folds.signals}><Signals studio={studio} /></Region>
      <Region studio={studio} name="threads" title="region_threads" fold={folds.threads}><Threads studio={studio} /></Region>
    </div>
  );
  const time = (
    <div key="time" class="pane pane-time">
      <Region studio={studio} name="timeline" title="region_timeline" badge={<TimelineTools studio={studio} />}><Timeline studio={studio} /></Region>
    </div>
  );
  const lists = (
    <div key="lists" class={`pane pane-lists${areListsOpen ? "" : " folded"}`}>
      <Region studio={studio} name="messages" title="region_messages" fold={folds.messages}><Messages studio={studio} /></Region>
      {isOpen(studio, folds.messages) && isOpen(studio, folds.cycle) && between(SIZES.cycle, "vertical", -1)}
      <Region studio={studio} name="cycle" title="region_cycle" fold={folds.cycle}><Cycle studio={studio} /></Region>
    </div>
  );

  // The order in the document is that on the screen, for keyboards and screen readers; panes are moved, not made again.
  const orders: { readonly [name in Layout]: ComponentChildren[] } = {
    wide: [
      left, between(SIZES.left, "vertical", 1), robot, between(SIZES.right, "vertical", -1), right,
      between(SIZES.time, "horizontal", -1), time, areListsOpen ? between(SIZES.lists, "horizontal", -1) : null, lists,
    ],
    medium: [left, between(SIZES.left, "vertical", 1), robot, between(SIZES.time, "horizontal", -1), time, right, lists],
    narrow: [robot, time, left, right, lists],
  };
  const share = Object.entries(SIZES).map(([name, size]) => [`--${name}`, percent(sizeOf(studio, size))]);
  return (
    <main class={areListsOpen ? "" : "lists-folded"} style={Object.fromEntries(share)} aria-label={text("product")}>
      {orders[layout]}
    </main>
  );
}

function ProblemBadge({ studio }: { studio: Studio }) {
  const count = problemCount(studio);
  return count === "" ? null : <span class="badge">{count}</span>;
}
