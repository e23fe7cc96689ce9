/** Options of the run, and how the page looks. Everything is typed or chosen in place. */

import { signal, useSignal } from "@preact/signals";
import type { ComponentChildren } from "preact";
import { useEffect } from "preact/hooks";
import { LIMIT_S, type Studio } from "../model/studio.ts";
import { format, parse, parseList, UnitError, type Quantity } from "../model/units.ts";
import type { Six } from "../source/messages.ts";
import type { Results } from "../source/services.ts";
import { theme, type Theme } from "../style/palette.ts";
import { chosenLanguage, language, type Language } from "../text/language.ts";
import { text } from "../text/text.ts";
import { Icon } from "./icons.tsx";
import { TypedField } from "./typed.tsx";

export const areOptionsOpen = signal(false);

const NOTHING_KNOWN: Results["robots"] = { robots: [], firmwares: [], defaults: { robot: "", firmware: "" } };

/** What the run is of: the arm, its firmware, its world. */
export function chosenInWords(studio: Studio): string {
  const options = studio.options.value;
  const robot = options.robot ?? studio.run.value?.options.robot ?? studio.scene.value?.robot ?? "";
  const parts = [text("mode_live"), robot, options.firmware ?? studio.run.value?.options.firmware ?? "", options.world ?? ""];
  return parts.filter(Boolean).join(" · ");
}

export function OptionsPanel({ studio }: { studio: Studio }) {
  const known = useSignal(NOTHING_KNOWN);
  const isShown = areOptionsOpen.value;
  const canAsk = studio.can("services");
  useEffect(() => {
    if (!isShown || !canAsk) return;
    studio.ask("robots").then((found) => {
      if (found !== null) known.value = { ...NOTHING_KNOWN, ...found };
    }, (error: unknown) => studio.notice("warning", String(error)));
  }, [isShown, canAsk]);
  if (!isShown) return null;
  const options = studio.options.value;
  const inForce = studio.run.value?.options ?? {};
  const canRun = studio.can("edit");
  const { robots, firmwares, defaults } = known.value;
  const chosen = (name: "robot" | "firmware" | "world") => ({
    value: options[name] ?? "",
    take: (typed: string) => {
      studio.setOptions({ [name]: typed === "" ? undefined : typed });
      return "";
    },
  });
  const quantity = (of: Quantity, take: (value: number) => void) => (typed: string) => {
    try {
      take(parse(typed, of, studio.display.value));
      return "";
    } catch (error) {
      return refusal(error);
    }
  };
  const joints = (typed: string) => {
    if (typed === "") {
      studio.setOptions({ joints: undefined });
      return "";
    }
    try {
      const values = parseList(typed, "angle", studio.display.value);
      if (values.length !== 6) return text("joints_six", { count: values.length });
      studio.setOptions({ joints: values as unknown as Six });
      return "";
    } catch (error) {
      return refusal(error);
    }
  };
  const until_s = options.until_s ?? inForce.until_s ?? LIMIT_S;
  return (
    <aside class="options" aria-label={text("options_title")}>
      {canRun && (
        <>
          <Field label={text("option_robot")}>
            <TypedField label={text("option_robot")} {...chosen("robot")} placeholder={inForce.robot || defaults.robot} list="robots" />
            <datalist id="robots">{robots.map(({ name }) => <option key={name} value={name} />)}</datalist>
          </Field>
          <Field label={text("option_firmware")}>
            <TypedField label={text("option_firmware")} {...chosen("firmware")} placeholder={inForce.firmware || defaults.firmware} list="firmwares" />
            <datalist id="firmwares">{firmwares.map((name) => <option key={name} value={name} />)}</datalist>
          </Field>
          <Field label={text("option_world")}>
            <TypedField label={text("option_world")} {...chosen("world")} placeholder={inForce.world || text("option_none")} />
          </Field>
          <Field label={text("option_limit")}>
            <TypedField
              label={text("option_limit")} value={`${Number(until_s.toFixed(3))} s`} class="short"
              take={quantity("time", (value) => studio.setOptions({ until_s: value }))}
            />
          </Field>
          <Field label={text("option_joints")}>
            <TypedField
              label={text("option_joints")} class="long" placeholder={text("option_default")} take={joints}
              value={options.joints === undefined ? "" : `${options.joints.map((q) => format(q, "angle", studio.display.value)).join(", ")} ${studio.display.value.angle}`}
            />
          </Field>
          <Field label={text("option_seed")}>
            <TypedField
              label={text("option_seed")} class="short" placeholder={String(inForce.seed ?? 0)} value={options.seed === undefined ? "" : String(options.seed)}
              take={(typed) => {
                if (typed !== "" && !/^\d+$/.test(typed)) return text("seed_whole");
                studio.setOptions({ seed: typed === "" ? undefined : Number(typed) });
                return "";
              }}
            />
          </Field>
          <span class="tools">
            <button type="button" class="tool" aria-label={text("undo")} title={text("undo_hint")} disabled={!studio.canUndo.value} onClick={() => studio.undo()}><Icon name="undo" /></button>
            <button type="button" class="tool" aria-label={text("redo")} title={text("redo_hint")} disabled={!studio.canRedo.value} onClick={() => studio.redo()}><Icon name="redo" /></button>
          </span>
        </>
      )}
      <Look />
      <button type="button" class="tool plain" aria-label={text("close")} title={text("close")} onClick={() => (areOptionsOpen.value = false)}><Icon name="close" /></button>
    </aside>
  );
}

/** Colours and language. */
function Look() {
  return (
    <>
      <Field label={text("theme")}>
        <select aria-label={text("theme")} value={theme.value} onChange={(event) => (theme.value = event.currentTarget.value as Theme)}>
          <option value="system">{text("theme_system")}</option>
          <option value="light">{text("theme_light")}</option>
          <option value="dark">{text("theme_dark")}</option>
        </select>
      </Field>
      <Field label={text("language")}>
        <select aria-label={text("language")} value={language.value} onChange={(event) => (chosenLanguage.value = event.currentTarget.value as Language)}>
          <option value="en" lang="en">English</option>
          <option value="zh" lang="zh">中文</option>
        </select>
      </Field>
    </>
  );
}

function Field({ label, children }: { label: string; children: ComponentChildren }) {
  return (
    <span class="field">
      <span class="label" aria-hidden="true">{label}</span>
      {children}
    </span>
  );
}

function refusal(error: unknown): string {
  if (error instanceof UnitError) return error.message;
  throw error;
}
