/** What people do with a controller: buttons, hold to move, teaching points. */

import { signal } from "@preact/signals-core";
import type { ControlAction, ControllerState, Six, ToSource } from "../source/messages.ts";
import { Refused, type Request } from "./requests.ts";
import type { Studio } from "./studio.ts";

/** How often a jog is repeated while its button is held; the arm is stopped 200 ms after the last. */
export const REPEAT_MS = 50;

/** How often hand guiding is repeated while it is on; it ends 2 s after the last. */
export const GUIDE_REPEAT_MS = 500;

/** After which the speed slider shows what the controller says, whatever was asked for. */
const SETTLE_MS = 1000;

/** Digits of a taught point: 1e-5 rad are 0.02 mm at 1.8 m. */
const DIGITS = 5;

export type Frame = "joint" | "base" | "tool";
export type Axis = 0 | 1 | 2 | 3 | 4 | 5;

export interface Held {
  readonly frame: Frame;
  readonly axis: Axis;
  readonly direction: 1 | -1;
}

type Jog = Extract<ToSource, { readonly type: "jog" }>;

export class PendantModel {
  /** What is held; null if nothing is. */
  readonly held = signal<Held | null>(null);
  readonly frame = signal<Frame>("joint");
  /** Fraction of the highest jog speed. */
  readonly speed = signal(0.3);
  /** The action that waits for the controller's answer. */
  readonly pressed = signal<ControlAction | null>(null);
  readonly isGuiding = signal(false);
  /** Where the speed slider was put, 0 to 1, until the controller is there; null: where the controller is. */
  readonly chosenSpeed = signal<number | null>(null);
  private readonly studio: Studio;
  private hasGuided = false;
  private timer: ReturnType<typeof setInterval> | undefined;
  private guideTimer: ReturnType<typeof setInterval> | undefined;

  constructor(studio: Studio) {
    this.studio = studio;
  }

  /** Begins to move, until `release`. */
  hold(held: Held): void {
    if (!this.studio.can("control")) return;
    this.release();
    this.held.value = held;
    this.repeat();
    this.timer = setInterval(() => this.repeat(), REPEAT_MS);
  }

  /** Stops at once; also where nothing is held, so that whatever loses a release stops the arm too. */
  release(): void {
    clearInterval(this.timer);
    this.timer = undefined;
    if (this.held.value === null) return;
    this.held.value = null;
    this.studio.send({ type: "jog_end" });
  }

  /** Presses a button; a refusal becomes a notice. Returns whether it was done. */
  async press(action: ControlAction): Promise<boolean> {
    this.pressed.value = action;
    const isDone = await this.ask({ type: "control", ask: 0, action });
    if (this.pressed.value === action) this.pressed.value = null;
    return isDone;
  }

  async guide(isOn: boolean): Promise<void> {
    this.hasGuided = false;
    this.setGuiding((await this.press(isOn ? "freedrive_on" : "freedrive_off")) && isOn);
  }

  /** Takes the controller's state: hand guiding ends with its program, for whatever reason. */
  observe(state: ControllerState): void {
    const isRunning = state.task_state === "PLAYING";
    if (this.isGuiding.value && this.hasGuided && !isRunning) this.setGuiding(false);
    this.hasGuided = isRunning;
    if (this.chosenSpeed.value !== null && Math.abs(this.chosenSpeed.value - state.speed_fraction) < 0.005) this.chosenSpeed.value = null;
  }

  /** Moves the speed slider of the controller. */
  async setSpeed(fraction: number): Promise<boolean> {
    this.chosenSpeed.value = fraction;
    const isDone = await this.ask({ type: "speed", ask: 0, fraction });
    const settle = () => {
      if (this.chosenSpeed.value === fraction) this.chosenSpeed.value = null;
    };
    // The controller's own word follows its answer.
    if (isDone) setTimeout(settle, SETTLE_MS);
    else settle();
    return isDone;
  }

  load(program: string): Promise<boolean> {
    return this.ask({ type: "load", ask: 0, program });
  }

  /** Sends the text of the editor to the controller, which runs it. */
  sendProgram(): Promise<boolean> {
    return this.ask({ type: "send_program", ask: 0, text: this.studio.text.value });
  }

  fault(words: readonly string[]): Promise<boolean> {
    return this.ask({ type: "fault", ask: 0, words });
  }

  /** Puts a move to where the arm is below the caret's line. Returns the line, "" where nothing is known. */
  teach(): string {
    const joints = this.studio.present.value?.joints;
    if (joints === undefined || this.studio.editor === null) return "";
    const line = pointText(joints);
    this.studio.editor.insert(line);
    return line;
  }

  private setGuiding(isOn: boolean): void {
    this.isGuiding.value = isOn;
    clearInterval(this.guideTimer);
    this.guideTimer = isOn ? setInterval(() => this.keepGuiding(), GUIDE_REPEAT_MS) : undefined;
  }

  private keepGuiding(): void {
    if (this.studio.link.value === "open") this.studio.send({ type: "guiding" });
  }

  private repeat(): void {
    const held = this.held.value;
    if (held === null || this.studio.link.value !== "open") return this.release();
    const jog: Jog = { type: "jog", ...held, speed: this.speed.value };
    this.studio.send(jog);
  }

  private async ask(request: Request): Promise<boolean> {
    try {
      await this.studio.request(request);
      return true;
    } catch (error) {
      this.studio.notice(error instanceof Refused ? "warning" : "error", error instanceof Error ? error.message : String(error));
      return false;
    }
  }
}

/** Returns the line of a program that moves to joints, rad. */
export function pointText(joints: Six): string {
  return `movej([${joints.map((q) => Number(q.toFixed(DIGITS)) + 0).join(", ")}])`;
}

/** What has to be done next so that the arm can move; null if it can, or if only people at the robot can do it. */
export function nextStep(state: ControllerState): ControlAction | null {
  if (state.link !== "connected") return null;
  if (state.safety_mode === "PROTECTIVE_STOP") return "unlock";
  if (state.safety_mode !== "NORMAL" && state.safety_mode !== "REDUCED") return null;
  if (state.robot_mode === "POWER_OFF") return "power_on";
  return state.robot_mode === "IDLE" ? "release_brakes" : null;
}
