/** Names at points of the scene, as text over the canvas. */

import { type Camera, type Matrix4, Vector3 } from "three";
import type { Point } from "../../model/kinematics.ts";

export interface Label {
  readonly text: string;
  readonly point: Point;
  readonly kind: "axis" | "name" | "ghost" | "asked" | "contact" | "distance" | "limit low" | "limit high";
  readonly colour?: string;
}

export class Labels {
  private readonly host: HTMLElement;
  private readonly used: HTMLElement[] = [];
  private readonly at = new Vector3();

  constructor(host: HTMLElement) {
    this.host = host;
  }

  place(labels: readonly Label[], world: Matrix4, camera: Camera, width: number, height: number): void {
    while (this.used.length > labels.length) this.used.pop()!.remove();
    /** Bottom of the boxes so far: they stand below each other where they would cover one another. */
    const boxes: { left: number; right: number; top: number; bottom: number }[] = [];
    labels.forEach((label, index) => {
      const element = (this.used[index] ??= this.host.appendChild(document.createElement("span")));
      if (element.textContent !== label.text) element.textContent = label.text;
      if (element.className !== label.kind) element.className = label.kind;
      if (element.style.color !== (label.colour ?? "")) element.style.color = label.colour ?? "";
      this.at.set(...label.point).applyMatrix4(world).project(camera);
      const isIn = this.at.z > -1 && this.at.z < 1;
      let [x, y] = [(0.5 + this.at.x / 2) * width, (0.5 - this.at.y / 2) * height];
      if (isIn && isBox(label)) {
        const [wide, tall] = [element.offsetWidth, element.offsetHeight];
        x = Math.max(EDGE_PX, Math.min(x + BESIDE_PX, width - wide - EDGE_PX));
        // That of an alarm is long: at the top, where a fitted picture leaves room, it does not cover the arm.
        y = label.kind === "asked" ? TOP_PX : Math.max(EDGE_PX, Math.min(y - tall - BESIDE_PX, height - tall - EDGE_PX));
        if (label.kind === "asked") x = EDGE_PX;
        for (const box of boxes) if (x < box.right && x + wide > box.left && y < box.bottom && y + tall > box.top) y = box.bottom + 2;
        boxes.push({ left: x, right: x + wide, top: y, bottom: y + tall });
      }
      element.style.transform = isIn ? `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)` : "translate(-9999px, 0)";
    });
  }
}

const EDGE_PX = 6;
const BESIDE_PX = 10;
/** Room of the buttons at the top. */
const TOP_PX = 44;

/** Whether a label is a box that has to be read, so that it stays inside of the picture. */
function isBox({ kind }: Label): boolean {
  return kind === "asked" || kind === "contact" || kind === "distance";
}
