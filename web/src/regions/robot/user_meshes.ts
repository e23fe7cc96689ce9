/** The user's own description of the arm: its URDF and meshes, which the source reads from disk. No address is ever loaded. */

import { BufferGeometry, Float32BufferAttribute } from "three";
import type { Scene } from "../../source/messages.ts";
import { matrixOf, type Piece } from "./arm.ts";
import { readCollada } from "./collada.ts";
import type { Drawing } from "./drawing.ts";
import { FILES_MAX, MeshBudget } from "./mesh_limits.ts";
import { addPart, noTriangles } from "./shapes.ts";
import { readStl } from "./stl.ts";
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
  const budget = new MeshBudget();
  const meshes = new Map<string, readonly Loaded[]>();
  // One after the other: all of them at once are more than a link takes.
  for (const { form } of shapes) {
    if (form.kind !== "mesh" || meshes.has(form.file)) continue;
    if (meshes.size === FILES_MAX) throw new Error(`it names more than ${FILES_MAX} files`);
    meshes.set(form.file, meshOf(form.file, await read(form.file), budget));
  }
  // What is drawn more than once counts more than once.
  return shapes.flatMap((shape) => piecesOfShape(shape, shape.form.kind === "mesh" ? meshes.get(shape.form.file)! : null, budget));
}

/** Reads a file. Throws an Error that names it. */
function meshOf(file: string, bytes: ArrayBuffer, budget: MeshBudget): readonly Loaded[] {
  const read = READERS[file.slice(file.lastIndexOf(".") + 1).toLowerCase()];
  if (read === undefined) throw new Error(`mesh ${file} is neither STL nor Collada (.dae)`);
  let found: readonly Loaded[];
  try {
    budget.takeBytes(bytes.byteLength);
    found = read(bytes, budget);
  } catch (error) {
    throw new Error(`mesh ${file} is not understood: ${error instanceof Error ? error.message : String(error)}`);
  }
  if (found.every(({ geometry }) => geometry.getAttribute("position")?.count === 0)) throw new Error(`mesh ${file} has no triangles`);
  return found;
}

function piecesOfShape(shape: Shape, mesh: readonly Loaded[] | null, budget: MeshBudget): Piece[] {
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
  return mesh!.map(({ geometry, color }) => {
    budget.takeTriangles(geometry.getAttribute("position").count / 3);
    return piece(geometry.clone().scale(...form.scale), color);
  });
}

interface Loaded {
  readonly geometry: BufferGeometry;
  readonly color: string;
}

const READERS: { readonly [ending: string]: (bytes: ArrayBuffer, budget: MeshBudget) => readonly Loaded[] } = { stl: ofStl, dae: ofCollada };

function ofStl(bytes: ArrayBuffer, budget: MeshBudget): readonly Loaded[] {
  const geometry = new BufferGeometry();
  geometry.setAttribute("position", new Float32BufferAttribute(readStl(bytes, budget), 3));
  geometry.computeVertexNormals();
  return [{ geometry, color: "" }];
}

function ofCollada(bytes: ArrayBuffer, budget: MeshBudget): readonly Loaded[] {
  return readCollada(new TextDecoder().decode(bytes), budget).map(({ positions, normals, color }) => {
    const geometry = new BufferGeometry();
    geometry.setAttribute("position", new Float32BufferAttribute(positions, 3));
    if (normals === null) geometry.computeVertexNormals();
    else geometry.setAttribute("normal", new Float32BufferAttribute(normals, 3));
    return { geometry, color };
  });
}
