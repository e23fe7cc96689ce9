/**
 * Reads the triangles and plain colours of a Collada file.
 *
 * Descriptions of robots mean the coordinates as they are in the file: its unit counts, its upright axis does not
 * (*assumed*, as viewers of such descriptions do). Textures, skins and animations are left out.
 */

import { apply, compose, fromRotationVector, IDENTITY, type Point, type Transform } from "../../model/kinematics.ts";
import { MeshBudget } from "./mesh_limits.ts";
import { child, children, type Element, readXml } from "./xml.ts";

export interface Surface {
  /** Corners of triangles, m. */
  readonly positions: number[];
  /** Of each corner; null where the file has none. */
  readonly normals: number[] | null;
  /** `#rrggbb`, or empty. */
  readonly color: string;
}

/** A transform with any scale: the three axes and the origin. */
type Affine = Transform;

/** Returns the surfaces of a file. Throws an Error that says what is not understood. */
export function readCollada(text: string, budget: MeshBudget = new MeshBudget()): Surface[] {
  const root = readXml(text);
  if (root.name !== "COLLADA") throw new Error(`line ${root.line}: the outermost element is <${root.name}>, not <COLLADA>`);
  const file = new File(root, budget);
  const metres = Number(child(child(root, "asset"), "unit")?.attributes["meter"] ?? 1);
  const scale: Affine = [metres, 0, 0, 0, metres, 0, 0, 0, metres, 0, 0, 0];
  const scene = file.named(child(child(root, "scene"), "instance_visual_scene")?.attributes["url"]);
  if (scene === undefined) return children(child(root, "library_geometries"), "geometry").flatMap((geometry) => file.surfaces(geometry, scale, new Map()));
  return children(scene, "node").flatMap((node) => file.node(node, scale, 0));
}

/** Nodes inside of each other at most: files that name themselves have no end. */
const DEPTH_MAX = 64;

class File {
  private readonly byId = new Map<string, Element>();
  private readonly arrays = new Map<Element, Float64Array>();

  private readonly budget: MeshBudget;

  constructor(root: Element, budget: MeshBudget) {
    this.budget = budget;
    const all = [root];
    for (let element = all.pop(); element !== undefined; element = all.pop()) {
      const id = element.attributes["id"];
      if (id !== undefined) this.byId.set(id, element);
      for (const inner of element.children) all.push(inner);
    }
  }

  /** Returns the element of an address in the file, `#id`. */
  named(url: string | undefined): Element | undefined {
    return url?.startsWith("#") ? this.byId.get(url.slice(1)) : undefined;
  }

  node(node: Element, parent: Affine, depth: number): Surface[] {
    this.budget.takeNode();
    if (depth > DEPTH_MAX) throw new Error(`line ${node.line}: more than ${DEPTH_MAX} nodes inside of each other`);
    const place = node.children.reduce((sum, step) => compose(sum, stepOf(step)), parent);
    return node.children.flatMap((element) => {
      const target = this.named(element.attributes["url"]);
      if (element.name === "node") return this.node(element, place, depth + 1);
      if (element.name === "instance_node" && target !== undefined) return this.node(target, place, depth + 1);
      if (element.name !== "instance_geometry" || target === undefined) return [];
      const bound = children(child(child(element, "bind_material"), "technique_common"), "instance_material");
      return this.surfaces(target, place, new Map(bound.map(({ attributes }) => [attributes["symbol"] ?? "", this.colour(attributes["target"])])));
    });
  }

  /** Returns the colour of a material. */
  private colour(url: string | undefined): string {
    const effect = this.named(child(this.named(url), "instance_effect")?.attributes["url"]);
    const technique = child(child(effect, "profile_COMMON"), "technique");
    for (const shading of technique?.children ?? []) {
      const rgba = child(child(shading, "diffuse"), "color")?.text.trim().split(/\s+/).map(Number);
      if (rgba !== undefined && rgba.length >= 3 && rgba.every(Number.isFinite)) {
        return `#${rgba.slice(0, 3).map((value) => Math.round(255 * Math.min(1, Math.max(0, value))).toString(16).padStart(2, "0")).join("")}`;
      }
    }
    return "";
  }

  surfaces(geometry: Element, place: Affine, colours: ReadonlyMap<string, string>): Surface[] {
    const mesh = child(geometry, "mesh");
    return (mesh?.children ?? []).filter(({ name }) => name === "triangles" || name === "polylist").map((faces) => {
      const inputs = children(faces, "input");
      const width = 1 + Math.max(...inputs.map(({ attributes }) => Number(attributes["offset"] ?? 0)));
      const offset = (semantic: string) => inputs.find(({ attributes }) => attributes["semantic"] === semantic);
      const vertex = offset("VERTEX");
      const points = this.values(child(this.named(vertex?.attributes["source"]), "input")?.attributes["source"]);
      if (vertex === undefined || points === null) throw new Error(`line ${faces.line}: a surface without points`);
      const normal = offset("NORMAL");
      const directions = this.values(normal?.attributes["source"]);
      const corners = triangulated(faces, integers(child(faces, "p")), width, this.budget);
      const positions: number[] = [];
      const normals: number[] = [];
      for (const corner of corners) {
        const point = apply(place, three(points, corner[Number(vertex.attributes["offset"] ?? 0)]!, faces));
        if (!point.every(Number.isFinite)) throw new Error(`line ${faces.line}: a corner that is no place`);
        positions.push(...point);
        if (directions !== null) normals.push(...turned(place, three(directions, corner[Number(normal!.attributes["offset"] ?? 0)]!, faces)));
      }
      return { positions, normals: directions === null ? null : normals, color: colours.get(faces.attributes["material"] ?? "") ?? "" };
    });
  }

  /** Returns the numbers of a source. */
  private values(url: string | undefined): Float64Array | null {
    const array = child(this.named(url), "float_array");
    if (array === undefined) return null;
    let found = this.arrays.get(array);
    if (found === undefined) this.arrays.set(array, (found = Float64Array.from(array.text.trim().split(/\s+/), Number)));
    return found;
  }
}

function integers(element: Element | undefined): readonly number[] {
  return element === undefined || element.text.trim() === "" ? [] : element.text.trim().split(/\s+/).map(Number);
}

/** Returns the indices of each corner of triangles; polygons are cut into fans. */
function triangulated(faces: Element, indices: readonly number[], width: number, budget: MeshBudget): (readonly number[])[] {
  const corner = (number: number) => indices.slice(number * width, (number + 1) * width);
  const counts = faces.name === "polylist" ? integers(child(faces, "vcount")) : new Array<number>(Math.floor(indices.length / width / 3)).fill(3);
  budget.takeTriangles(counts.reduce((sum, count) => sum + Math.max(0, count - 2), 0));
  const corners: (readonly number[])[] = [];
  let first = 0;
  for (const count of counts) {
    if (!(count >= 0 && (first + count) * width <= indices.length)) throw new Error(`line ${faces.line}: a polygon of ${count} corners, which are not there`);
    for (let k = 1; k + 1 < count; k++) corners.push(corner(first), corner(first + k), corner(first + k + 1));
    first += count;
  }
  return corners;
}

function three(values: Float64Array, index: number, faces: Element): Point {
  const [x, y, z] = values.subarray(3 * index, 3 * index + 3);
  if (x === undefined || y === undefined || z === undefined || !Number.isFinite(x + y + z)) throw new Error(`line ${faces.line}: a corner without a point`);
  return [x, y, z];
}

/** Returns a normal in the frame of the scene, of length 1; scales are the same in all directions. */
function turned(t: Affine, [x, y, z]: Point): Point {
  const [a, b, c] = [t[0] * x + t[1] * y + t[2] * z, t[3] * x + t[4] * y + t[5] * z, t[6] * x + t[7] * y + t[8] * z];
  const length = Math.hypot(a, b, c) || 1;
  return [a / length, b / length, c / length];
}

function stepOf({ name, text }: Element): Affine {
  const n = () => text.trim().split(/\s+/).map(Number) as unknown as Affine;
  switch (name) {
    case "matrix": {
      const [xx, xy, xz, x, yx, yy, yz, y, zx, zy, zz, z] = n();
      return [xx, xy, xz, yx, yy, yz, zx, zy, zz, x, y, z];
    }
    case "translate":
      return [1, 0, 0, 0, 1, 0, 0, 0, 1, n()[0], n()[1], n()[2]];
    case "scale":
      return [n()[0], 0, 0, 0, n()[1], 0, 0, 0, n()[2], 0, 0, 0];
    case "rotate": {
      const [x, y, z, degrees] = n();
      const angle = (degrees * Math.PI) / 180 / (Math.hypot(x, y, z) || 1);
      return fromRotationVector([0, 0, 0, x * angle, y * angle, z * angle]);
    }
    default:
      return IDENTITY;
  }
}
