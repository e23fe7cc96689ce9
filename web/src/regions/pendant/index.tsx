/** Region `Pendant`: the state of a controller, and with control everything that commands it. It is no safety device. */

import type { ComponentChildren } from "preact";
import { useEffect, useMemo } from "preact/hooks";
import { TypedField } from "../../app/typed.tsx";
import { nextStep, PendantModel } from "../../model/pendant.ts";
import type { Studio } from "../../model/studio.ts";
import type { ControlAction, ControllerState } from "../../source/messages.ts";
import type { Texts } from "../../text/en.ts";
import { text } from "../../text/text.ts";
import { Faults } from "./faults.tsx";
import { Jog } from "./jog.tsx";
import "./pendant.css";

export function Pendant({ studio }: { studio: Studio }) {
  const pendant = useMemo(() => new PendantModel(studio), [studio]);
  useEffect(() => {
    // A release that is lost with the page or its focus must not leave the arm moving until the hold runs out.
    const release = () => pendant.release();
    const hide = () => document.hidden && pendant.release();
    window.addEventListener("blur", release);
    window.addEventListener("pagehide", release);
    document.addEventListener("visibilitychange", hide);
    return () => {
      release();
      window.removeEventListener("blur", release);
      window.removeEventListener("pagehide", release);
      document.removeEventListener("visibilitychange", hide);
    };
  }, [pendant]);
  const state = studio.controller.value;
  useEffect(() => {
    if (state !== null) pendant.observe(state);
  }, [pendant, state]);
  const hasControl = studio.can("control");
  if (state === null) return <p class="empty">{text("pendant_waiting", { address: studio.hello.value?.title ?? "" })}</p>;
  return (
    <div class="pendant-body">
      <StateLine state={state} />
      {!hasControl && <p class="faint">{text("pendant_read_only")}</p>}
      {hasControl && <Buttons studio={studio} pendant={pendant} state={state} />}
      {state.popup !== undefined && <PopupWindow state={state} pendant={pendant} hasControl={hasControl} />}
      {hasControl && <Jog studio={studio} pendant={pendant} />}
      {studio.can("faults") && <Faults pendant={pendant} />}
    </div>
  );
}

/** Modes in words, each with a mark that is not only a colour. */
function StateLine({ state }: { state: ControllerState }) {
  if (state.link !== "connected") {
    return <p class="pendant-lost" role="status"><span class="dot warning" aria-hidden="true" />{text(state.link === "lost" ? "pendant_lost" : "pendant_waiting", { address: state.address })}</p>;
  }
  const isSafe = state.safety_mode === "NORMAL" || state.safety_mode === "REDUCED";
  const parts: readonly (readonly [keyof Texts, string, string])[] = [
    ["robot_mode", state.robot_mode, state.robot_mode === "RUNNING" ? "good" : "none"],
    ["safety_mode", state.safety_mode, isSafe ? "good" : "error"],
    ["task_state", state.task_state, state.task_state === "PLAYING" ? "good" : state.task_state === "PAUSED" ? "warning" : "none"],
  ];
  return (
    <dl class="pendant-state" aria-label={text("pendant_state")}>
      {parts.map(([key, value, kind]) => (
        <div key={key}>
          <dt class="faint">{text(key)}</dt>
          <dd><span class={`dot ${kind}`} aria-hidden="true" />{value.replaceAll("_", " ").toLowerCase()}</dd>
        </div>
      ))}
    </dl>
  );
}

const HINTS: { readonly [action in ControlAction]?: keyof Texts } = { play: "play_hint", unlock: "unlock_hint" };

function Buttons({ studio, pendant, state }: { studio: Studio; pendant: PendantModel; state: ControllerState }) {
  const next = nextStep(state);
  const isOwn = studio.can("faults");
  const isPressed = isOwn && state.safety_mode.endsWith("EMERGENCY_STOP");
  const button = (action: Extract<ControlAction, keyof Texts>) => {
    const hint = HINTS[action];
    return (
      <button
        type="button" class={next === action ? "next" : ""} aria-busy={pendant.pressed.value === action}
        title={text(hint ?? action)} onClick={() => void pendant.press(action)}
      >
        {text(action)}
      </button>
    );
  };
  const load = (program: string) => {
    void pendant.load(program);
    return "";
  };
  const percent = Math.round((pendant.chosenSpeed.value ?? state.speed_fraction) * 100);
  const emergency = text(isOwn ? "emergency_own" : "emergency_other");
  return (
    <>
      <div class="pendant-row pendant-emergencies">
        <Group>
          <button
            type="button" class={isPressed ? "emergency on" : "emergency"} aria-pressed={isOwn ? isPressed : undefined}
            aria-describedby="emergency-note" title={emergency} onClick={() => void pendant.press("emergency_stop")}
          >
            {text("emergency_stop")}
          </button>
          {isPressed && <button type="button" onClick={() => void pendant.press("emergency_stop_release")}>{text("emergency_release")}</button>}
          <span class="unseen" id="emergency-note">{emergency}</span>
          <span class="faint pendant-note" aria-hidden="true">{text("emergency_note")}</span>
        </Group>
      </div>
      <div class="pendant-row">
        <Group>{button("power_on")}{button("release_brakes")}{button("power_off")}</Group>
        <Group>{button("play")}{button("unlock")}</Group>
        <label class="pendant-slider">
          <span class="faint" aria-hidden="true">{text("speed_short")}</span>
          <input
            type="range" min="0" max="100" step="1" value={String(percent)} aria-label={text("speed_slider")} aria-valuetext={`${percent} %`}
            onInput={(event) => (pendant.chosenSpeed.value = Number(event.currentTarget.value) / 100)}
            onChange={(event) => void pendant.setSpeed(Number(event.currentTarget.value) / 100)}
          />
          <output>{percent} %</output>
        </label>
      </div>
      <div class="pendant-row">
        <Group>
          <TypedField label={text("program_loaded")} value={state.program} placeholder={text("program_none")} take={load} list="controller-programs" />
          <datalist id="controller-programs">{(studio.hello.value?.programs ?? []).map((name) => <option key={name} value={name} />)}</datalist>
          <button type="button" title={text("send_program_hint")} onClick={() => void pendant.sendProgram()}>{text("send_program")}</button>
        </Group>
      </div>
    </>
  );
}

/** The message window of the robot. Its text is that of a program: never markup. */
function PopupWindow({ state, pendant, hasControl }: { state: ControllerState; pendant: PendantModel; hasControl: boolean }) {
  const popup = state.popup!;
  const isRunning = state.task_state === "PLAYING" || state.task_state === "PAUSED";
  return (
    <div class={`pendant-popup ${popup.level}`} role="alertdialog" aria-label={popup.title || text("popup_title")} aria-describedby="popup-text" key={popup.id}>
      <strong>{popup.title || text("popup_title")}</strong>
      <p id="popup-text">{popup.text}</p>
      {hasControl && (
        <div class="pendant-row">
          <button type="button" class="next" onClick={() => void pendant.press("close_popup")}>{text("popup_continue")}</button>
          {isRunning && <button type="button" onClick={() => void pendant.press("stop").then(() => pendant.press("close_popup"))}>{text("popup_end")}</button>}
        </div>
      )}
    </div>
  );
}

function Group({ children }: { children: ComponentChildren }) {
  return <div class="pendant-group">{children}</div>;
}
