/** Names at points of the scene, as text over the canvas. */

import { type Camera, type Matrix4, Vector3 } from "three";
import type { Point } from "../../model/kinematics.ts";

export interface Label {
  readonly text: string;
  readonly point: Point;
  readonly kind: "axis" | "name" | "ghost" | "asked" | "contact" | "limit" | "target" | "compared";
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
    labels.forEach((label, index) => {
      const element = (this.used[index] ??= this.host.appendChild(document.createElement("span")));
      if (element.textContent !== label.text) element.textContent = label.text;
      if (element.className !== label.kind) element.className = label.kind;
      if (element.style.color !== (label.colour ?? "")) element.style.color = label.colour ?? "";
      this.at.set(...label.point).applyMatrix4(world).project(camera);
      const isIn = this.at.z > -1 && this.at.z < 1;
      const [x, y] = [(0.5 + this.at.x / 2) * width, (0.5 - this.at.y / 2) * height];
      element.style.transform = isIn ? `translate(${x.toFixed(1)}px, ${y.toFixed(1)}px)` : "translate(-999px, 0)";
    });
  }
}
