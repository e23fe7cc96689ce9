/** The list of keys, shown by `?`. */

import { useEffect, useRef } from "preact/hooks";
import { text } from "../text/text.ts";
import { Icon } from "./icons.tsx";
import { isHelpOpen, KEYS, OTHER_KEYS } from "./keys.ts";

const NAMES: { readonly [key: string]: string } = { " ": "Space", f: "F" };

const IS_MAC = typeof navigator !== "undefined" && /Mac|iPhone|iPad/.test(navigator.platform);

function name(key: string): string {
  return NAMES[key] ?? key.replace("Mod+", IS_MAC ? "⌘ " : "Ctrl ").replace("Shift+", "Shift ").replace(/ ([a-z])$/, (found) => found.toUpperCase());
}

export function Help() {
  const close = useRef<HTMLButtonElement>(null);
  useEffect(() => {
    if (isHelpOpen.value) close.current?.focus();
  }, [isHelpOpen.value]);
  if (!isHelpOpen.value) return null;
  const leave = () => (isHelpOpen.value = false);
  return (
    <aside class="help" aria-label={text("help_title")}>
      <header>
        <h2>{text("help_title")}</h2>
        <button type="button" class="plain" ref={close} aria-label={text("close")} title={text("close")} onClick={leave}>
          <Icon name="close" />
        </button>
      </header>
      <dl>
        {KEYS.map((key) => (
          <div key={key.key}>
            <dt><kbd>{name(key.key)}</kbd></dt>
            <dd>{text(key.meaning)}</dd>
          </div>
        ))}
        {OTHER_KEYS.map(([keys, meaning]) => (
          <div key={keys}>
            <dt>{keys.split(/,? /).map((key) => <kbd key={key}>{key}</kbd>)}</dt>
            <dd>{text(meaning)}</dd>
          </div>
        ))}
      </dl>
    </aside>
  );
}
