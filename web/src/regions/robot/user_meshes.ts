/** The user's own description of the arm: its URDF and meshes, which the source reads from disk. No address is ever loaded. */

import { BufferGeometry, Float32BufferAttribute } from "three";
import { STLLoader } from "three/addons/loaders/STLLoader.js";
import type { Scene } from "../../source/messages.ts";
import { matrixOf, type Piece } from "./arm.ts";
import { readCollada } from "./collada.ts";
import type { Drawing } from "./drawing.ts";
import { addPart, noTriangles } from "./shapes.ts";
import { readUrdf, type Shape } from "./urdf.ts";

/** Reads a file that the URDF names. */
export type ReadFile = (name: string) => Promise<ArrayBuffer>;

/** Loads the meshes if the scene names a URDF; why they cannot be drawn is in `meshFault`. */
export async function userPieces(drawing: Drawing): Promise<void> {
  const { studio } = drawing;
  const scene = studio.scene.peek();
  const urdf = scene?.urdf;
  drawing.meshFault.value = "";
  if (scene === null || urdf === undefined) {
    drawing.pieces.value = null;
    return;
  }
  const read: ReadFile = async (file) => {
    const found = await studio.ask("mesh", { file });
    return Uint8Array.from(atob(found !== null && "base64" in found ? found.base64 : ""), (letter) => letter.charCodeAt(0)).buffer;
  };
  try {
    const found = await studio.ask("mesh");
    const pieces = await loadPieces(found !== null && "text" in found ? found.text : "", scene, read);
    if (studio.scene.peek() === scene) drawing.pieces.value = pieces;
  } catch (error) {
    if (studio.scene.peek() === scene) drawing.meshFault.value = `${urdf}: ${error instanceof Error ? error.message : String(error)}`;
  }
}

/** Returns the shapes of a URDF in the links of the arm. Throws an Error that says what is not understood. */
export async function loadPieces(urdf: string, scene: Pick<Scene, "robot" | "dh">, read: ReadFile): Promise<Piece[]> {
  const shapes = readUrdf(urdf, scene);
  const files = new Map<string, Promise<ArrayBuffer>>();
  for (const { form } of shapes) if (form.kind === "mesh" && !files.has(form.file)) files.set(form.file, read(form.file));
  const pieces = await Promise.all(shapes.map(async (shape) => piecesOfShape(shape, shape.form.kind === "mesh" ? await files.get(shape.form.file)! : null)));
  return pieces.flat();
}

function piecesOfShape(shape: Shape, bytes: ArrayBuffer | null): Piece[] {
  const place = matrixOf(shape.pose);
  const piece = (geometry: BufferGeometry, color = ""): Piece => ({ link: shape.link, role: "housing", color: shape.color || color, geometry: geometry.applyMatrix4(place) });
  const { form } = shape;
  if (form.kind !== "mesh") {
    const triangles = noTriangles();
    addPart(triangles, { link: shape.link, kind: form.kind, size: form.size, pose: [0, 0, 0, 0, 0, 0], role: "housing" });
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new Float32BufferAttribute(triangles.positions, 3));
    geometry.setAttribute("normal", new Float32BufferAttribute(triangles.normals, 3));
    geometry.setIndex(triangles.indices);
    return [piece(geometry)];
  }
  const read = READERS[form.file.slice(form.file.lastIndexOf(".") + 1).toLowerCase()];
  if (read === undefined) throw new Error(`mesh ${form.file} is neither STL nor Collada (.dae)`);
  let found: readonly Loaded[];
  try {
    found = read(bytes!);
  } catch (error) {
    throw new Error(`mesh ${form.file} is not understood: ${error instanceof Error ? error.message : String(error)}`);
  }
  if (found.every(({ geometry }) => geometry.getAttribute("position")?.count === 0)) throw new Error(`mesh ${form.file} has no triangles`);
  return found.map(({ geometry, color }) => piece(geometry.scale(...form.scale), color));
}

interface Loaded {
  readonly geometry: BufferGeometry;
  readonly color: string;
}

const READERS: { readonly [ending: string]: (bytes: ArrayBuffer) => readonly Loaded[] } = { stl: readStl, dae: readDae };

function readStl(bytes: ArrayBuffer): readonly Loaded[] {
  return [{ geometry: new STLLoader().parse(bytes), color: "" }];
}

function readDae(bytes: ArrayBuffer): readonly Loaded[] {
  return readCollada(new TextDecoder().decode(bytes)).map(({ positions, normals, color }) => {
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new Float32BufferAttribute(positions, 3));
    if (normals === null) geometry.computeVertexNormals();
    else geometry.setAttribute("normal", new Float32BufferAttribute(normals, 3));
    return { geometry, color };
  });
}
