/** A field for a value that is typed: taken with Enter or when it is left, set back with Escape, with the reason where it is refused. */

import { useSignal } from "@preact/signals";
import { useId } from "preact/hooks";

interface Props {
  readonly label: string;
  /** As it is now; shown while nothing is typed. */
  readonly value: string;
  /** Takes what was typed; returns why not, or "". */
  readonly take: (typed: string) => string;
  readonly placeholder?: string;
  readonly list?: string;
  readonly class?: string;
  readonly isDisabled?: boolean;
}

export function TypedField({ label, value, take, placeholder = "", list, class: kind = "", isDisabled = false }: Props) {
  const typed = useSignal<string | null>(null);
  const refusal = useSignal("");
  const id = useId();
  const settle = () => {
    if (typed.value === null) return;
    const why = typed.value.trim() === value ? "" : take(typed.value.trim());
    refusal.value = why;
    if (why === "") typed.value = null;
  };
  return (
    <span class={`typed ${kind}`}>
      <input
        type="text" aria-label={label} value={typed.value ?? value} placeholder={placeholder} disabled={isDisabled} spellcheck={false} autocomplete="off"
        {...(list === undefined ? {} : { list })}
        {...(refusal.value === "" ? {} : { "aria-invalid": true, "aria-describedby": id })}
        onFocus={(event) => event.currentTarget.select()}
        onInput={(event) => (typed.value = event.currentTarget.value)}
        onChange={settle}
        onKeyDown={(event) => {
          if (event.key === "Enter") settle();
          else if (event.key === "Escape") {
            typed.value = null;
            refusal.value = "";
          } else return;
          event.stopPropagation();
        }}
      />
      {refusal.value !== "" && <span class="refusal" id={id} role="alert">{refusal.value}</span>}
    </span>
  );
}
