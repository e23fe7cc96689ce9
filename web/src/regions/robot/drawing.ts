/** What the region draws, from what the page knows: the arm and ghosts of it, paths, the line whose part is thick. */

import { computed, signal } from "@preact/signals-core";
import { fromRollPitchYaw, stretchedTo, tcpFrame, toRollPitchYaw, type Transform } from "../../model/kinematics.ts";
import { after, type Path, pathOf, scaleEnd } from "../../model/path.ts";
import type { Run } from "../../model/run.ts";
import type { Studio } from "../../model/studio.ts";
import type { Contact, Scene, Six } from "../../source/messages.ts";
import type { Piece } from "./arm.ts";

/** A further arm, or only a frame where no joints are known. */
export interface Ghost {
  readonly kind: "hovered" | "asked" | "target" | "compared";
  readonly joints?: Six;
  readonly frame?: Transform;
  /** The robot that it is, if that is another one. */
  readonly scene?: Scene;
  readonly text: string;
}

/** The arm, its time, and whether both are as the source says or between two rows. */
export interface Drawn {
  readonly t: number;
  readonly joints: Six;
  readonly tcp_pose?: Six;
  readonly isExact: boolean;
}

/** Length of the trail of a robot that moves by itself, s. */
const TRAIL_S = 60;

/** Arms nearer to each other than this look the same: no ghost, rad. */
const SAME_RAD = 0.002;

const UPRIGHT: Six = [0, -Math.PI / 2, 0, -Math.PI / 2, 0, 0];

export class Drawing {
  /** Joint whose limits are drawn, from 0: of the pointer, else the chosen one. */
  readonly pointed = signal<number | null>(null);
  readonly chosen = signal<number | null>(null);
  /** Contact or closest distance that is pointed at. */
  readonly contact = signal<Contact | null>(null);
  readonly hasReach = signal(false);
  /** The user's own meshes, and why they are not drawn. */
  readonly pieces = signal<readonly Piece[] | null>(null);
  readonly meshFault = signal("");
  /** Raised before a frame if a run has grown: paths are made anew once for a frame, not for each message. */
  private readonly grown = signal(0);
  private seen = "";
  readonly studio: Studio;

  constructor(studio: Studio) {
    this.studio = studio;
  }

  readonly joint = computed(() => this.pointed.value ?? this.chosen.value);

  readonly drawn = computed((): Drawn => {
    const { studio } = this;
    const t = studio.cursor.value;
    const moment = studio.moment.value;
    if (moment !== null && studio.isExact.value) return { t, joints: moment.joints, tcp_pose: moment.tcp_pose, isExact: true };
    const run = studio.runAt(t);
    void run?.revision.value;
    const joints = run?.samples.joints(t) ?? moment?.joints ?? studio.options.value.joints ?? UPRIGHT;
    return { t, joints, isExact: false };
  });

  /** Pose of the TCP: as the source says, else by the kinematics. */
  readonly tcpPose = computed((): Six => {
    const { joints, tcp_pose } = this.drawn.value;
    const scene = this.studio.scene.value;
    return tcp_pose ?? (scene === null ? [0, 0, 0, 0, 0, 0] : toRollPitchYaw(tcpFrame(scene, joints)));
  });

  readonly path = computed(() => {
    const run = this.studio.run.value;
    return this.whole(run, this.studio.can("live") ? (run?.samples.end_s ?? 0) - TRAIL_S : 0);
  });

  /** The rest of the run before, while the newest is not that far. */
  readonly stale = computed((): Path | null => {
    const run = this.studio.run.value;
    const before = this.studio.before.value;
    void this.grown.value;
    if (run === null || before === null || run.ended !== null || before.known_s <= run.known_s) return null;
    const path = this.whole(before);
    return path === null ? null : after(path, run.known_s);
  });

  /** Whether all of the path is of an earlier text. */
  readonly isStale = computed(() => this.studio.staleFrom.value > 0);

  readonly compared = computed(() => this.whole(this.studio.compared.value));

  readonly speedEnd = computed(() => scaleEnd(Math.max(this.path.value?.speed_max ?? 0, this.compared.value?.speed_max ?? 0)));

  readonly contacts = computed((): readonly Contact[] => {
    const run = this.studio.run.value;
    void run?.revision.value;
    return (run?.contacts ?? []).filter(({ points }) => points !== undefined);
  });

  /** Line whose part of the path is thick: what is pointed at, else that of the cursor. */
  readonly line = computed((): number => {
    const hover = this.studio.hover.value;
    const run = this.studio.run.value;
    void run?.revision.value;
    if (hover?.line !== undefined) return hover.line;
    return run?.lineAt(hover?.t ?? this.studio.cursor.value) ?? 0;
  });

  /** The arm that an alarm asked for; of a pose the arm near to it, stretched where it is out of reach. */
  private readonly toward = computed((): Six | null => {
    const alarm = this.studio.run.value?.alarm;
    void this.studio.run.value?.revision.value;
    const scene = this.studio.scene.value;
    if (alarm == null || scene === null) return null;
    if (alarm.asked_joints !== undefined || alarm.asked_pose === undefined) return alarm.asked_joints ?? null;
    const [x, y, z] = alarm.asked_pose;
    return stretchedTo(scene, this.studio.run.value?.ended?.moment.joints ?? UPRIGHT, [x, y, z]);
  });

  readonly ghosts = computed((): readonly Ghost[] => {
    const { studio } = this;
    const drawn = this.drawn.value;
    const ghosts: Ghost[] = [];
    const compared = studio.compared.value;
    void compared?.revision.value;
    const other = compared?.samples.joints(drawn.t);
    const scene = compared?.scene ?? null;
    const isOther = scene !== null && scene.robot !== studio.scene.value?.robot;
    if (other != null) ghosts.push({ kind: "compared", joints: other, text: "", ...(isOther ? { scene } : {}) });
    const target = studio.controller.value?.target_joints;
    if (target !== undefined && differs(target, drawn.joints)) ghosts.push({ kind: "target", joints: target, text: "" });
    const alarm = studio.run.value?.alarm;
    if (alarm != null && (alarm.asked_joints !== undefined || alarm.asked_pose !== undefined)) {
      const toward = this.toward.value;
      ghosts.push({
        kind: "asked", text: [alarm.code, alarm.limit ?? alarm.text].filter(Boolean).join(": "),
        ...(toward === null ? {} : { joints: toward }),
        ...(alarm.asked_pose === undefined ? {} : { frame: fromRollPitchYaw(alarm.asked_pose) }),
      });
    }
    const hovered = this.hoveredTime();
    const joints = hovered === null ? null : studio.runAt(hovered)?.samples.joints(hovered);
    if (hovered !== null && joints != null && differs(joints, drawn.joints)) ghosts.push({ kind: "hovered", joints, text: `${hovered.toFixed(3)} s` });
    return ghosts;
  });

  /** The time that is pointed at; of a line its first visit. */
  private hoveredTime(): number | null {
    const hover = this.studio.hover.value;
    if (hover === null) return null;
    return hover.t ?? (hover.line === undefined ? null : (this.studio.run.value?.visitAfter(hover.line, -1) ?? null));
  }

  /** Takes what runs have grown by. */
  refresh(): void {
    const { run, before, compared } = this.studio;
    const seen = [run, before, compared].map((shown) => `${shown.peek()?.number}:${shown.peek()?.revision.peek()}`).join();
    if (seen !== this.seen) this.grown.value++;
    this.seen = seen;
  }

  /** Changes whenever a run has grown. */
  readonly growth = computed(() => {
    const { run, before, compared } = this.studio;
    return [run, before, compared].map((shown) => shown.value?.revision.value ?? -1).join();
  });

  private whole(run: Run | null, from_s = 0): Path | null {
    const scene: Scene | null = this.studio.scene.value;
    void this.grown.value;
    return run === null || scene === null || run.samples.length < 2 ? null : pathOf(run, scene, from_s);
  }
}

function differs(a: Six, b: Six): boolean {
  return a.some((value, index) => Math.abs(value - b[index]!) > SAME_RAD);
}
