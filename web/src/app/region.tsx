/** A region: a named part of the page with a head; some can be closed, their head stays. */

import type { ComponentChildren } from "preact";
import type { Studio } from "../model/studio.ts";
import { text } from "../text/text.ts";
import type { Texts } from "../text/en.ts";
import { Icon } from "./icons.tsx";

interface Props {
  readonly studio: Studio;
  readonly name: string;
  readonly title: keyof Texts;
  readonly children: ComponentChildren;
  /** Beside the title. */
  readonly badge?: ComponentChildren;
  /** Name in the settings, and whether it is open at first; without it the region cannot be closed. */
  readonly fold?: { readonly key: string; readonly isOpen: boolean };
}

export function isOpen(studio: Studio, fold: Props["fold"]): boolean {
  return fold === undefined || (studio.settings.open.value[fold.key] ?? fold.isOpen);
}

export function Region({ studio, name, title, children, badge, fold }: Props) {
  const open = isOpen(studio, fold);
  const toggle = () => {
    if (fold !== undefined) studio.settings.open.value = { ...studio.settings.open.value, [fold.key]: !open };
  };
  return (
    <section class={`region ${name}${open ? "" : " folded"}`} aria-label={text(title)} onPointerLeave={() => studio.point(null)}>
      <header>
        <h2>
          {fold === undefined ? (
            text(title)
          ) : (
            <button type="button" class="plain fold" aria-expanded={open} onClick={toggle}>
              <Icon name={open ? "open" : "closed"} />
              {text(title)}
            </button>
          )}
        </h2>
        {badge}
      </header>
      {open && <div class="body">{children}</div>}
    </section>
  );
}
