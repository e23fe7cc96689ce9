/** The region `Robot`: the arm at the cursor, its path, and what is around it. */

import { effect, untracked } from "@preact/signals";
import { useEffect, useMemo, useRef, useState } from "preact/hooks";
import { speedColour } from "../../model/path.ts";
import { RestingFrames } from "../../model/redraws.ts";
import type { Studio } from "../../model/studio.ts";
import { format, seconds, unitOf, withUnit } from "../../model/units.ts";
import type { Contact } from "../../source/messages.ts";
import { isDark } from "../../style/palette.ts";
import { said } from "../../text/said.ts";
import { text } from "../../text/text.ts";
import { Drawing } from "./drawing.ts";
import { Flat } from "./flat.ts";
import { Readout } from "./readout.tsx";
import { isSoftware, type Picture, Stage } from "./stage.ts";
import { userPieces } from "./user_meshes.ts";
import "./robot.css";

const VIEWS = ["fit", "front", "side", "top", "iso"] as const;
const TOLERANCE_PX = { mouse: 8, pen: 10, touch: 20 } as const;
/** A pointer that moves less than this between press and release has clicked, pixels. */
const CLICK_PX = 5;
const HIDDEN_PAGE_MS = 100;
/** When nothing has changed for so long, the picture is drawn once more, finely. */
const REST_MS = 400;
const TURN_RAD = Math.PI / 36;
const SHIFT = 0.04;
const ZOOM = 1.15;

export function Robot({ studio }: { studio: Studio }) {
  const canvas = useRef<HTMLCanvasElement>(null);
  const labels = useRef<HTMLDivElement>(null);
  const drawing = useMemo(() => new Drawing(studio), [studio]);
  /** Without WebGL the canvas is a new one: it has one kind of context for ever. */
  const [isFlat, setFlat] = useState(() => isSoftware() === null);
  useEffect(() => show(drawing, canvas.current!, labels.current!, isFlat, () => setFlat(true)), [drawing, isFlat]);
  const scene = studio.scene.value;
  return (
    <div class="robot-view">
      <div class="picture">
        <canvas ref={canvas} key={String(isFlat)} tabIndex={0} role="img" aria-label={inWords(drawing)} aria-description={isFlat ? "" : text("robot_keys")} />
        <div ref={labels} class="labels" aria-hidden="true" />
        <div class="views" role="toolbar" aria-label={text("robot_views")}>
          {!isFlat &&
            VIEWS.map((view) => (
              <button key={view} type="button" title={text(`robot_${view}`)} onClick={() => (studio.view.value = { to: view })}>
                {text(`robot_${view}_short`)}
              </button>
            ))}
          {!isFlat && (
            <button type="button" aria-pressed={drawing.hasReach.value} title={text("robot_reach")} onClick={() => (drawing.hasReach.value = !drawing.hasReach.value)}>
              {text("robot_reach_short")}
            </button>
          )}
        </div>
        <Legend drawing={drawing} />
        {isFlat && (
          <p class="no-webgl">
            {text("robot_no_webgl")}{" "}
            <button type="button" onClick={() => setFlat(isSoftware() === null)}>
              {text("robot_webgl_again")}
            </button>
          </p>
        )}
        {scene === null && <p class="none">{text("robot_none")}</p>}
        {drawing.meshFault.value !== "" && <p class="fault">{text("robot_mesh_fault", { why: said(drawing.meshFault.value) })}</p>}
      </div>
      {scene !== null && <Readout drawing={drawing} />}
    </div>
  );
}

/** The scale of the speed colours, and what other lines are. */
function Legend({ drawing }: { drawing: Drawing }) {
  if (drawing.path.value === null) return null;
  const { display } = drawing.studio;
  const stops = Array.from({ length: 9 }, (_, stop) => `rgb(${speedColour(stop / 8, isDark.value).join()})`);
  const end = drawing.speedEnd.value;
  return (
    <dl class="legend">
      {!drawing.isStale.value && (
        <div>
          <dt>{text("robot_speed", { unit: unitOf("speed", display.value) })}</dt>
          <dd class="scale">
            <span>0</span>
            <i style={{ background: `linear-gradient(to right, ${stops.join()})` }} />
            <span>{Number(format(end, "speed", display.value))}</span>
          </dd>
        </div>
      )}
      {(drawing.isStale.value || drawing.stale.value !== null) && <Key kind="stale" name={text("robot_stale")} />}
      {drawing.compared.value !== null && <Key kind="compared" name={text("robot_compared")} />}
      {drawing.ghosts.value.some(({ kind }) => kind === "target") && <Key kind="target" name={text("robot_target")} />}
      {drawing.ghosts.value.some(({ kind }) => kind === "asked") && <Key kind="asked" name={text("robot_asked")} />}
    </dl>
  );
}

function Key({ kind, name }: { kind: string; name: string }) {
  return (
    <div>
      <dt class={`key ${kind}`} />
      <dd>{name}</dd>
    </div>
  );
}

/** The state that the picture shows. */
function inWords(drawing: Drawing): string {
  const { studio } = drawing;
  const scene = studio.scene.value;
  if (scene === null) return text("robot_none");
  const { t } = drawing.drawn.value;
  const [x, y, z] = drawing.tcpPose.value;
  const display = studio.display.value;
  const line = studio.run.value?.lineAt(t) ?? 0;
  const words = [
    text("robot_words", {
      robot: scene.robot, t: seconds(t), x: withUnit(x, "length", display), y: withUnit(y, "length", display), z: withUnit(z, "length", display),
      joints: drawing.drawn.value.joints.map((joint) => format(joint, "angle", display)).join(", "), unit: unitOf("angle", display),
    }),
  ];
  if (line > 0) words.push(text("robot_words_line", { line }));
  for (const { kind, text: why } of drawing.ghosts.value) if (kind === "asked") words.push(text("robot_words_asked", { why }));
  const touching = drawing.contacts.value.filter(({ is_contact }) => is_contact).length;
  if (touching > 0) words.push(text("robot_words_contacts", { count: touching }));
  return words.join(" ");
}

function contactText({ first, second, distance_m, is_contact }: Contact): string {
  const millimetres = (1000 * Math.abs(distance_m)).toFixed(1);
  return text(is_contact ? "robot_contact" : "robot_closest", { first, second, millimetres });
}

// ---------------------------------------------------------------- drawing

/** Draws into a canvas whenever something has changed, until the returned function is called. */
function show(drawing: Drawing, canvas: HTMLCanvasElement, labels: HTMLElement, isFlat: boolean, fail: () => void): () => void {
  const { studio } = drawing;
  const region = canvas.closest("section");
  // Frames of a page that nobody sees do not come; what the region says of itself stays true.
  const frames = new RestingFrames(studio.typing, {
    request: (draw) => (document.hidden ? -window.setTimeout(draw, HIDDEN_PAGE_MS) : requestAnimationFrame(draw)),
    cancel: (handle) => (handle > 0 ? cancelAnimationFrame(handle) : clearTimeout(-handle)),
  });
  let pending: number | null = null;
  let rest: ReturnType<typeof setTimeout> | undefined;
  const request = () => {
    pending ??= frames.request(frame);
  };
  const made = isFlat ? new Flat(canvas, () => [text("robot_top_short"), text("robot_side_short")]) : stageOf(canvas, labels, request);
  if (made === null) {
    fail();
    return () => {};
  }
  /** The fine picture takes software long: not while keys come. */
  const refine = () => {
    const wait = studio.typing.wait(performance.now(), performance.now());
    if (wait > 0) rest = setTimeout(refine, wait);
    else if (made instanceof Stage) made.refine();
  };
  const frame = () => {
    pending = null;
    drawing.refresh();
    const picture = pictureOf(drawing);
    const { joints, t } = drawing.drawn.peek();
    if (picture !== null) {
      made.draw(picture);
      clearTimeout(rest);
      if (made instanceof Stage) rest = setTimeout(refine, REST_MS);
      if (region !== null) {
        region.dataset["joints"] = joints.join();
        region.dataset["time"] = String(t);
        if (made instanceof Stage) region.dataset["camera"] = made.eye.join();
      }
    }
  };
  const ends: (() => void)[] = [
    effect(() => {
      void drawing.growth.value;
      pictureOf(drawing);
      request();
    }),
    sized(canvas, (width, height) => {
      made.resize(width, height);
      request();
    }),
    listen(canvas, "webglcontextlost", (event) => {
      event.preventDefault();
      fail();
    }),
    listen(document, "visibilitychange", request),
    pointing(drawing, canvas, made),
    effect(() => {
      void studio.scene.value;
      // What it asks depends on the version of the text, at each of which the meshes are still the same.
      untracked(() => void userPieces(drawing));
    }),
  ];
  if (made instanceof Stage) {
    ends.push(
      effect(() => {
        const wanted = studio.view.value?.to;
        if (wanted === undefined) return;
        made.want(wanted);
        request();
      }),
      listen(canvas, "keydown", (event) => {
        if (turned(made, event as KeyboardEvent)) event.preventDefault();
      }),
      () => made.dispose(),
    );
  }
  return () => {
    if (pending !== null) frames.cancel(pending);
    clearTimeout(rest);
    for (const end of ends) end();
  };
}

function stageOf(canvas: HTMLCanvasElement, labels: HTMLElement, changed: () => void): Stage | null {
  try {
    return new Stage(canvas, labels, isSoftware() ?? true, changed);
  } catch {
    return null; // the browser refuses a context: too many of them, or the driver is blocked
  }
}

/** Everything that the picture depends on; null before the source has said which robot it is. */
function pictureOf(drawing: Drawing): Picture | null {
  const { studio } = drawing;
  const scene = studio.scene.value;
  if (scene === null) return null;
  const display = studio.display.value;
  const joint = drawing.joint.value;
  const { joints } = drawing.drawn.value;
  const angle = (value: number) => withUnit(value, "angle", display);
  return {
    scene, joints, joint, contactText,
    isDark: isDark.value,
    ghosts: drawing.ghosts.value,
    path: drawing.path.value,
    isStale: drawing.isStale.value,
    stale: drawing.stale.value,
    compared: drawing.compared.value,
    speedEnd: drawing.speedEnd.value,
    line: drawing.line.value,
    t: drawing.studio.cursor.value,
    contacts: drawing.contacts.value,
    contact: drawing.contact.value,
    jointTexts: joint === null ? ["", "", ""] : [angle(scene.limits.position_min[joint]!), `J${joint + 1} ${angle(joints[joint]!)}`, angle(scene.limits.position_max[joint]!)],
    hasReach: drawing.hasReach.value,
    pieces: drawing.pieces.value,
  };
}

function sized(canvas: HTMLCanvasElement, resized: (width: number, height: number) => void): () => void {
  const host = canvas.parentElement!;
  const observer = new ResizeObserver(() => resized(host.clientWidth, host.clientHeight));
  observer.observe(host);
  resized(host.clientWidth, host.clientHeight);
  return () => observer.disconnect();
}

function listen(target: EventTarget, type: string, take: (event: Event) => void): () => void {
  target.addEventListener(type, take);
  return () => target.removeEventListener(type, take);
}

/** Points at what is under the pointer, and goes there on a click. */
function pointing(drawing: Drawing, canvas: HTMLCanvasElement, made: Stage | Flat): () => void {
  const { studio } = drawing;
  let pressed: PointerEvent | null = null;
  const at = (event: PointerEvent) => {
    const box = canvas.getBoundingClientRect();
    const tolerance = TOLERANCE_PX[event.pointerType as keyof typeof TOLERANCE_PX] ?? TOLERANCE_PX.mouse;
    return made.at(event.clientX - box.left, event.clientY - box.top, tolerance, studio.cursor.peek());
  };
  const placeOf = (event: PointerEvent) => {
    const { path, contact, joint } = at(event);
    if (contact !== null) return { t: contact.t, line: contact.line, joint: null, contact };
    if (path !== null) return { t: path.t, line: drawing.path.peek()?.line[path.stretch] ?? 0, joint: null, contact };
    return { t: null, line: 0, joint, contact };
  };
  const leave = () => {
    drawing.pointed.value = null;
    drawing.contact.value = null;
    if (studio.hover.peek()?.region === "robot") studio.point(null);
  };
  const ends = [
    listen(canvas, "pointerdown", (event) => {
      pressed = event as PointerEvent;
      leave();
    }),
    listen(canvas, "pointermove", (event) => {
      if ((event as PointerEvent).buttons !== 0) return;
      const { t, line, joint, contact } = placeOf(event as PointerEvent);
      drawing.contact.value = contact;
      canvas.style.cursor = t === null ? "" : "pointer";
      drawing.pointed.value = joint;
      if (t !== null) studio.point({ t, ...(line > 0 ? { line } : {}), region: "robot" });
      else if (studio.hover.peek()?.region === "robot") studio.point(null);
    }),
    listen(canvas, "pointerup", (event) => {
      const { clientX, clientY, button } = event as PointerEvent;
      const isClick = pressed !== null && button === 0 && Math.hypot(clientX - pressed.clientX, clientY - pressed.clientY) < CLICK_PX;
      pressed = null;
      if (!isClick) return;
      const { t, line, joint } = placeOf(event as PointerEvent);
      if (t !== null) studio.jump(t, { line, column: 1 });
      else drawing.chosen.value = joint === drawing.chosen.peek() ? null : joint;
    }),
    listen(canvas, "pointerleave", leave),
  ];
  return () => {
    for (const end of ends) end();
  };
}

/** Turns (arrow keys), moves (with Shift) and zooms (+ and -) the view; returns whether the key was one of these. */
function turned(stage: Stage, { key, shiftKey, ctrlKey, altKey, metaKey }: KeyboardEvent): boolean {
  if (ctrlKey || altKey || metaKey) return false;
  const steps: { readonly [key: string]: readonly [number, number] } = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
  const step = steps[key];
  if (step !== undefined) {
    const [x, y] = step;
    if (shiftKey) stage.step([0, 0], [x * SHIFT, -y * SHIFT], 1);
    else stage.step([x * TURN_RAD, y * TURN_RAD], [0, 0], 1);
  } else if (key === "+" || key === "=") stage.step([0, 0], [0, 0], 1 / ZOOM);
  else if (key === "-") stage.step([0, 0], [0, 0], ZOOM);
  else return false;
  return true;
}
