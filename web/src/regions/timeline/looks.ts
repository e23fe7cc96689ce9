/** Colours, hatchings and signs of the time line. What differs by colour differs by hatching, dash, sign or label too. */

import type { MarkKind } from "../../model/lanes.ts";
import type { Palette } from "../../style/palette.ts";

/** Fill and edge of a span. Ink has a contrast of 7:1 and more on each fill, edges 3:1 on the panel. */
export interface Tint {
  readonly fill: string;
  readonly edge: string;
}

const LIGHT: readonly Tint[] = [
  { fill: "#d3e4fb", edge: "#2f6db5" },
  { fill: "#fbe3c0", edge: "#a66300" },
  { fill: "#d0eee1", edge: "#1d7a5c" },
  { fill: "#ead9f8", edge: "#8048b8" },
  { fill: "#e7e8ea", edge: "#66707a" },
];

const DARK: readonly Tint[] = [
  { fill: "#1f3b5e", edge: "#6ea6e8" },
  { fill: "#523712", edge: "#e0a04a" },
  { fill: "#17443a", edge: "#54c7a0" },
  { fill: "#432a5e", edge: "#bb8cec" },
  { fill: "#343b43", edge: "#98a4b0" },
];

export function tints(isDark: boolean): readonly Tint[] {
  return isDark ? DARK : LIGHT;
}

/** Lines on spans: none, rising, falling. With five tints, fifteen looks. */
export const HATCHINGS = 3;

/** Dash of each joint's curve, px. */
export const DASHES: readonly (readonly number[])[] = [[], [9, 4], [2, 3], [10, 3, 2, 3], [5, 3], [12, 3, 2, 3, 2, 3]];

export type Sign = "diamond" | "triangle" | "square" | "disc" | "ring" | "up" | "down" | "cross" | "crossed";

/** Sign and colour of each kind of mark. */
export const SIGNS: { readonly [kind in MarkKind]: readonly [Sign, "error" | "warning" | "accent" | "good" | "faint"] } = {
  alarm: ["diamond", "error"],
  warning: ["triangle", "warning"],
  popup: ["square", "accent"],
  log: ["disc", "accent"],
  print: ["ring", "faint"],
  device: ["disc", "good"],
  open: ["ring", "accent"],
  sent: ["up", "accent"],
  received: ["down", "good"],
  closed: ["square", "faint"],
  refused: ["cross", "error"],
  timeout: ["crossed", "error"],
};

export function drawSign(g: CanvasRenderingContext2D, kind: MarkKind, x: number, y: number, palette: Palette): void {
  const [sign, colour] = SIGNS[kind];
  g.fillStyle = g.strokeStyle = palette[colour];
  g.lineWidth = 1.7;
  g.beginPath();
  switch (sign) {
    case "diamond":
      polygon(g, [[x, y - 7], [x + 7, y], [x, y + 7], [x - 7, y]]);
      return;
    case "triangle":
      polygon(g, [[x, y - 6], [x + 6.5, y + 5.5], [x - 6.5, y + 5.5]]);
      return;
    case "square":
      g.fillRect(x - 4, y - 4, 8, 8);
      return;
    case "disc":
      g.arc(x, y, 4, 0, 2 * Math.PI);
      g.fill();
      return;
    case "ring":
      g.arc(x, y, 3.6, 0, 2 * Math.PI);
      g.stroke();
      return;
    case "up":
      polygon(g, [[x, y - 7], [x + 5, y + 1], [x - 5, y + 1]]);
      return;
    case "down":
      polygon(g, [[x, y + 7], [x + 5, y - 1], [x - 5, y - 1]]);
      return;
    default:
      g.moveTo(x - 4.5, y - 4.5);
      g.lineTo(x + 4.5, y + 4.5);
      g.moveTo(x + 4.5, y - 4.5);
      g.lineTo(x - 4.5, y + 4.5);
      g.stroke();
      if (sign === "crossed") {
        g.beginPath();
        g.arc(x, y, 6.5, 0, 2 * Math.PI);
        g.stroke();
      }
  }
}

function polygon(g: CanvasRenderingContext2D, corners: readonly (readonly [number, number])[]): void {
  corners.forEach(([x, y], index) => (index === 0 ? g.moveTo(x, y) : g.lineTo(x, y)));
  g.closePath();
  g.fill();
}

const patterns = new Map<string, HTMLCanvasElement>();

/** Returns a tile of parallel lines, to be made a pattern of; `hatching` 1 rises, 2 falls. */
function tile(hatching: number, colour: string, ratio: number): HTMLCanvasElement {
  const key = `${hatching} ${colour} ${ratio}`;
  const known = patterns.get(key);
  if (known !== undefined) return known;
  const size = Math.round(6 * ratio);
  const canvas = document.createElement("canvas");
  canvas.width = canvas.height = size;
  const g = canvas.getContext("2d")!;
  g.strokeStyle = colour;
  g.lineWidth = ratio;
  g.beginPath();
  // Three parallels, so that the corners of the tile fit each other.
  for (const shift of [-size, 0, size]) {
    g.moveTo(shift, hatching === 1 ? size : 0);
    g.lineTo(shift + size, hatching === 1 ? 0 : size);
  }
  g.stroke();
  patterns.set(key, canvas);
  return canvas;
}

/** Returns what fills an area with parallel lines. */
export function hatch(g: CanvasRenderingContext2D, hatching: number, colour: string, ratio: number): CanvasPattern {
  const pattern = g.createPattern(tile(hatching, colour, ratio), "repeat")!;
  pattern.setTransform(new DOMMatrix().scale(1 / ratio));
  return pattern;
}
