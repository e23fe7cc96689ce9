/**
 * Reads a URDF: the shapes of its links, and which link of our arm each of them moves with.
 *
 * The shapes move by our kinematics, so the joints of the description have to be those of the arm: the same axes, in the
 * same places, with the same zero. Only the direction in which its base looks may differ.
 */

import { compose, fromRollPitchYaw, IDENTITY, linkFrames, type Point, type Transform } from "../../model/kinematics.ts";
import type { Part, Scene, Six } from "../../source/messages.ts";
import { LINKS_MAX, SHAPES_MAX } from "./mesh_limits.ts";
import { child, children, type Element, readXml } from "./xml.ts";

/** A shape in the frame of a link of the arm, as `Part.link` counts. */
export interface Shape {
  readonly link: number;
  readonly pose: Transform;
  readonly color: string;
  readonly form: { readonly kind: "mesh"; readonly file: string; readonly scale: Point } | Pick<Part, "size"> & { readonly kind: "box" | "cylinder" | "sphere" };
}

interface Visual {
  readonly origin: Transform;
  readonly color: string;
  readonly form: Shape["form"];
}

interface Joint {
  readonly name: string;
  readonly type: string;
  readonly parent: string;
  readonly child: string;
  readonly origin: Transform;
  readonly axis: Point;
}

const JOINTS = 6;
/** How far the axes of the description may be from those of the arm: measured arms differ from their model by less. */
const OFF_M = 0.005;
const OFF_RAD = 0.02;

/** Returns the shapes of a description for an arm. Throws an Error that says what is not understood. */
export function readUrdf(text: string, scene: Pick<Scene, "robot" | "dh">): Shape[] {
  if (/<xacro:|xmlns:xacro/.test(text)) throw new Error("it is a xacro: expand it first (xacro FILE > FILE.urdf)");
  const robot = readXml(text);
  if (robot.name !== "robot") throw new Error(`line ${robot.line}: the outermost element is <${robot.name}>, not <robot>`);
  const [linkCount, jointCount] = [children(robot, "link").length, children(robot, "joint").length];
  if (Math.max(linkCount, jointCount) > LINKS_MAX) throw new Error(`it has ${linkCount} links and ${jointCount} joints; at most ${LINKS_MAX} are read`);
  const colours = new Map(children(robot, "material").map((material) => [material.attributes["name"] ?? "", colourOf(material)]));
  const links = new Map(children(robot, "link").map((link) => [named(link), visualsOf(link, colours)]));
  const joints = children(robot, "joint").map(readJoint);
  for (const { name, parent, child: other } of joints) {
    for (const link of [parent, other]) if (!links.has(link)) throw new Error(`joint ${name} names a link ${link} that there is not`);
  }
  const hangs = new Set<string>();
  for (const { child: link } of joints) {
    // Else there would be more ways through the tree than can be counted.
    if (hangs.has(link)) throw new Error(`link ${link} hangs on two joints, or on itself`);
    hangs.add(link);
  }
  const places = placed(links, joints);
  const frames = linkFrames(scene.dh, [0, 0, 0, 0, 0, 0] as unknown as Six);
  const turn = baseTurn(places.axes, frames);
  checkAxes(places.axes, frames, turn, scene.robot);
  const shapes: Shape[] = [];
  for (const [link, visuals] of links) {
    const place = places.links.get(link);
    if (place === undefined) continue;
    for (const { origin, color, form } of visuals) {
      const pose = compose(inverse(frames[place.moved]!), compose(turn, compose(place.frame, origin)));
      shapes.push({ link: place.moved, pose, color, form });
    }
  }
  if (shapes.length > SHAPES_MAX) throw new Error(`it has ${shapes.length} shapes; at most ${SHAPES_MAX} are drawn`);
  if (shapes.length === 0) throw new Error("none of its links has a <visual>");
  return shapes;
}

interface Places {
  /** Frame of each link with all joints at zero, and the number of joints that move it. */
  readonly links: ReadonlyMap<string, { readonly frame: Transform; readonly moved: number }>;
  /** Point and direction of each of the six axes. */
  readonly axes: readonly { readonly joint: string; readonly at: Point; readonly direction: Point }[];
}

function placed(links: ReadonlyMap<string, unknown>, joints: readonly Joint[]): Places {
  const hanging = new Set(joints.map((joint) => joint.child));
  const roots = [...links.keys()].filter((link) => !hanging.has(link));
  if (roots.length !== 1) throw new Error(`it has ${roots.length} links that hang on no joint (${roots.slice(0, 3).join(", ")}); one is needed`);
  // The arm: the way through the tree with six joints that turn.
  const chain = longest(roots[0]!, joints).filter(({ type }) => turns(type)).slice(0, JOINTS);
  if (chain.length < JOINTS) throw new Error(`it has ${chain.length} joints that turn one after the other; an arm has ${JOINTS}`);
  const found = new Map([[roots[0]!, { frame: IDENTITY, moved: 0 }]]);
  const axes: Places["axes"][number][] = [];
  const walk = (link: string) => {
    const { frame, moved } = found.get(link)!;
    for (const joint of joints.filter(({ parent }) => parent === link)) {
      if (found.has(joint.child)) throw new Error(`link ${joint.child} hangs on two joints, or on itself`);
      const next = compose(frame, joint.origin);
      const index = chain.indexOf(joint);
      found.set(joint.child, { frame: next, moved: index >= 0 ? index + 1 : moved });
      if (index >= 0) axes[index] = { joint: joint.name, at: [next[9], next[10], next[11]], direction: rotated(next, joint.axis) };
      walk(joint.child);
    }
  };
  walk(roots[0]!);
  return { links: found, axes };
}

function turns(type: string): boolean {
  return type === "revolute" || type === "continuous";
}

function longest(link: string, joints: readonly Joint[], depth = 0): readonly Joint[] {
  if (depth > joints.length) throw new Error("its joints go round in a circle");
  const ways = joints.filter(({ parent }) => parent === link).map((joint) => [joint, ...longest(joint.child, joints, depth + 1)]);
  const count = (way: readonly Joint[]) => way.filter(({ type }) => turns(type)).length;
  return ways.reduce<readonly Joint[]>((best, way) => (count(way) > count(best) || best.length === 0 ? way : best), []);
}

/** The turn about z that takes the second axis of the description to that of the arm: bases of descriptions look either way. */
function baseTurn(axes: Places["axes"], frames: readonly Transform[]): Transform {
  const [x, y] = axes[1]!.direction;
  const wanted = frames[2]!;
  return fromRollPitchYaw([0, 0, 0, 0, 0, Math.atan2(wanted[5], wanted[2]) - Math.atan2(y, x)]);
}

function checkAxes(axes: Places["axes"], frames: readonly Transform[], turn: Transform, robot: string): void {
  axes.forEach(({ joint, at, direction }, index) => {
    const frame = frames[index + 1]!;
    const wanted: Point = [frame[2], frame[5], frame[8]];
    const found = rotated(turn, direction);
    const cosine = found[0] * wanted[0] + found[1] * wanted[1] + found[2] * wanted[2];
    const angle = Math.acos(Math.min(1, Math.max(-1, cosine)));
    if (!(angle <= OFF_RAD)) {
      throw new Error(`axis ${index + 1} (${joint}) points ${((angle * 180) / Math.PI).toFixed(1)} deg away from that of the ${robot}: a description of another arm, or with another zero`);
    }
    // Distance of the two lines: what is across the axis counts.
    const place = rotated(turn, at);
    const off: Point = [place[0] - frame[9], place[1] - frame[10], place[2] - frame[11]];
    const along = off[0] * wanted[0] + off[1] * wanted[1] + off[2] * wanted[2];
    const distance = Math.hypot(off[0] - along * wanted[0], off[1] - along * wanted[1], off[2] - along * wanted[2]);
    if (!(distance <= OFF_M)) {
      throw new Error(`axis ${index + 1} (${joint}) is ${(1000 * distance).toFixed(1)} mm from that of the ${robot}: a description of another arm, or with another zero`);
    }
  });
}

function readJoint(element: Element): Joint {
  const name = named(element);
  const link = (role: string) => {
    const found = child(element, role)?.attributes["link"];
    if (found === undefined) throw new Error(`line ${element.line}: joint ${name} has no <${role} link="...">`);
    return found;
  };
  const axis = numbers(child(element, "axis"), "xyz", [1, 0, 0]) as unknown as Point;
  const length = Math.hypot(...axis);
  if (!(length > 0)) throw new Error(`line ${element.line}: the axis of joint ${name} has no direction`);
  return {
    name, type: element.attributes["type"] ?? "", parent: link("parent"), child: link("child"), origin: originOf(element),
    axis: [axis[0] / length, axis[1] / length, axis[2] / length],
  };
}

function visualsOf(link: Element, colours: ReadonlyMap<string, string>): Visual[] {
  return children(link, "visual").map((visual) => {
    const material = child(visual, "material");
    const color = material === undefined ? "" : colourOf(material) || (colours.get(material.attributes["name"] ?? "") ?? "");
    return { origin: originOf(visual), color, form: formOf(visual) };
  });
}

function formOf(visual: Element): Shape["form"] {
  const form = child(visual, "geometry")?.children[0];
  switch (form?.name) {
    case "mesh": {
      const file = form.attributes["filename"];
      if (file === undefined) throw new Error(`line ${form.line}: a mesh without a filename`);
      return { kind: "mesh", file, scale: numbers(form, "scale", [1, 1, 1]) as unknown as Point };
    }
    case "box":
      return { kind: "box", size: numbers(form, "size") };
    case "cylinder":
      return { kind: "cylinder", size: [...numbers(form, "radius", undefined, 1), ...numbers(form, "length", undefined, 1)] };
    case "sphere":
      return { kind: "sphere", size: numbers(form, "radius", undefined, 1) };
    default:
      throw new Error(`line ${(form ?? visual).line}: a geometry that is no mesh, box, cylinder or sphere`);
  }
}

function originOf(element: Element): Transform {
  const origin = child(element, "origin");
  return fromRollPitchYaw([...numbers(origin, "xyz", [0, 0, 0]), ...numbers(origin, "rpy", [0, 0, 0])] as unknown as Six);
}

/** Returns the numbers of an attribute; `absent` where there is none. */
function numbers(element: Element | undefined, name: string, absent?: readonly number[], count = 3): readonly number[] {
  const text = element?.attributes[name];
  if (text === undefined && absent !== undefined) return absent;
  const found = (text ?? "").trim().split(/\s+/).map(Number);
  if (text === undefined || found.length !== count || !found.every(Number.isFinite)) {
    throw new Error(`line ${element?.line ?? 0}: ${name}="${text ?? ""}" has to be ${count} number${count === 1 ? "" : "s"}`);
  }
  return found;
}

function named(element: Element): string {
  const name = element.attributes["name"];
  if (name === undefined) throw new Error(`line ${element.line}: a <${element.name}> without a name`);
  return name;
}

function colourOf(material: Element): string {
  const rgba = child(material, "color")?.attributes["rgba"]?.trim().split(/\s+/).map(Number);
  if (rgba === undefined || rgba.length < 3 || !rgba.every(Number.isFinite)) return "";
  return `#${rgba.slice(0, 3).map((value) => Math.round(255 * Math.min(1, Math.max(0, value))).toString(16).padStart(2, "0")).join("")}`;
}

function rotated(t: Transform, [x, y, z]: Point): Point {
  return [t[0] * x + t[1] * y + t[2] * z, t[3] * x + t[4] * y + t[5] * z, t[6] * x + t[7] * y + t[8] * z];
}

function inverse(t: Transform): Transform {
  const back: Transform = [t[0], t[3], t[6], t[1], t[4], t[7], t[2], t[5], t[8], 0, 0, 0];
  const [x, y, z] = rotated(back, [t[9], t[10], t[11]]);
  return [t[0], t[3], t[6], t[1], t[4], t[7], t[2], t[5], t[8], -x, -y, -z];
}
