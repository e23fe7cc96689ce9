/** A border between two panes that can be dragged, and moved with arrow keys; double click and Home set it back. */

import type { TargetedKeyboardEvent, TargetedPointerEvent } from "preact";
import type { Studio } from "../model/studio.ts";
import { text } from "../text/text.ts";
import type { Texts } from "../text/en.ts";

/** A size as a fraction of the box around both panes. */
export interface Size {
  readonly name: string;
  readonly first: number;
  readonly least: number;
  readonly most: number;
  readonly title: keyof Texts;
}

const STEP = 0.02;

export function sizeOf(studio: Studio, size: Size): number {
  return Math.min(Math.max(studio.settings.sizes.value[size.name] ?? size.first, size.least), size.most);
}

interface Props {
  readonly studio: Studio;
  readonly size: Size;
  /** `vertical`: a line from top to bottom. */
  readonly orientation: "vertical" | "horizontal";
  /** 1 if the pane of this size is before the divider, -1 if it is after it. */
  readonly side: 1 | -1;
}

export function Divider({ studio, size, orientation, side }: Props) {
  const value = sizeOf(studio, size);
  const set = (to: number) => {
    const kept = Math.round(1000 * Math.min(Math.max(to, size.least), size.most)) / 1000;
    studio.settings.sizes.value = { ...studio.settings.sizes.value, [size.name]: kept };
  };
  const drag = (event: TargetedPointerEvent<HTMLDivElement>) => {
    const bar = event.currentTarget;
    const box = bar.parentElement!.getBoundingClientRect();
    const position = (at: PointerEvent) => (orientation === "vertical" ? at.clientX / box.width : at.clientY / box.height);
    const begin = position(event);
    event.preventDefault();
    bar.focus();
    bar.setPointerCapture(event.pointerId);
    const move = (at: PointerEvent) => set(value + side * (position(at) - begin));
    bar.addEventListener("pointermove", move);
    bar.addEventListener("lostpointercapture", () => bar.removeEventListener("pointermove", move), { once: true });
  };
  const press = (event: TargetedKeyboardEvent<HTMLDivElement>) => {
    const [less, more] = orientation === "vertical" ? ["ArrowLeft", "ArrowRight"] : ["ArrowUp", "ArrowDown"];
    if (event.key === less) set(value - side * STEP);
    else if (event.key === more) set(value + side * STEP);
    else if (event.key === "Home") set(size.first);
    else return;
    event.preventDefault();
  };
  return (
    <div
      class={`divider ${orientation}`} role="separator" tabIndex={0} aria-orientation={orientation}
      aria-label={text("divider", { name: text(size.title) })}
      aria-valuenow={Math.round(100 * value)} aria-valuemin={Math.round(100 * size.least)} aria-valuemax={Math.round(100 * size.most)}
      onPointerDown={drag} onKeyDown={press} onDblClick={() => set(size.first)}
    />
  );
}
