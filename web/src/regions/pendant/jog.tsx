/** Jogging, hand guiding and teaching: buttons that move the arm while they are held, by pointer or by keyboard. */

import { useRef } from "preact/hooks";
import type { Axis, Frame, PendantModel } from "../../model/pendant.ts";
import type { Studio } from "../../model/studio.ts";
import { format, unitOf, type Quantity } from "../../model/units.ts";
import { text } from "../../text/text.ts";

const AXES: readonly Axis[] = [0, 1, 2, 3, 4, 5];
const NAMES = ["X", "Y", "Z", "RX", "RY", "RZ"] as const;
const FRAMES = ["joint", "base", "tool"] as const satisfies readonly Frame[];

export function Jog({ studio, pendant }: { studio: Studio; pendant: PendantModel }) {
  const frame = pendant.frame.value;
  const moment = studio.present.value;
  const values = frame === "joint" ? moment?.joints : moment?.tcp_pose;
  const units = frame === "joint" ? unitOf("angle", studio.display.value) : `${unitOf("length", studio.display.value)}, ${unitOf("angle", studio.display.value)}`;
  const percent = Math.round(pendant.speed.value * 100);
  const choose = (chosen: Frame) => {
    pendant.release();
    pendant.frame.value = chosen;
  };
  return (
    <div class="jog" role="group" aria-label={text("jog")} title={text("jog_hint")}>
      <div class="pendant-row">
        <div class="jog-frames" role="radiogroup" aria-label={text("jog_frame")}>
          {FRAMES.map((name) => (
            <label key={name}>
              <input type="radio" name="jog-frame" checked={frame === name} onChange={() => choose(name)} /> {text(`frame_${name}`)}
            </label>
          ))}
          <span class="faint">{units}</span>
        </div>
        <label class="pendant-slider">
          <span class="faint">{text("jog_speed")}</span>
          <input
            type="range" min="2" max="100" step="1" value={String(percent)} aria-label={text("jog_speed")} aria-valuetext={`${percent} %`}
            onInput={(event) => (pendant.speed.value = Number(event.currentTarget.value) / 100)}
          />
          <output>{percent} %</output>
        </label>
      </div>
      <div class="jog-axes">
        {AXES.map((axis) => {
          const quantity: Quantity = frame === "joint" || axis > 2 ? "angle" : "length";
          const name = frame === "joint" ? `J${axis + 1}` : NAMES[axis]!;
          const value = values === undefined ? "" : format(values[axis]!, quantity, studio.display.value);
          return (
            <div class="jog-axis" key={axis}>
              <HoldButton pendant={pendant} axis={axis} direction={-1} />
              <span class="jog-place"><span class="faint">{name}</span> <output>{value}</output></span>
              <HoldButton pendant={pendant} axis={axis} direction={1} />
            </div>
          );
        })}
      </div>
      <div class="pendant-row jog-more">
        <button
          type="button" class={pendant.isGuiding.value ? "on" : ""} aria-pressed={pendant.isGuiding.value} title={text("freedrive_hint")}
          onClick={() => void pendant.guide(!pendant.isGuiding.value)}
        >
          {text("freedrive")}
        </button>
        {studio.can("edit") && <button type="button" title={text("teach_hint")} onClick={() => pendant.teach()}>{text("teach")}</button>}
      </div>
    </div>
  );
}

function HoldButton({ pendant, axis, direction }: { pendant: PendantModel; axis: Axis; direction: 1 | -1 }) {
  const key = useRef<string | null>(null);
  const frame = pendant.frame.value;
  // Asked again at each event: what was drawn may be older than what is held.
  const isHeld = () => {
    const held = pendant.held.value;
    return held !== null && held.axis === axis && held.direction === direction;
  };
  const isOn = isHeld();
  const sign = text(direction === 1 ? "plus" : "minus");
  const label = frame === "joint" ? text("jog_joint", { axis: axis + 1, sign }) : text("jog_axis", { axis: NAMES[axis]!, sign });
  const release = () => {
    key.current = null;
    if (isHeld()) pendant.release();
  };
  return (
    <button
      type="button" class={isOn ? "jog-hold on" : "jog-hold"} aria-label={label} aria-pressed={isOn}
      onPointerDown={(event) => {
        if (event.button !== 0) return;
        event.currentTarget.setPointerCapture(event.pointerId);
        pendant.hold({ frame, axis, direction });
      }}
      onPointerUp={release} onPointerCancel={release} onLostPointerCapture={release} onBlur={release}
      onPointerMove={(event) => {
        // While another button of the mouse is down, letting go of the first one is a move.
        if (key.current === null && (event.buttons & 1) === 0) release();
      }}
      onContextMenu={(event) => event.preventDefault()}
      onKeyDown={(event) => {
        if (event.key !== " " && event.key !== "Enter") {
          if (isHeld()) pendant.release();
          return;
        }
        event.preventDefault();
        event.stopPropagation();
        if (event.repeat || key.current !== null) return;
        key.current = event.key;
        pendant.hold({ frame, axis, direction });
      }}
      onKeyUp={(event) => {
        if (event.key === key.current) release();
      }}
    >
      <span aria-hidden="true">{direction === 1 ? "+" : "−"}</span>
    </button>
  );
}
