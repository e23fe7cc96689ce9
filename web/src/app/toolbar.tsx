/** The buttons, the file, the state of the run, and what the page is connected to. */

import { computed } from "@preact/signals";
import { useMemo } from "preact/hooks";
import type { Studio } from "../model/studio.ts";
import type { ControllerState } from "../source/messages.ts";
import type { Texts } from "../text/en.ts";
import { text } from "../text/text.ts";
import { isCompareOpen, saveAsPage } from "./compare.tsx";
import { Icon, type IconName } from "./icons.tsx";
import { isHelpOpen } from "./keys.ts";
import { areOptionsOpen, chosenInWords } from "./options.tsx";
import { runState } from "./state.ts";
import { TypedField } from "./typed.tsx";

const RATES = [0.25, 0.5, 1, 2, 5, 10];

/** In a narrow window the buttons are a row of their own, which stays at the top. */
export function Toolbar({ studio, isNarrow }: { studio: Studio; isNarrow: boolean }) {
  const save = <SaveButton studio={studio} showsName={!isNarrow} />;
  const buttons = <Transport studio={studio} />;
  return (
    <header class="top">
      <h1 class="unseen">{text("product")}</h1>
      {isNarrow && <div class="toolbar buttons">{buttons}{save}</div>}
      <div class="toolbar">
        <FileName studio={studio} />
        {!isNarrow && save}
        {!isNarrow && buttons}
        <State studio={studio} />
        <Share studio={studio} />
        <span class="spring" />
        <Connections studio={studio} />
        <Target studio={studio} />
        <Switches studio={studio} />
      </div>
    </header>
  );
}

interface ButtonProps {
  readonly name: keyof Texts;
  readonly icon: IconName;
  readonly press: () => void;
  readonly showsName?: boolean;
  readonly isDisabled?: boolean;
  readonly class?: string;
  readonly hint?: string;
}

/** A button with an icon; its accessible name is its text. */
function Tool({ name, icon, press, showsName = false, isDisabled = false, class: kind = "", hint }: ButtonProps) {
  const label = text(name);
  return (
    <button type="button" class={`tool ${kind}`} aria-label={label} title={hint ?? label} disabled={isDisabled} onClick={press}>
      <Icon name={icon} />
      {showsName && <span class={name === "save" ? "roomy-only" : ""}>{label}</span>}
    </button>
  );
}

function FileName({ studio }: { studio: Studio }) {
  const file = studio.file.value;
  const programs = studio.hello.value?.programs ?? [];
  const canOpen = studio.can("edit") && programs.length > 1;
  const name = file?.name ?? studio.hello.value?.title ?? "";
  const open = (to: string) => {
    if (to !== "" && to !== name) void studio.open(to);
    return "";
  };
  return (
    <div class="tools file" role="group" aria-label={text("group_file")}>
      {canOpen ? (
        <>
          <TypedField label={text("file_name")} value={name} take={open} list="programs" />
          <datalist id="programs">{programs.map((program) => <option key={program} value={program} />)}</datalist>
        </>
      ) : (
        <strong class="name" title={name}>{name}</strong>
      )}
      <span class="modified" title={studio.isModified.value ? text("modified") : ""}>
        {studio.isModified.value && <><span aria-hidden="true">●</span><span class="unseen">{text("modified")}</span></>}
      </span>
    </div>
  );
}

function SaveButton({ studio, showsName }: { studio: Studio; showsName: boolean }) {
  if (!studio.can("save")) return null;
  const isTree = studio.tree.value !== null;
  return (
    <Tool
      name="save" icon="save" press={() => void studio.save()} showsName={showsName} hint={text(isTree ? "tree_is_source" : "save_hint")}
      isDisabled={studio.isSaving.value || isTree}
    />
  );
}

function Transport({ studio }: { studio: Studio }) {
  const isLive = studio.can("live");
  const isRunning = isLive ? studio.isFollowing.value : studio.isPlaying.value;
  // With control these two are the buttons of the robot; the page's own time is held by a click into the time line.
  const hasControl = studio.can("control");
  const cannotStep = studio.hello.value !== null && !studio.can("step");
  return (
    <div class="tools transport" role="group" aria-label={text("group_playback")}>
      <Tool name="step_back" icon="step_back" press={() => void studio.step(-1)} hint={text("step_back_hint")} isDisabled={cannotStep} />
      <Tool name="run" icon="run" press={() => studio.play()} showsName class={isRunning ? "primary on" : "primary"} hint={text(isLive ? "run_live_hint" : "run_hint")} />
      <Tool name="pause" icon="pause" press={() => studio.pressPause()} hint={text(hasControl ? "pause_robot_hint" : "pause_hint")} />
      <Tool name="step" icon="step" press={() => void studio.step(1)} hint={text("step_hint")} isDisabled={cannotStep} />
      <Tool name="stop" icon="stop" press={() => studio.pressStop()} hint={text(hasControl ? "stop_robot_hint" : isLive ? "run_live_hint" : "stop_hint")} />
      {!isLive && <select
        class="rate" aria-label={text("rate")} title={text("rate")} value={String(studio.rate.value)}
        onChange={(event) => (studio.rate.value = Number(event.currentTarget.value))}
      >
        {RATES.map((rate) => <option key={rate} value={String(rate)}>{rate}×</option>)}
      </select>}
    </div>
  );
}

function State({ studio }: { studio: Studio }) {
  const state = useMemo(() => computed(() => runState(studio)), [studio]).value;
  return (
    <div class="state">
      <span class={`dot ${state.kind}`} aria-hidden="true" />
      <span class={`words ${state.kind}`} title={state.text}>{state.text}</span>
      {studio.run.value?.ended?.state === "time_limit" && studio.can("edit") && !state.isStale && (
        <button type="button" onClick={() => studio.goOn()}>{text("go_on")}</button>
      )}
    </div>
  );
}

/** Another run over this one, and this one as a file. */
function Share({ studio }: { studio: Studio }) {
  if (studio.can("live") || studio.run.value === null) return null;
  const isOpen = isCompareOpen.value || studio.comparing.value !== null;
  return (
    <div class="tools" role="group" aria-label={text("group_share")}>
      <button
        type="button" class={isOpen ? "tool on" : "tool"} aria-expanded={isCompareOpen.value} title={text("compare_hint")} aria-label={text("compare_button")}
        onClick={() => (isCompareOpen.value = !isCompareOpen.value)}
      >
        <Icon name="compare" /><span class="wide-only">{text("compare_button")}</span>
      </button>
      {studio.can("record") && (
        <button type="button" class="tool" title={text("save_page_hint")} aria-label={text("save_page")} disabled={studio.isRecording.value} onClick={() => void saveAsPage(studio)}>
          <Icon name="share" /><span class="wide-only">{text("save_page")}</span>
        </button>
      )}
    </div>
  );
}

function Connections({ studio }: { studio: Studio }) {
  if (!studio.can("connect")) return null;
  const may = studio.options.value.may_connect === true;
  return (
    <button
      type="button" class={may ? "tool on" : "tool"} aria-pressed={may} aria-label={text("allow")} title={text("allow_hint")}
      onClick={() => studio.setOptions({ may_connect: may ? undefined : true })}
    >
      <Icon name="link" /><span class="roomy-only">{text("allow")}</span>
    </button>
  );
}

const LINKS: { readonly [link in ControllerState["link"]]: keyof Texts } = { connected: "link_connected", connecting: "link_connecting", lost: "link_lost_short" };

/** Which robot this is about: a simulation, a recording, or which controller. */
function Target({ studio }: { studio: Studio }) {
  const hello = studio.hello.value;
  const controller = studio.controller.value;
  if (hello === null) return <span class="target faint">{text("state_connecting")}</span>;
  if (hello.mode === "connected") {
    const link = controller?.link ?? "connecting";
    return (
      <span class={`target connected ${link}`}>
        <span class={`dot ${link === "connected" ? "good" : "warning"}`} aria-hidden="true" />
        {text("mode_connected", { what: studio.robot.value })} – {text(LINKS[link])}
      </span>
    );
  }
  if (hello.mode === "recorded") return <span class="target faint">{text("mode_recorded")}</span>;
  return <span class="target faint">{chosenInWords(studio)}</span>;
}

/** How numbers are shown, and the list of keys. */
function Switches({ studio }: { studio: Studio }) {
  const display = studio.display.value;
  const toggle = (change: Partial<typeof display>) => (studio.display.value = { ...display, ...change });
  return (
    <div class="tools switches" role="group" aria-label={text("group_display")}>
      <button type="button" class="tool unit" title={text("unit_angle")} aria-label={`${text("unit_angle")}: ${display.angle}`} onClick={() => toggle({ angle: display.angle === "deg" ? "rad" : "deg" })}>
        {display.angle}
      </button>
      <button type="button" class="tool unit" title={text("unit_length")} aria-label={`${text("unit_length")}: ${display.length}`} onClick={() => toggle({ length: display.length === "mm" ? "m" : "mm" })}>
        {display.length}
      </button>
      <button type="button" class="tool" aria-label={text("options_title")} title={text("options_hint")} aria-expanded={areOptionsOpen.value} onClick={() => (areOptionsOpen.value = !areOptionsOpen.value)}>
        <Icon name="options" />
      </button>
      <button type="button" class="tool unit" aria-label={text("help_title")} title={text("help_title")} aria-expanded={isHelpOpen.value} onClick={() => (isHelpOpen.value = !isHelpOpen.value)}>
        ?
      </button>
    </div>
  );
}
