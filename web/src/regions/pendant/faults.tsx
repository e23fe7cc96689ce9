/** What goes wrong with a simulated robot on this computer, by the words of `elitescript ctl`. */

import { TypedField } from "../../app/typed.tsx";
import type { PendantModel } from "../../model/pendant.ts";
import type { Texts } from "../../text/en.ts";
import { text } from "../../text/text.ts";

const VERBS: readonly (readonly [keyof Texts, string])[] = [
  ["fault_protective", "protective"], ["fault_violation", "violation"], ["fault_fault", "fault"], ["fault_restart", "restart"],
];

export function Faults({ pendant }: { pendant: PendantModel }) {
  const disturb = (typed: string) => {
    const words = typed.split(/\s+/).filter(Boolean);
    if (words.length > 0) void pendant.fault(words[0] === "disturb" ? words : ["disturb", ...words]);
    return "";
  };
  return (
    <details class="faults">
      <summary>{text("faults")}</summary>
      <div class="pendant-row">
        <button type="button" onClick={() => void pendant.press("safeguard_open")}>{text("safeguard_open")}</button>
        <button type="button" onClick={() => void pendant.press("safeguard_close")}>{text("safeguard_close")}</button>
        {VERBS.map(([key, verb]) => <button key={verb} type="button" onClick={() => void pendant.fault([verb])}>{text(key)}</button>)}
      </div>
      <TypedField label={text("fault_words")} value="" placeholder={text("fault_words")} take={disturb} class="long" />
    </details>
  );
}
