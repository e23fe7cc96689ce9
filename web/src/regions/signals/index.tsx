/** Region `Signals`: values at the cursor and at the time that is pointed at; inputs are set from the cursor's time on. */

import { useSignal } from "@preact/signals";
import { useEffect } from "preact/hooks";
import { Icon } from "../../app/icons.tsx";
import { Rows } from "../../app/rows.tsx";
import { TypedField } from "../../app/typed.tsx";
import { familyOf, hasSlider, inputNames, readValue, shownNames, valueAt } from "../../model/points.ts";
import { lastAtOrBefore, type Run } from "../../model/run.ts";
import type { Studio } from "../../model/studio.ts";
import { seconds } from "../../model/units.ts";
import type { Value } from "../../source/messages.ts";
import type { SignalFamily } from "../../source/services.ts";
import { text } from "../../text/text.ts";

const REGION = "signals";

export function Signals({ studio }: { studio: Studio }) {
  const families = useSignal<readonly SignalFamily[]>([]);
  const pinned = useSignal<readonly string[]>([]);
  const canAsk = studio.can("services");
  useEffect(() => {
    if (!canAsk) return;
    studio.ask("signals").then((found) => (families.value = found ?? []), (error: unknown) => studio.notice("warning", text("no_signals", { why: String(error) })));
  }, [canAsk]);

  const isLive = studio.can("live");
  const canSet = studio.can("inputs") || studio.can("signals");
  const run = studio.runAt(studio.cursor.value);
  void run?.revision.value;
  const moment = studio.moment.value;
  const exact = isLive || studio.isExact.value ? moment : null;
  const names = shownNames(run, moment, studio.options.value, pinned.value, families.value);
  const hover = studio.hover.value;
  // A row of this list points at a time itself: a further column would move what is under the pointer.
  const hoverTime = hover === null || hover.region === REGION ? undefined : hover.t;
  const inputs = families.value.length > 0 ? inputNames(families.value) : [];

  return (
    <div class="signals-body">
      {canSet && inputs.length > 0 && (
        <div class="signals-bar">
          <TypedField
            label={text("signal_add")} value="" placeholder={text("signal_add")} list="inputs" class="long"
            take={(name) => {
              if (name === "") return "";
              if (!inputs.includes(name)) return text("signal_unknown", { name });
              if (!pinned.value.includes(name)) pinned.value = [...pinned.value, name];
              return "";
            }}
          />
          <datalist id="inputs">{inputs.map((name) => <option key={name} value={name} />)}</datalist>
        </div>
      )}
      <Schedule studio={studio} />
      {names.length === 0 ? (
        <p class="empty">{text(moment === null && run === null ? "nothing_yet" : "signals_default")}</p>
      ) : (
        <Rows
          count={names.length} label={text("rows_of_signals")} class="signals-table" keyOf={(index) => names[index]!}
          head={
            <tr>
              <th scope="col">{text("signal")}</th>
              <th scope="col">{text("value")}</th>
              {hoverTime !== undefined && <th scope="col" class="number">{seconds(hoverTime)}</th>}
            </tr>
          }
          attributes={(index) => ({
            onPointerEnter: () => point(studio, run, names[index]!),
            onPointerLeave: () => studio.point(null),
          })}
          row={(index) => {
            const name = names[index]!;
            const family = familyOf(families.value, name);
            const value = valueAt(name, studio.cursor.value, run, exact, families.value);
            return (
              <>
                <th scope="row" title={family?.summary ?? name}><Name studio={studio} name={name} run={run} /></th>
                <td class="value">
                  {canSet && family?.is_input === true ? <Control studio={studio} name={name} family={family} value={value} /> : <Shown value={value} family={family} />}
                </td>
                {hoverTime !== undefined && <td class="number faint"><Shown value={valueAt(name, hoverTime, run, null, families.value)} family={family} /></td>}
              </>
            );
          }}
        />
      )}
    </div>
  );
}

/** Points at the change that has given a signal its value, or at its first one. */
function point(studio: Studio, run: Run | null, name: string): void {
  const changes = run?.signals.get(name);
  if (changes === undefined) return;
  const index = Math.max(lastAtOrBefore(changes.t, studio.cursor.value), 0);
  const line = changes.line[index]!;
  studio.point({ region: REGION, t: changes.t[index]!, ...(line > 0 ? { line } : {}) });
}

/** The name of a signal; a click goes to its next change, after the last to its first. */
function Name({ studio, name, run }: { studio: Studio; name: string; run: Run | null }) {
  const changes = run?.signals.get(name);
  if (changes === undefined) return <>{name}</>;
  const next = () => {
    const after = lastAtOrBefore(changes.t, studio.cursor.value) + 1;
    const index = after < changes.t.length ? after : 0;
    studio.jump(changes.t[index]!, { line: changes.line[index]!, column: 1 });
  };
  return <button type="button" class="place" title={text("next_change", { name })} onClick={next} onFocus={() => point(studio, run, name)} onBlur={() => studio.point(null)}>{name}</button>;
}

function Shown({ value, family }: { value: Value | undefined; family: SignalFamily | null }) {
  if (typeof value === "boolean") return <span class={value ? "level high" : "level"}>{value ? "1" : "0"}<span class="unseen"> {String(value)}</span></span>;
  return <span>{inWords(value, family)}</span>;
}

function Control({ studio, name, family, value }: { studio: Studio; name: string; family: SignalFamily; value: Value | undefined }) {
  const set = (to: Value) => studio.setInput(name, to);
  if (family.kind === "bool") {
    return (
      <button type="button" class="switch" role="switch" aria-checked={value === true} aria-label={name} onClick={() => set(value !== true)}>
        <span class="knob" aria-hidden="true" />
        <span class="level">{value === true ? "1" : "0"}</span>
      </button>
    );
  }
  const number = typeof value === "number" ? value : Number(family.default);
  return (
    <span class="analog">
      {hasSlider(family) && (
        <input
          type="range" aria-label={text("slider_of", { name })} min={family.low!} max={family.high!} step={family.kind === "int" ? 1 : (family.high! - family.low!) / 200}
          value={number} aria-valuetext={inWords(number, family)} onInput={(event) => set(Number(event.currentTarget.value))}
        />
      )}
      <TypedField
        label={name} value={inWords(number, family)} class="short"
        take={(typed) => {
          const read = readValue(family, typed);
          if (read === null) return text(family.low === null ? "value_number" : "value_range", { low: family.low ?? "", high: family.high ?? "", unit: family.unit });
          set(read);
          return "";
        }}
      />
    </span>
  );
}

/** Inputs that were set, as chips: a click goes to their time. */
function Schedule({ studio }: { studio: Studio }) {
  const inputs = studio.options.value.inputs ?? [];
  if (inputs.length === 0) return null;
  return (
    <ul class="chips" aria-label={text("inputs_set")}>
      {inputs.map((input, index) => {
        const words = text("input_from", { name: input.name, value: String(input.value), t: seconds(input.at_s) });
        return (
          <li key={`${input.name} ${input.at_s}`} class="chip">
            <button type="button" class="place" onClick={() => studio.jump(input.at_s)}>{words}</button>
            <button type="button" class="plain" aria-label={text("input_remove", { what: words })} title={text("input_remove", { what: words })} onClick={() => studio.removeInput(index)}>
              <Icon name="close" />
            </button>
          </li>
        );
      })}
    </ul>
  );
}

function inWords(value: Value | undefined, family: SignalFamily | null): string {
  if (value === undefined) return "";
  const shown = typeof value === "number" && !Number.isInteger(value) ? String(Number(value.toPrecision(6))) : String(value);
  // Families of several units, such as "V or A", do not say which one this signal has.
  return family === null || family.unit === "" || /,| or /.test(family.unit) ? shown : `${shown} ${family.unit}`;
}
