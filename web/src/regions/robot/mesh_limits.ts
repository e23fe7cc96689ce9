/** How large a description of an arm may be: a page that draws it must not hang or run out of memory. */

export const LINKS_MAX = 1000;
/** Shapes of all links. */
export const SHAPES_MAX = 1000;
export const FILES_MAX = 200;
/** Of all files together; the source gives none that is larger than 32 MB. */
export const BYTES_MAX = 128 * 2 ** 20;
/** Of all shapes together. */
export const TRIANGLES_MAX = 1_000_000;
/** Nodes of a Collada scene, each time that it is placed: nodes that name others many times have no end. */
export const NODES_MAX = 10_000;

const shown = (count: number) => count.toLocaleString("en-US");

/** Counts what is read, and throws an Error when it is too much. */
export class MeshBudget {
  private triangles = 0;
  private nodes = 0;
  private bytes = 0;

  takeTriangles(count: number): void {
    this.triangles += count;
    if (!(this.triangles <= TRIANGLES_MAX)) throw new Error(`there are more than ${shown(TRIANGLES_MAX)} triangles: simplify the meshes`);
  }

  takeNode(): void {
    if (++this.nodes > NODES_MAX) throw new Error(`there are more than ${shown(NODES_MAX)} nodes`);
  }

  takeBytes(count: number): void {
    this.bytes += count;
    if (this.bytes > BYTES_MAX) throw new Error(`the meshes have more than ${BYTES_MAX / 2 ** 20} MB`);
  }
}
