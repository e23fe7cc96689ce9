/** Lines of the scene: paths with a colour for each point, axes, arcs. */

import { BufferGeometry, Color, Float32BufferAttribute, GreaterDepth, LineBasicMaterial, LineSegments, type Object3D } from "three";
import { LineMaterial } from "three/addons/lines/LineMaterial.js";
import { LineSegments2 } from "three/addons/lines/LineSegments2.js";
import { LineSegmentsGeometry } from "three/addons/lines/LineSegmentsGeometry.js";
import { type Path, type PathPart, speedColour, straights } from "../../model/path.ts";
import type { Point } from "../../model/kinematics.ts";

export interface Stroke {
  readonly width_px: number;
  readonly colour?: string;
  readonly opacity?: number;
  readonly isDashed?: boolean;
  /** Drawn over everything. */
  readonly isOnTop?: boolean;
  /** Only what something hides. */
  readonly isHidden?: boolean;
  readonly order?: number;
}

/** A set of line pieces, which can be given anew. */
export class LineObject {
  readonly object: LineSegments2;
  private readonly stroke: Stroke;

  constructor(parent: Object3D, stroke: Stroke) {
    this.stroke = stroke;
    const opacity = stroke.opacity ?? 1;
    const material = new LineMaterial({
      linewidth: stroke.width_px, transparent: opacity < 1, opacity, vertexColors: stroke.colour === undefined,
      dashed: stroke.isDashed ?? false, dashSize: 0.012, gapSize: 0.008, depthTest: !stroke.isOnTop,
      ...(stroke.colour === undefined ? {} : { color: new Color(stroke.colour).getHex() }),
      ...(stroke.isHidden ? { depthFunc: GreaterDepth, depthWrite: false } : {}),
    });
    this.object = new LineSegments2(new LineSegmentsGeometry(), material);
    this.object.renderOrder = stroke.order ?? (stroke.isOnTop ? 20 : 0);
    this.object.frustumCulled = false;
    this.object.visible = false;
    parent.add(this.object);
  }

  /** Shows pieces: pairs of points, with a colour for each point unless the stroke has one. */
  set(positions: Float32Array | number[], colours?: Float32Array): void {
    this.object.visible = positions.length > 0;
    if (positions.length === 0) return;
    this.object.geometry.dispose();
    const geometry = new LineSegmentsGeometry();
    geometry.setPositions(positions);
    if (colours !== undefined) geometry.setColors(colours);
    this.object.geometry = geometry;
    if (this.stroke.isDashed) this.object.computeLineDistances();
  }

  /** The same pieces as another object has. */
  share(other: LineObject): void {
    this.object.geometry = other.object.geometry;
    this.object.visible = other.object.visible;
  }

  dispose(): void {
    this.object.removeFromParent();
    this.object.geometry.dispose();
    this.object.material.dispose();
  }
}

/** Returns the pieces of a path, or of parts of it, for `LineObject.set`. */
export function strokesOf(path: Path, speed_end: number, isDark: boolean, parts?: readonly PathPart[]): [Float32Array, Float32Array] {
  const shades = shadesOf(isDark);
  const ends = straights(path, speed_end, parts);
  const positions = new Float32Array(3 * ends.length);
  const colours = new Float32Array(3 * ends.length);
  ends.forEach((point, index) => {
    const shade = 3 * Math.min(SHADES - 1, Math.round((path.speed[point]! / speed_end) * (SHADES - 1)));
    for (let k = 0; k < 3; k++) {
      positions[3 * index + k] = path.xyz[3 * point + k]!;
      colours[3 * index + k] = shades[shade + k]!;
    }
  });
  return [positions, colours];
}

const SHADES = 64;

/** Colours of speeds in the space in which light is added. */
function shadesOf(isDark: boolean): Float32Array {
  const shades = new Float32Array(3 * SHADES);
  const colour = new Color();
  for (let i = 0; i < SHADES; i++) {
    const [r, g, b] = speedColour(i / (SHADES - 1), isDark);
    colour.setRGB(r / 255, g / 255, b / 255, "srgb").toArray(shades, 3 * i);
  }
  return shades;
}

/** A path in lines of one pixel, which cost a software renderer a hundredth of wide ones. */
export class HairObject {
  readonly object = new LineSegments(new BufferGeometry(), new LineBasicMaterial({ vertexColors: true }));

  constructor(parent: Object3D) {
    this.object.frustumCulled = false;
    parent.add(this.object);
  }

  set(positions: Float32Array, colours: Float32Array): void {
    this.object.visible = positions.length > 0;
    this.object.geometry.dispose();
    this.object.geometry = new BufferGeometry();
    this.object.geometry.setAttribute("position", new Float32BufferAttribute(positions, 3));
    this.object.geometry.setAttribute("color", new Float32BufferAttribute(colours, 3));
  }

  dispose(): void {
    this.object.removeFromParent();
    this.object.geometry.dispose();
    this.object.material.dispose();
  }
}

/** Returns a line through points as pieces. */
export function piecesThrough(points: readonly Point[]): number[] {
  const pieces: number[] = [];
  for (let i = 0; i + 1 < points.length; i++) pieces.push(...points[i]!, ...points[i + 1]!);
  return pieces;
}
