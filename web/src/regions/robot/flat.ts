/** The scene without WebGL: arm and path from above and from the side, on a 2-D canvas. */

import { FLANGE, linkFrames, type Point, tcpFrame } from "../../model/kinematics.ts";
import { type Path, type PathPart, partsOf, pick, type Picked, speedColour } from "../../model/path.ts";
import type { Scene, Six } from "../../source/messages.ts";
import { palette } from "./palette.ts";
import type { Picture, Pointed } from "./stage.ts";

/** Which axes go right and up. */
const SIDES = [{ right: 0, up: 1 }, { right: 0, up: 2 }] as const;
const MARGIN_PX = 28;
const FONT = "12px system-ui, sans-serif";

interface Plane {
  readonly x: (point: ArrayLike<number>) => number;
  readonly y: (point: ArrayLike<number>) => number;
}

/** A part of the picture that is drawn again only when what it shows has changed. */
class Layer {
  private readonly canvas = document.createElement("canvas");
  private known: readonly unknown[] = [];

  drawn(shown: readonly unknown[], [width, height]: readonly [number, number], draw: (g: CanvasRenderingContext2D) => void): HTMLCanvasElement {
    // Without graphics hardware another canvas would draw every line of this one again.
    const g = this.canvas.getContext("2d", { willReadFrequently: true });
    if (g === null || shown.every((value, index) => value === this.known[index])) return this.canvas;
    this.known = shown;
    this.canvas.width = width;
    this.canvas.height = height;
    draw(g);
    return this.canvas;
  }
}

export class Flat {
  private readonly canvas: HTMLCanvasElement;
  private readonly titles: () => readonly [string, string];
  /** What stays while the arm moves. */
  private readonly layers = { paths: new Layer(), line: new Layer() };
  private width = 1;
  private height = 1;
  private last: Picture | null = null;
  private planes: readonly Plane[] = [];

  /** `titles`: names of the view from above and of that from the side. */
  constructor(canvas: HTMLCanvasElement, titles: () => readonly [string, string]) {
    this.canvas = canvas;
    this.titles = titles;
  }

  resize(width: number, height: number): void {
    const ratio = devicePixelRatio || 1;
    this.width = width;
    this.height = height;
    const [wide, high] = [Math.max(1, Math.round(width * ratio)), Math.max(1, Math.round(height * ratio))];
    // A canvas is empty once its size is set, also to the same; a picture that was just drawn would be gone for a frame.
    if (this.canvas.width !== wide) this.canvas.width = wide;
    if (this.canvas.height !== high) this.canvas.height = high;
    if (this.last !== null) this.draw(this.last);
  }

  draw(picture: Picture): void {
    const g = this.canvas.getContext("2d");
    if (g === null) return;
    this.last = picture;
    const colours = palette(picture.isDark);
    const ratio = this.canvas.width / this.width;
    const reach = 1.15 * picture.scene.limits.reach;
    const cell = Math.min(this.width / 2, this.height) - 2 * MARGIN_PX;
    const scale = Math.max(cell, 10) / (2 * reach);
    const height = picture.scene.dh[0]?.d ?? 0;
    this.planes = SIDES.map(({ right, up }, index) => {
      const middle = { x: this.width * (0.25 + 0.5 * index), y: this.height / 2 + (up === 2 ? height * scale : 0) };
      return { x: (point) => middle.x + point[right]! * scale, y: (point) => middle.y - point[up]! * scale };
    });
    const { path, isStale, stale, compared, line, speedEnd, isDark, scene } = picture;
    const titles = this.titles();
    const size = [this.canvas.width, this.canvas.height] as const;
    const both = (draw: (g: CanvasRenderingContext2D, plane: Plane, index: number) => void) => (on: CanvasRenderingContext2D) => {
      on.setTransform(ratio, 0, 0, ratio, 0, 0);
      this.planes.forEach((plane, index) => draw(on, plane, index));
    };
    const under = this.layers.paths.drawn([...size, path, isStale, stale, compared, speedEnd, isDark, scene, ...titles], size, both((on, plane, index) => {
      on.font = FONT;
      on.fillStyle = colours.ink;
      on.textAlign = "center";
      on.fillText(titles[index]!, this.width * (0.25 + 0.5 * index), 16);
      grid(on, plane, SIDES[index]!, reach, colours.grid);
      paths(on, plane, picture, colours.stale, colours.compared);
    }));
    const thick = this.layers.line.drawn([...size, path, isStale, line, speedEnd, isDark, scene], size, both((on, plane) => {
      if (path !== null && line > 0 && !isStale) coloured(on, plane, picture, path, 4.5, partsOf(path, line));
    }));
    g.setTransform(1, 0, 0, 1, 0, 0);
    g.clearRect(0, 0, ...size);
    g.drawImage(under, 0, 0);
    g.drawImage(thick, 0, 0);
    g.setTransform(ratio, 0, 0, ratio, 0, 0);
    g.font = FONT;
    g.lineCap = g.lineJoin = "round";
    this.planes.forEach((plane) => {
      for (const ghost of picture.ghosts) {
        if (ghost.joints !== undefined) arm(g, plane, ghost.scene ?? picture.scene, ghost.joints, colours[ghost.kind], ghost.text);
      }
      arm(g, plane, picture.scene, picture.joints, colours.ink, "", colours.parts.cap);
    });
  }

  at(x: number, y: number, tolerance_px: number, near_s: number): Pointed {
    const path = this.last?.path ?? null;
    let found: Picked | null = null;
    for (const plane of path === null ? [] : this.planes) {
      const screen = new Float32Array(2 * path!.t.length);
      for (let i = 0; i < path!.t.length; i++) {
        const point = path!.xyz.subarray(3 * i, 3 * i + 3);
        screen[2 * i] = plane.x(point);
        screen[2 * i + 1] = plane.y(point);
      }
      const picked = pick(path!, screen, x, y, tolerance_px, near_s);
      if (picked !== null && (found === null || picked.distance_px < found.distance_px)) found = picked;
    }
    return { path: found, contact: null, joint: null };
  }
}

function grid(g: CanvasRenderingContext2D, plane: Plane, { right, up }: (typeof SIDES)[number], reach: number, colour: string): void {
  const cells = Math.floor(reach / 0.1);
  g.strokeStyle = colour;
  for (let line = -cells; line <= cells; line++) {
    g.globalAlpha = line === 0 ? 0.8 : line % 5 === 0 ? 0.4 : 0.18;
    g.lineWidth = 1;
    for (const isAcross of [false, true]) {
      const [from, to] = [-1, 1].map((side) => {
        const point = [0, 0, 0];
        point[isAcross ? up : right] = side * cells * 0.1;
        point[isAcross ? right : up] = line * 0.1;
        return point;
      });
      stroke(g, plane, [from!, to!]);
    }
  }
  g.globalAlpha = 1;
}

function stroke(g: CanvasRenderingContext2D, plane: Plane, points: readonly ArrayLike<number>[]): void {
  g.beginPath();
  for (const point of points) g.lineTo(plane.x(point), plane.y(point));
  g.stroke();
}

function paths(g: CanvasRenderingContext2D, plane: Plane, picture: Picture, stale: string, compared: string): void {
  g.lineCap = g.lineJoin = "round";
  const plain = (path: Path, colour: string, dash: number[]) => {
    g.strokeStyle = colour;
    g.lineWidth = 1.5;
    g.setLineDash(dash);
    g.beginPath();
    for (let i = 0; i < path.t.length; i++) {
      const [x, y] = [plane.x(path.xyz.subarray(3 * i, 3 * i + 3)), plane.y(path.xyz.subarray(3 * i, 3 * i + 3))];
      if (i > 0 && path.jumps[i - 1] === 0) g.lineTo(x, y);
      else g.moveTo(x, y);
    }
    g.stroke();
    g.setLineDash([]);
  };
  if (picture.stale !== null) plain(picture.stale, stale, []);
  if (picture.compared !== null) plain(picture.compared, compared, [5, 4]);
  const { path } = picture;
  if (path === null) return;
  if (picture.isStale) plain(path, stale, []);
  else coloured(g, plane, picture, path, 1.5, [{ from: 0, to: path.jumps.length }]);
}

/** Draws a path, or parts of it, in the colours of its speeds. */
function coloured(g: CanvasRenderingContext2D, plane: Plane, { speedEnd, isDark }: Picture, path: Path, width: number, parts: readonly PathPart[]): void {
  g.lineCap = g.lineJoin = "round";
  g.lineWidth = width;
  for (const { from, to } of parts) {
    for (let i = from; i < to; i++) {
      if (path.jumps[i] === 1) continue;
      g.strokeStyle = `rgb(${speedColour(path.speed[i]! / speedEnd, isDark).join()})`;
      stroke(g, plane, [path.xyz.subarray(3 * i, 3 * i + 3), path.xyz.subarray(3 * i + 3, 3 * i + 6)]);
    }
  }
}

/** The arm as a stick from joint to joint, with the offsets of its housings as they are. */
function arm(g: CanvasRenderingContext2D, plane: Plane, scene: Scene, joints: Six, colour: string, text: string, core = colour): void {
  const frames = linkFrames(scene.dh, joints);
  const points: Point[] = frames.slice(0, FLANGE).map((frame) => [frame[9], frame[10], frame[11]]);
  const tcp = tcpFrame(scene, joints);
  g.strokeStyle = colour;
  g.globalAlpha = 0.85;
  g.lineWidth = 7;
  stroke(g, plane, points);
  g.lineWidth = 3;
  g.strokeStyle = core;
  stroke(g, plane, points);
  g.lineWidth = 1.5;
  g.strokeStyle = colour;
  stroke(g, plane, [points.at(-1)!, [tcp[9], tcp[10], tcp[11]]]);
  g.globalAlpha = 1;
  g.fillStyle = colour;
  for (const point of points.slice(1)) {
    g.beginPath();
    g.arc(plane.x(point), plane.y(point), 3.5, 0, 2 * Math.PI);
    g.fill();
  }
  if (text !== "") {
    g.textAlign = "left";
    g.fillText(text, plane.x([tcp[9], tcp[10], tcp[11]]) + 8, plane.y([tcp[9], tcp[10], tcp[11]]) - 6);
  }
}
