/** An arm as objects of three.js: one group for each link, moved by the frames of the kinematics. */

import {
  BufferGeometry, Color, EqualDepth, Float32BufferAttribute, Group, LessEqualDepth, LineBasicMaterial, LineSegments, type Material, Matrix4, Mesh,
  MeshBasicMaterial, MeshLambertMaterial, MeshPhongMaterial, type Object3D, IncrementStencilOp, NotEqualStencilFunc,
} from "three";
import type { Transform } from "../../model/kinematics.ts";
import type { Part } from "../../source/messages.ts";
import type { Palette } from "./palette.ts";
import { addPart, boxEdges, noTriangles, type Triangles } from "./shapes.ts";

const LINKS = 8;

export function matrixOf(t: Transform, to = new Matrix4()): Matrix4 {
  return to.set(t[0], t[1], t[2], t[9], t[3], t[4], t[5], t[10], t[6], t[7], t[8], t[11], 0, 0, 0, 1);
}

/** Triangles of one look in the frame of one link. */
export interface Piece {
  readonly link: number;
  readonly role: Part["role"];
  readonly color: string;
  readonly geometry: BufferGeometry;
}

/** Returns the parts of a scene as few pieces: one for each link, role and colour. */
export function piecesOf(parts: readonly Part[]): Piece[] {
  const found = new Map<string, { part: Part; triangles: Triangles }>();
  for (const part of parts) {
    const key = `${part.link} ${part.role} ${part.color ?? ""}`;
    const entry = found.get(key) ?? { part, triangles: noTriangles() };
    addPart(entry.triangles, part);
    found.set(key, entry);
  }
  return [...found.values()].map(({ part, triangles }) => {
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new Float32BufferAttribute(triangles.positions, 3));
    geometry.setAttribute("normal", new Float32BufferAttribute(triangles.normals, 3));
    geometry.setIndex(triangles.indices);
    return { link: part.link, role: part.role, color: part.color ?? "", geometry };
  });
}

/** How pieces are drawn. */
export type Look = (piece: Piece) => readonly Material[];

export class ArmObject {
  readonly group = new Group();
  private readonly links: Group[] = [];
  private readonly materials = new Set<Material>();

  constructor(pieces: readonly Piece[], look: Look) {
    for (let link = 0; link < LINKS; link++) {
      const group = new Group();
      group.matrixAutoUpdate = false;
      this.links.push(group);
      this.group.add(group);
    }
    for (const piece of pieces) {
      for (const material of look(piece)) {
        this.materials.add(material);
        const mesh = new Mesh(piece.geometry, material);
        mesh.renderOrder = Number(material.userData["order"] ?? 0);
        mesh.userData["link"] = piece.link;
        this.add(piece.link, mesh);
      }
    }
  }

  add(link: number, object: Object3D): void {
    this.links[link]?.add(object);
  }

  pose(frames: readonly Transform[]): void {
    frames.forEach((frame, link) => {
      const group = this.links[link]!;
      matrixOf(frame, group.matrix);
      group.matrixWorldNeedsUpdate = true;
    });
  }

  dispose(): void {
    this.group.removeFromParent();
    for (const material of this.materials) material.dispose();
    for (const link of this.links) for (const object of link.children) if (object instanceof LineSegments) object.geometry.dispose();
  }
}

// ---------------------------------------------------------------- looks

/** Plastic, paint and metal; the same material for the same colour. */
export function solidLook(palette: Palette): Look {
  const made = new Map<string, Material>();
  return ({ role, color }) => {
    const key = `${role} ${color}`;
    let material = made.get(key);
    if (material === undefined) {
      const paint = new Color(palette.parts[role]);
      if (/^#[0-9a-f]{6}$/i.test(color)) paint.set(color);
      const isShiny = role === "housing" || role === "tube" || role === "cap" || role === "flange";
      material = isShiny
        ? new MeshPhongMaterial({ color: paint, specular: role === "flange" ? 0x666666 : 0x2a2a2a, shininess: 42, emissive: role === "cap" ? paint.clone().multiplyScalar(0.3) : 0 })
        : new MeshLambertMaterial({ color: paint });
      // Grid and shadow lie on top of a table whose top is the floor of the base.
      if (role === "thing") Object.assign(material, { polygonOffset: true, polygonOffsetFactor: 1, polygonOffsetUnits: 2 });
      made.set(key, material);
    }
    return [material];
  };
}

/** An arm that one sees through: only its nearest surface. With stripes, for readers who do not see the colour. */
export function ghostLook(colour: string, opacity: number, hasStripes: boolean): Look {
  const depth = new MeshBasicMaterial({ colorWrite: false, depthFunc: LessEqualDepth });
  depth.userData["order"] = 10;
  const surface = new MeshLambertMaterial({ color: colour, transparent: true, opacity, depthFunc: EqualDepth, depthWrite: false });
  surface.userData["order"] = 11;
  if (hasStripes) {
    surface.onBeforeCompile = (shader) => {
      shader.fragmentShader = shader.fragmentShader.replace(
        "#include <clipping_planes_fragment>",
        "#include <clipping_planes_fragment>\nif (mod(gl_FragCoord.x + gl_FragCoord.y, 8.0) < 4.0) discard;",
      );
    };
    surface.customProgramCacheKey = () => "stripes";
  }
  const looks = [depth, surface];
  return ({ role }) => (role === "thing" ? [] : looks);
}

/** A shadow straight down, each pixel darkened once. */
export function shadowLook(palette: Palette): Look {
  const material = new MeshBasicMaterial({
    color: palette.shadow, transparent: true, opacity: palette.isDark ? 0.4 : 0.13, depthWrite: false,
    stencilWrite: true, stencilRef: 1, stencilFunc: NotEqualStencilFunc, stencilZPass: IncrementStencilOp,
  });
  material.userData["order"] = -5;
  const looks = [material];
  return ({ role, link }) => (role === "thing" || link === 0 ? [] : looks);
}

/** Edges of boxes, which keep their form at low contrast. */
export function edgesOf(parts: readonly Part[], palette: Palette): { readonly link: number; readonly object: LineSegments }[] {
  const material = new LineBasicMaterial({ color: palette.ink, transparent: true, opacity: 0.35 });
  return parts
    .filter(({ kind, role }) => kind === "box" && (role === "thing" || role === "tool" || role === "payload"))
    .map((part) => {
      const geometry = new BufferGeometry();
      geometry.setAttribute("position", new Float32BufferAttribute(boxEdges(part).flat(), 3));
      return { link: part.link, object: new LineSegments(geometry, material) };
    });
}
