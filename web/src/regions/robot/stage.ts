/** The scene in WebGL. It draws only when it is asked to. */

import {
  BufferGeometry, CircleGeometry, Color, DirectionalLight, Float32BufferAttribute, Group, HemisphereLight, Line, LineBasicMaterial, LineSegments, Matrix4,
  Mesh, MeshBasicMaterial, type Object3D, PerspectiveCamera, Raycaster, Scene as Root, SphereGeometry, Vector2, Vector3, WebGLRenderer,
} from "three";
import { OrbitControls } from "three/addons/controls/OrbitControls.js";
import { apply, compose, FLANGE, fromRotationVector, linkFrames, type Point, tcpFrame, type Transform } from "../../model/kinematics.ts";
import { type Path, partsOf, pick, type Picked, project } from "../../model/path.ts";
import type { Contact, Scene, Six } from "../../source/messages.ts";
import { ArmObject, edgesOf, ghostLook, matrixOf, type Piece, piecesOf, shadowLook, solidLook } from "./arm.ts";
import type { Ghost } from "./drawing.ts";
import { Labels, type Label } from "./labels.ts";
import { HairObject, LineObject, piecesThrough, type Stroke, strokesOf } from "./lines.ts";
import { palette, type Palette } from "./palette.ts";

export type View = "front" | "side" | "top" | "iso";

/** Everything that a picture shows; objects that are the same as before cost nothing. */
export interface Picture {
  readonly scene: Scene;
  readonly isDark: boolean;
  readonly joints: Six;
  readonly ghosts: readonly Ghost[];
  readonly path: Path | null;
  readonly isStale: boolean;
  readonly stale: Path | null;
  readonly compared: Path | null;
  readonly speedEnd: number;
  readonly line: number;
  /** Time that is shown, s. */
  readonly t: number;
  readonly contacts: readonly Contact[];
  /** The one that is pointed at. */
  readonly contact: Contact | null;
  readonly contactText: (contact: Contact) => string;
  /** Joint whose limits are drawn, from 0, and its texts. */
  readonly joint: number | null;
  readonly jointTexts: readonly [min: string, now: string, max: string];
  readonly hasReach: boolean;
  /** Pieces of the user's own meshes, instead of those of the scene's arm. */
  readonly pieces: readonly Piece[] | null;
}

/** What is at a pixel. */
export interface Pointed {
  readonly path: Picked | null;
  readonly contact: Contact | null;
  readonly joint: number | null;
}

const FOV_DEG = 32;
/** What a fitted picture leaves free: left and right together, at the top for the buttons, at the bottom for the legend. */
const EDGE_PX = 48;
/** Share of the reach from which on a thing may go beyond the picture. */
const WIDE_SHARE = 0.4;
/** Reaches within which a pose that was asked for is put into the picture; one in millimetres instead of metres is not. */
const FAR_SHARE = 4;
const TOP_PX = 52;
const BOTTOM_PX = 40;
/** Of the label that says what an alarm is about. */
const ASKED_PX = 64;
const DIRECTIONS: { readonly [view in View]: Point } = { front: [0, -1, 0.0001], side: [1, 0, 0.0001], top: [0, -0.0001, 1], iso: [0.75, -1, 0.62] };

/** Returns whether WebGL draws by software; null where there is none at all. */
export function isSoftware(): boolean | null {
  const gl = document.createElement("canvas").getContext("webgl2");
  if (gl === null) return null;
  const names = gl.getExtension("WEBGL_debug_renderer_info");
  const renderer = String(gl.getParameter(names === null ? gl.RENDERER : names.UNMASKED_RENDERER_WEBGL));
  gl.getExtension("WEBGL_lose_context")?.loseContext();
  return /swiftshader|llvmpipe|software|basic render/i.test(renderer);
}

export class Stage {
  private readonly renderer: WebGLRenderer;
  private readonly root = new Root();
  /** Everything in the base frame; turned as the base is mounted. */
  private readonly base = new Group();
  private readonly camera = new PerspectiveCamera(FOV_DEG, 1, 0.01, 60);
  private readonly controls: OrbitControls;
  private readonly labels: Labels;
  private readonly software: boolean;
  private readonly ray = new Raycaster();
  private width = 1;
  private height = 1;
  private last: Picture | null = null;
  private colours: Palette = palette(false);
  private pieces: readonly Piece[] = [];
  private owned: readonly Piece[] = [];
  private arm: ArmObject | null = null;
  private shadow: ArmObject | null = null;
  /** By what they show, and the robot if it is another one. */
  private readonly ghostArms = new Map<string, ArmObject>();
  private readonly fixed = new Group();
  private readonly marks = new Group();
  private lines: Lines | null = null;
  private screen: { of: Path; xy: Float32Array } | null = null;
  private frameLabels: Label[] = [];
  private wanted: View | "fit" | null = null;
  private isFitted = false;
  private isTouched = false;
  private isRefined = false;

  /** `changed` is called when the camera has moved. Throws where the browser has no WebGL. */
  constructor(canvas: HTMLCanvasElement, labels: HTMLElement, software: boolean, changed: () => void) {
    this.software = software;
    this.renderer = new WebGLRenderer({ canvas, antialias: !software, alpha: true, stencil: true, powerPreference: "low-power" });
    this.renderer.setClearColor(0, 0);
    this.labels = new Labels(labels);
    this.camera.up.set(0, 0, 1);
    const key = new DirectionalLight(0xffffff, 2.0);
    key.position.set(-0.6, 0.9, 0.8);
    const rim = new DirectionalLight(0xdfeaff, 0.7);
    rim.position.set(0.9, 0.15, -0.4);
    this.camera.add(key, rim, key.target, rim.target);
    const sky = new HemisphereLight(0xffffff, 0x8b94a0, 1.25);
    sky.position.set(0, 0, 1);
    this.root.add(this.camera, sky, this.base);
    this.base.add(this.fixed, this.marks);
    this.controls = new OrbitControls(this.camera, canvas);
    this.controls.enableDamping = false;
    this.controls.zoomToCursor = true;
    this.controls.minDistance = 0.05;
    this.controls.maxDistance = 30;
    this.controls.addEventListener("change", () => {
      this.screen = null;
      changed();
    });
    this.controls.addEventListener("start", () => (this.isTouched = true));
  }

  dispose(): void {
    this.controls.dispose();
    this.renderer.dispose();
    // A browser keeps few contexts: those that it drops by itself may be the ones in use.
    this.renderer.getContext().getExtension("WEBGL_lose_context")?.loseContext();
  }

  resize(width: number, height: number): void {
    this.width = Math.max(1, width);
    this.height = Math.max(1, height);
    this.isRefined = false;
    this.renderer.setPixelRatio(this.software ? 1 : Math.min(devicePixelRatio || 1, 2));
    this.renderer.setSize(this.width, this.height, false);
    this.camera.aspect = this.width / this.height;
    this.camera.updateProjectionMatrix();
    this.screen = null;
  }

  // ---------------------------------------------------------------- drawing

  /** Draws the last picture once more with four times the pixels: what software is too slow for while things move. */
  refine(): void {
    if (!this.software || this.isRefined || this.last === null) return;
    this.isRefined = true;
    this.renderer.setPixelRatio(REFINED_RATIO);
    this.lines?.refine(true);
    this.renderer.render(this.root, this.camera);
  }

  draw(picture: Picture): void {
    if (this.isRefined) {
      this.isRefined = false;
      this.renderer.setPixelRatio(1);
      this.lines?.refine(false);
    }
    const last = this.last;
    this.last = picture;
    const isNewLook = last === null || last.isDark !== picture.isDark || last.scene !== picture.scene || last.pieces !== picture.pieces;
    if (isNewLook) this.build(picture);
    const frames = linkFrames(picture.scene.dh, picture.joints);
    this.arm!.pose(frames);
    this.shadow!.pose(frames);
    if (isNewLook || last.ghosts !== picture.ghosts) this.placeGhosts(picture);
    const lines = this.lines!;
    lines.paths(picture, isNewLook ? null : last);
    if (isNewLook || last.path !== picture.path) this.screen = null;
    this.frameLabels = lines.frames(picture, frames);
    if (isNewLook || last.contacts !== picture.contacts) this.placeContacts(picture);
    if (this.wanted === "fit") this.fit();
    else if (this.wanted !== null) this.look(new Vector3(...DIRECTIONS[this.wanted]).normalize(), this.points());
    this.wanted = null;
    if (!this.isFitted || (!this.isTouched && last?.path == null && picture.path !== null)) this.fit();
    this.renderer.render(this.root, this.camera);
    const labels = [...this.frameLabels, ...this.ghostLabels(picture), ...contactLabels(picture), ...thingLabels(picture)];
    this.labels.place(labels, this.base.matrixWorld, this.camera, this.width, this.height);
  }

  /** Builds what depends on the scene and on the theme alone. */
  private build(picture: Picture): void {
    const { scene } = picture;
    this.colours = palette(picture.isDark);
    if (this.last === null || this.owned.length === 0 || picture.scene.parts !== this.builtOf || picture.pieces !== this.builtWith) {
      for (const piece of this.owned) piece.geometry.dispose();
      this.owned = piecesOf(picture.pieces === null ? scene.parts : scene.parts.filter(({ role }) => OTHER_ROLES.has(role)));
      this.pieces = [...this.owned, ...(picture.pieces ?? [])];
      this.builtOf = scene.parts;
      this.builtWith = picture.pieces;
    }
    this.arm?.dispose();
    this.shadow?.dispose();
    for (const ghost of this.ghostArms.values()) ghost.dispose();
    this.ghostArms.clear();
    this.lines?.dispose();
    clear(this.fixed);
    this.base.matrixAutoUpdate = false;
    matrixOf(fromRotationVector(scene.mounting), this.base.matrix);
    this.base.matrixWorldNeedsUpdate = true;
    this.arm = new ArmObject(this.pieces, solidLook(this.colours));
    for (const { link, object } of edgesOf(scene.parts, this.colours)) this.arm.add(link, object);
    this.base.add(this.arm.group);
    this.shadow = new ArmObject(this.pieces, shadowLook(this.colours));
    this.shadow.group.matrixAutoUpdate = false;
    this.shadow.group.matrix.makeScale(1, 1, 0).setPosition(0, 0, 0.001);
    this.base.add(this.shadow.group);
    this.fixed.add(floor(scene, this.colours));
    this.lines = new Lines(this.base, scene, this.colours, this.software);
  }

  private builtOf: Scene["parts"] | null = null;
  private builtWith: readonly Piece[] | null = null;

  private placeGhosts({ ghosts, scene }: Picture): void {
    for (const arm of this.ghostArms.values()) arm.group.visible = false;
    for (const { kind, joints, scene: own } of ghosts) {
      if (joints === undefined) continue;
      const name = `${kind} ${own?.robot ?? ""}`;
      let arm = this.ghostArms.get(name);
      if (arm === undefined) {
        arm = new ArmObject((own === undefined ? this.pieces : this.piecesOfOther(own)).filter(({ link }) => link > 0), ghostLook(this.colours[kind], kind === "hovered" ? 0.4 : 0.5, kind === "asked" || kind === "compared"));
        this.base.add(arm.group);
        this.ghostArms.set(name, arm);
      }
      arm.group.visible = true;
      arm.pose(linkFrames((own ?? scene).dh, joints));
    }
  }

  /** Pieces of the arm of another robot, made once. */
  private piecesOfOther(scene: Scene): readonly Piece[] {
    if (this.other?.parts !== scene.parts) {
      for (const piece of this.other?.pieces ?? []) piece.geometry.dispose();
      this.other = { parts: scene.parts, pieces: piecesOf(scene.parts) };
    }
    return this.other!.pieces;
  }

  private other: { readonly parts: Scene["parts"]; readonly pieces: readonly Piece[] } | null = null;

  private ghostLabels({ ghosts, scene }: Picture): Label[] {
    return ghosts.flatMap(({ kind, joints, frame, text }) => {
      if (text === "") return [];
      const at = frame ?? linkFrames(scene.dh, joints!)[FLANGE]!;
      return [{ text, point: position(at), kind: kind === "asked" ? "asked" : "ghost" } satisfies Label];
    });
  }

  /** Red balls where something touches, small plain ones with a line between them where it comes closest. */
  private placeContacts({ contacts }: Picture): void {
    clear(this.marks);
    contacts.slice(0, CONTACTS_MAX).forEach(({ points, is_contact }, index) => {
      const colour = is_contact ? this.colours.contact : this.colours.ink;
      const paint = new MeshBasicMaterial({ color: colour, depthTest: false, transparent: true, opacity: is_contact ? 1 : 0.6 });
      for (const point of points ?? []) {
        const mark = new Mesh(new SphereGeometry(is_contact ? 0.01 : 0.005, 16, 12), paint);
        mark.position.set(...point);
        mark.renderOrder = 21;
        mark.userData["contact"] = index;
        this.marks.add(mark);
      }
      if (is_contact || points === undefined) return;
      const geometry = new BufferGeometry().setFromPoints(points.map((point) => new Vector3(...point)));
      const line = new Line(geometry, new LineBasicMaterial({ color: colour, depthTest: false, transparent: true, opacity: 0.6 }));
      line.renderOrder = 21;
      line.userData["contact"] = index;
      this.marks.add(line);
    });
  }

  // ---------------------------------------------------------------- camera

  /** Where the eye is in the world, m. */
  get eye(): readonly number[] {
    return this.camera.position.toArray();
  }

  /** Looks from a side, or fits what is there into the picture, in the next frame: what is drawn then counts. */
  want(view: View | "fit"): void {
    this.wanted = view;
    if (view !== "fit") this.isTouched = true;
  }

  /** Puts the arm, the path and the things into the picture. */
  private fit(): void {
    const points = this.points();
    if (points.length === 0) return;
    this.isFitted = true;
    this.base.updateMatrixWorld(true);
    const direction = this.camera.position.clone().sub(this.controls.target);
    if (direction.lengthSq() < 1e-9) direction.set(...DIRECTIONS.iso);
    this.look(direction.normalize(), points);
  }

  /** Turns, moves or zooms by a step of the keyboard. */
  step(turn: readonly [number, number], shift: readonly [number, number], zoom: number): void {
    this.isTouched = true;
    const { target } = this.controls;
    const offset = this.camera.position.clone().sub(target).multiplyScalar(zoom);
    const radius = offset.length();
    const polar = Math.min(Math.PI - 0.001, Math.max(0.001, Math.acos(offset.z / radius) + turn[1]));
    const azimuth = Math.atan2(offset.y, offset.x) + turn[0];
    offset.set(Math.sin(polar) * Math.cos(azimuth), Math.sin(polar) * Math.sin(azimuth), Math.cos(polar)).multiplyScalar(radius);
    const moved = new Vector3(shift[0], shift[1], 0).multiplyScalar(radius).applyQuaternion(this.camera.quaternion);
    target.add(moved);
    this.camera.position.copy(target).add(offset);
    this.controls.update();
  }

  private look(direction: Vector3, points: readonly Vector3[]): void {
    // Camera axes for this direction, then the distance at which every point is inside of the picture.
    const view = new Matrix4().lookAt(direction, new Vector3(), this.camera.up);
    const [right, up] = [new Vector3(), new Vector3()];
    view.extractBasis(right, up, new Vector3());
    const low = new Vector3(Infinity, Infinity, Infinity);
    const high = new Vector3(-Infinity, -Infinity, -Infinity);
    const own = points.map((point) => new Vector3(point.dot(right), point.dot(up), point.dot(direction)));
    for (const point of own) {
      low.min(point);
      high.max(point);
    }
    const centre = low.clone().add(high).multiplyScalar(0.5);
    const top = TOP_PX + (this.last?.ghosts.some(({ kind }) => kind === "asked") ? ASKED_PX : 0);
    const slope = Math.tan((FOV_DEG * Math.PI) / 360);
    const [wide, tall] = [1 - EDGE_PX / this.width, 1 - (top + BOTTOM_PX) / this.height].map((share) => slope * Math.max(share, 0.5)) as [number, number];
    let distance = 0.2;
    for (const point of own) {
      const depth = point.z - centre.z;
      distance = Math.max(distance, Math.abs(point.y - centre.y) / tall + depth, Math.abs(point.x - centre.x) / (wide * this.camera.aspect) + depth);
    }
    // Buttons cover more at the top than the legend does at the bottom.
    centre.y += (slope * distance * (top - BOTTOM_PX)) / this.height;
    const target = right.multiplyScalar(centre.x).add(up.multiplyScalar(centre.y)).addScaledVector(direction, centre.z);
    this.controls.target.copy(target);
    this.camera.position.copy(target).addScaledVector(direction, distance);
    this.controls.update();
    this.screen = null;
  }

  /** Points that a fitted picture contains, in the world. */
  private points(): Vector3[] {
    const picture = this.last;
    if (picture === null) return [];
    const { scene, joints, path, ghosts } = picture;
    const points: Point[] = [[0.15, 0.15, 0], [-0.15, -0.15, 0]];
    if (picture.hasReach) for (const axis of AXES) for (const side of [-1, 1]) points.push(scaled(axis, side * scene.limits.reach, scene.dh[0]?.d ?? 0));
    for (const shown of [{ joints, scene }, ...ghosts.map((ghost) => ({ joints: ghost.joints ?? joints, scene: ghost.scene ?? scene }))]) {
      const frames = linkFrames(shown.scene.dh, shown.joints);
      for (const part of shown.scene.parts) {
        const centre = compose(frames[part.link] ?? frames[0]!, fromRotationVector(part.pose));
        const size = part.kind === "box" ? part.size.map((side) => side / 2) : [part.size[0]!, part.size[0]!, part.size.at(-1)! / 2];
        if (Math.max(...size) > WIDE_SHARE * scene.limits.reach) continue; // a table, a floor or a wall
        for (const side of [-1, 1]) for (const axis of [0, 1, 2]) points.push(apply(centre, [0, 1, 2].map((k) => (k === axis ? side * size[k]! : 0)) as unknown as Point));
      }
    }
    for (const { frame } of ghosts) if (frame !== undefined && Math.hypot(...position(frame)) < FAR_SHARE * scene.limits.reach) points.push(position(frame));
    if (path !== null) {
      const step = Math.max(1, Math.floor(path.t.length / 500));
      for (let i = 0; i < path.t.length; i += step) points.push([path.xyz[3 * i]!, path.xyz[3 * i + 1]!, path.xyz[3 * i + 2]!]);
    }
    return points.map((point) => new Vector3(...point).applyMatrix4(this.base.matrixWorld));
  }

  // ---------------------------------------------------------------- pointing

  /** Returns what is at a pixel of the canvas. */
  at(x: number, y: number, tolerance_px: number, near_s: number): Pointed {
    const picture = this.last;
    if (picture === null) return { path: null, contact: null, joint: null };
    // The camera may have moved since the last frame.
    this.camera.updateMatrixWorld();
    this.ray.params.Line.threshold = 0.006;
    this.ray.setFromCamera(new Vector2((2 * x) / this.width - 1, 1 - (2 * y) / this.height), this.camera);
    const mark = this.ray.intersectObject(this.marks)[0];
    const contact = mark === undefined ? null : (picture.contacts[Number(mark.object.userData["contact"])] ?? null);
    let path: Picked | null = null;
    if (picture.path !== null) {
      if (this.screen?.of !== picture.path) {
        const matrix = this.camera.projectionMatrix.clone().multiply(this.camera.matrixWorldInverse).multiply(this.base.matrixWorld);
        this.screen = { of: picture.path, xy: project(picture.path.xyz, matrix.elements, this.width, this.height) };
      }
      path = pick(picture.path, this.screen.xy, x, y, tolerance_px, near_s);
    }
    let joint: number | null = null;
    if (path === null && contact === null && this.arm !== null) {
      const link = Number(this.ray.intersectObject(this.arm.group)[0]?.object.userData["link"] ?? 0);
      if (link > 0) joint = Math.min(link, 6) - 1;
    }
    return { path, contact, joint };
  }
}

const CONTACTS_MAX = 100;
const LABELLED_CONTACTS_MAX = 6;
const OTHER_ROLES: ReadonlySet<string> = new Set(["tool", "payload", "thing"]);

function position(t: Transform): Point {
  return [t[9], t[10], t[11]];
}

/** Labels of contacts, the first ones; of a closest distance while it is pointed at. */
/** Returns the labels of what is pointed at and of what touches at the time that is shown. */
function contactLabels({ contacts, contact, contactText, t }: Picture): Label[] {
  const touching = contacts.filter((other) => other.is_contact && other !== contact && other.start_s <= t && t <= other.end_s).slice(0, LABELLED_CONTACTS_MAX);
  return [...(contact === null ? [] : [contact]), ...touching].map((shown) => ({
    text: contactText(shown), point: shown.points![0], kind: shown.is_contact ? "contact" : "distance",
  }));
}

function thingLabels({ scene }: Picture): Label[] {
  const named = new Map<string, Label>();
  for (const part of scene.parts) {
    if (part.role !== "thing" || part.name === undefined || named.has(part.name)) continue;
    const height = part.kind === "sphere" ? part.size[0]! : part.kind === "capsule" ? part.size[1]! / 2 + part.size[0]! : part.size.at(-1)! / 2;
    named.set(part.name, { text: part.name, point: apply(fromRotationVector(part.pose), [0, 0, height]), kind: "name" });
  }
  return [...named.values()];
}

function clear(group: Group): void {
  for (const child of [...group.children]) {
    child.removeFromParent();
    child.traverse((object) => {
      if (object instanceof Mesh || object instanceof Line) {
        object.geometry.dispose();
        for (const material of [object.material].flat()) material.dispose();
      }
    });
  }
}

// ---------------------------------------------------------------- the floor

const CELL_M = 0.1;

/** The plane on which the base stands, with a grid of 0.1 m that ends softly, and a plate under the base. */
function floor({ limits, parts }: Scene, colours: Palette): Group {
  const group = new Group();
  const cells = Math.ceil((1.25 * limits.reach) / CELL_M);
  const radius = cells * CELL_M;
  const points: number[] = [];
  const shades: number[] = [];
  const ink = new Color(colours.grid);
  for (let line = -cells; line <= cells; line++) {
    const strength = line % 5 === 0 ? 0.75 : 0.36;
    for (let cell = -cells; cell < cells; cell++) {
      for (const isAcross of [false, true]) {
        for (const end of [cell, cell + 1]) {
          const [x, y] = isAcross ? [line * CELL_M, end * CELL_M] : [end * CELL_M, line * CELL_M];
          points.push(x, y, 0);
          shades.push(ink.r, ink.g, ink.b, strength * Math.max(0, 1 - (Math.hypot(x, y) / radius) ** 2));
        }
      }
    }
  }
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new Float32BufferAttribute(points, 3));
  geometry.setAttribute("color", new Float32BufferAttribute(shades, 4));
  const grid = new LineSegments(geometry, new LineBasicMaterial({ vertexColors: true, transparent: true, depthWrite: false }));
  grid.renderOrder = -10;
  const foot = parts.find(({ role }) => role === "base")?.size[0] ?? 0.08;
  const plate = new Mesh(new CircleGeometry(1.35 * foot, 64), new MeshBasicMaterial({ color: colours.grid, transparent: true, opacity: 0.5, depthWrite: false }));
  plate.position.z = 0.0005;
  plate.renderOrder = -9;
  group.add(grid, plate);
  return group;
}

// ---------------------------------------------------------------- lines

const REFINED_RATIO = 2;

/** Pieces that a software renderer draws wide. */
const WIDE_PIECES_MAX = 800;
const NOTHING = new Float32Array(0);

const AXES: readonly Point[] = [[1, 0, 0], [0, 1, 0], [0, 0, 1]];
const NAMES = ["x", "y", "z"] as const;

/** Paths, frames, the limits of a joint, the sphere of reach. */
class Lines {
  private readonly made: LineObject[] = [];
  private readonly group = new Group();
  private readonly scene: Scene;
  private readonly colours: Palette;
  private readonly path: LineObject;
  private readonly hair: HairObject;
  private readonly isSoftware: boolean;
  /** Whether the path is too long to be drawn wide while things move. */
  private isFine = false;
  private readonly hidden: LineObject | null;
  private readonly raised: LineObject;
  private readonly stale: LineObject;
  private readonly whole: LineObject;
  private readonly compared: LineObject;
  private readonly tcp: Group;
  private readonly asked: Group;
  /** From the TCP of the arm that was asked for to the pose that it does not reach. */
  private readonly missing: LineObject;
  private readonly flange: Group;
  private readonly range: LineObject;
  private readonly turned: LineObject;
  private readonly reach: LineObject;
  private readonly gravity: LineObject;

  constructor(parent: Object3D, scene: Scene, colours: Palette, software: boolean) {
    this.scene = scene;
    this.colours = colours;
    parent.add(this.group);
    this.isSoftware = software;
    this.path = this.make({ width_px: 2 });
    this.hair = new HairObject(this.group);
    this.hidden = software ? null : this.make({ width_px: 1.5, opacity: 0.3, isHidden: true, order: 1 });
    this.raised = this.make({ width_px: 5, order: 2 });
    this.stale = this.make({ width_px: 1.5, colour: colours.stale, opacity: 0.7 });
    this.whole = this.make({ width_px: 1.5, colour: colours.stale });
    this.compared = this.make({ width_px: 1.75, colour: colours.compared, isDashed: true });
    this.tcp = this.frame();
    this.asked = this.frame();
    this.missing = this.make({ width_px: 2, colour: colours.asked, isDashed: true, isOnTop: true });
    this.flange = this.moved();
    this.make({ width_px: 1.25, colour: colours.ink, isOnTop: true }, this.flange).set([0, 0, 0, ...position(fromRotationVector(scene.tcp))]);
    this.range = this.make({ width_px: 1.5, colour: colours.ink, opacity: 0.6, isOnTop: true });
    this.turned = this.make({ width_px: 4, colour: colours.hovered, isOnTop: true, order: 21 });
    this.reach = this.make({ width_px: 1, colour: colours.grid, opacity: 0.6 });
    this.gravity = this.make({ width_px: 2, colour: colours.ink });
    for (const axis of [0, 1]) {
      this.make({ width_px: 1.75, colour: colours.axes[axis]! }).set([0, 0, 0.002, ...scaled(AXES[axis]!, BASE_AXIS_M, 0.002)]);
    }
  }

  private make(stroke: Stroke, parent: Object3D = this.group): LineObject {
    const line = new LineObject(parent, stroke);
    this.made.push(line);
    return line;
  }

  /** A group that is moved by its matrix. */
  private moved(): Group {
    const group = new Group();
    group.matrixAutoUpdate = false;
    this.group.add(group);
    return group;
  }

  private frame(): Group {
    const group = this.moved();
    AXES.forEach((axis, index) => this.make({ width_px: 3, colour: this.colours.axes[index]!, isOnTop: true }, group).set([0, 0, 0, ...scaled(axis, TCP_AXIS_M, 0)]));
    return group;
  }

  dispose(): void {
    for (const line of this.made) line.dispose();
    this.hair.dispose();
    this.group.removeFromParent();
  }

  /** Draws a long path wide or in lines of a pixel. */
  refine(isRefined: boolean): void {
    if (!this.isFine) return;
    this.path.object.visible = isRefined;
    this.hair.object.visible = !isRefined;
  }

  /** Updates the paths where they are others than in the last picture. */
  paths(picture: Picture, last: Picture | null): void {
    const { path, speedEnd, isDark } = picture;
    const isNew = last === null || last.path !== path || last.speedEnd !== speedEnd || last.isStale !== picture.isStale;
    if (isNew) {
      const [positions, colours] = path === null ? [NOTHING, NOTHING] : strokesOf(path, speedEnd, isDark);
      this.isFine = this.isSoftware && positions.length > 6 * WIDE_PIECES_MAX;
      this.path.set(picture.isStale ? [] : positions, colours);
      this.hair.set(picture.isStale || !this.isFine ? NOTHING : positions, colours);
      this.refine(false);
      this.whole.set(picture.isStale ? positions : []);
      this.hidden?.share(this.path);
    }
    if (isNew || last.line !== picture.line) {
      const parts = path === null || picture.line === 0 || picture.isStale ? [] : partsOf(path, picture.line);
      const [positions, colours] = parts.length === 0 ? [[], undefined] : strokesOf(path!, speedEnd, isDark, parts);
      this.raised.set(positions, colours);
    }
    if (last === null || last.stale !== picture.stale) this.stale.set(picture.stale === null ? [] : strokesOf(picture.stale, speedEnd, isDark)[0]);
    if (last === null || last.compared !== picture.compared) this.compared.set(picture.compared === null ? [] : strokesOf(picture.compared, speedEnd, isDark)[0]);
    if (last === null || last.hasReach !== picture.hasReach) this.reach.set(picture.hasReach ? reachSphere(this.scene) : []);
  }

  /** Updates frames, limits of a joint and gravity; returns their labels. */
  frames(picture: Picture, frames: readonly Transform[]): Label[] {
    const { scene, colours } = this;
    // The z axis of the base is inside of the arm.
    const labels: Label[] = [0, 1].map((index) => ({ text: NAMES[index]!, point: scaled(AXES[index]!, BASE_AXIS_M + 0.02, 0), kind: "axis", colour: colours.axes[index]! }));
    const tcp = compose(frames[FLANGE]!, fromRotationVector(scene.tcp));
    place(this.flange, frames[FLANGE]!);
    place(this.tcp, tcp);
    labels.push(...this.letters(tcp));
    const ghost = picture.ghosts.find((other) => other.frame !== undefined);
    const asked = ghost?.frame;
    const ends = asked === undefined || ghost?.joints === undefined ? [] : [...position(tcpFrame(scene, ghost.joints)), ...position(asked)];
    this.missing.set(ends);
    this.asked.visible = asked !== undefined;
    if (asked !== undefined) {
      place(this.asked, asked);
      labels.push(...this.letters(asked));
    }
    labels.push(...this.limits(picture, frames));
    const down = apply(inverseRotation(fromRotationVector(scene.mounting)), [0, 0, -1]);
    if (down[2] > -0.9999) {
      const from: Point = [0.25, 0.25, 0.2];
      const to: Point = [from[0] + 0.18 * down[0], from[1] + 0.18 * down[1], from[2] + 0.18 * down[2]];
      this.gravity.set([...from, ...to]);
      labels.push({ text: "g ↓", point: to, kind: "name" });
    } else this.gravity.set([]);
    return labels;
  }

  private letters(frame: Transform): Label[] {
    return AXES.map((axis, index) => ({
      text: NAMES[index]!, point: apply(frame, scaled(axis, TCP_AXIS_M + 0.015, 0)), kind: "axis", colour: this.colours.axes[index]!,
    }));
  }

  /** The range of a joint about its axis: a spiral from limit to limit, thick from zero to where the joint is. */
  private limits({ joint, joints, jointTexts }: Picture, frames: readonly Transform[]): Label[] {
    if (joint === null) {
      this.range.set([]);
      this.turned.set([]);
      return [];
    }
    const { limits } = this.scene;
    const [low, high, now] = [limits.position_min[joint]!, limits.position_max[joint]!, joints[joint]!];
    const [c, s] = [Math.cos(now), Math.sin(now)];
    const zero = compose(frames[joint + 1]!, [c, s, 0, -s, c, 0, 0, 0, 1, 0, 0, 0]); // turned back to joint angle 0
    const radius = 0.16 * limits.reach;
    const at = (angle: number, share = 1): Point => {
      const r = share * radius * (1 + (0.12 * angle) / Math.PI);
      return apply(zero, [r * Math.cos(angle), r * Math.sin(angle), 0]);
    };
    const along = (from: number, to: number) => {
      const steps = Math.max(2, Math.ceil(Math.abs(to - from) / 0.06));
      return piecesThrough(Array.from({ length: steps + 1 }, (_, step) => at(from + ((to - from) * step) / steps)));
    };
    const ends = [low, high].flatMap((end) => [...at(end, 0.86), ...at(end, 1.14)]);
    this.range.set([...along(low, high), ...ends, ...at(0, 0.9), ...at(0, 1.06), ...at(now, 0), ...at(now, 1.08)]);
    this.turned.set(Math.abs(now) < 1e-3 ? [] : along(0, now));
    const [min, current, max] = jointTexts;
    return [
      { text: min, point: at(low, 1.14), kind: "limit low" }, { text: max, point: at(high, 1.14), kind: "limit high" },
      { text: current, point: at(now, 1.16), kind: "ghost" },
    ];
  }
}

function place(group: Group, frame: Transform): void {
  matrixOf(frame, group.matrix);
  group.matrixWorldNeedsUpdate = true;
}

const BASE_AXIS_M = 0.25;
const TCP_AXIS_M = 0.09;

function scaled([x, y, z]: Point, size: number, up: number): Point {
  return [x * size, y * size, z * size + up];
}

function inverseRotation(t: Transform): Transform {
  return [t[0], t[3], t[6], t[1], t[4], t[7], t[2], t[5], t[8], 0, 0, 0];
}

/** Circles of latitude and longitude of the sphere that the flange can reach, about the shoulder. */
function reachSphere({ limits, dh }: Scene): number[] {
  const pieces: number[] = [];
  const circle = (point: (angle: number) => Point) =>
    pieces.push(...piecesThrough(Array.from({ length: 97 }, (_, step) => point((step * 2 * Math.PI) / 96))));
  const height = dh[0]?.d ?? 0;
  const r = limits.reach;
  for (let k = 0; k < 6; k++) {
    const [c, s] = [Math.cos((k * Math.PI) / 6), Math.sin((k * Math.PI) / 6)];
    circle((a) => [r * Math.cos(a) * c, r * Math.cos(a) * s, height + r * Math.sin(a)]);
  }
  for (let k = -2; k <= 2; k++) {
    const [c, s] = [Math.cos((k * Math.PI) / 6), Math.sin((k * Math.PI) / 6)];
    circle((a) => [r * c * Math.cos(a), r * c * Math.sin(a), height + r * s]);
  }
  return pieces;
}
