import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { compose, linkFrames, type Transform } from "../src/model/kinematics.ts";
import { readCollada } from "../src/regions/robot/collada.ts";
import { readUrdf } from "../src/regions/robot/urdf.ts";
import { loadPieces } from "../src/regions/robot/user_meshes.ts";
import { readXml } from "../src/regions/robot/xml.ts";
import type { Scene, Six } from "../src/source/messages.ts";

type Arm = Pick<Scene, "robot" | "dh">;
const CS66 = (JSON.parse(readFileSync(new URL("kinematics.json", import.meta.url), "utf8")) as Arm[]).find(({ robot }) => robot === "CS66")!;

const JOINTS: readonly (readonly [xyz: string, rpy: string])[] = [
  ["0 0 0.1625", "0 0 0"], ["0 0 0", "1.5707963267948966 0 0"], ["-0.427 0 0", "0 0 0"],
  ["-0.3905 0 0.1475", "0 0 0"], ["0 -0.0965 0", "1.5707963267948966 0 0"], ["0 0.092 0", "-1.5707963267948966 0 0"],
];

/** A CS66 whose base looks the other way, as vendors' descriptions have it, with a box of 1 cm in every link. */
function urdf({ joints = JOINTS, extra = "", visual = '<geometry><box size="0.01 0.01 0.01"/></geometry>' } = {}): string {
  const link = (name: string) => `<link name="${name}"><visual><origin xyz="0.1 0 0"/>${visual}</visual></link>`;
  return `<?xml version="1.0"?>
<robot name="mine"><!-- by hand -->
  <material name="blue"><color rgba="0 0 1 1"/></material>
  <link name="world"/>
  <joint name="mount" type="fixed"><parent link="world"/><child link="l0"/><origin rpy="0 0 3.141592653589793"/></joint>
  ${["l0", "l1", "l2", "l3", "l4", "l5", "l6", "tool0"].map(link).join("\n  ")}
  ${joints.map(([xyz, rpy], i) => `<joint name="j${i + 1}" type="revolute"><parent link="l${i}"/><child link="l${i + 1}"/><origin xyz="${xyz}" rpy="${rpy}"/><axis xyz="0 0 1"/></joint>`).join("\n  ")}
  <joint name="end" type="fixed"><parent link="l6"/><child link="tool0"/></joint>${extra}
</robot>`;
}

function near(found: readonly number[], wanted: readonly number[]) {
  found.forEach((value, index) => assert.ok(Math.abs(value - wanted[index]!) < 1e-9, `${index}: ${value} for ${wanted[index]}`));
}

test("shapes hang on the links of the arm, whichever way the base of the description looks", () => {
  const shapes = readUrdf(urdf(), CS66);
  assert.deepEqual(shapes.map(({ link }) => link), [0, 1, 2, 3, 4, 5, 6, 6]);
  // Link 3 of the description has the frame of the third joint: its box is 0.1 m along x of that.
  near(shapes[3]!.pose, [1, 0, 0, 0, 1, 0, 0, 0, 1, 0.1, 0, 0]);
  const joints: Six = [0.3, -1, 0.7, 0.2, -0.4, 1];
  const elbow: Transform = compose(linkFrames(CS66.dh, joints)[3]!, shapes[3]!.pose);
  near(elbow.slice(9), compose(linkFrames(CS66.dh, joints)[3]!, [1, 0, 0, 0, 1, 0, 0, 0, 1, 0.1, 0, 0]).slice(9));
});

test("a further joint, such as of a gripper, moves with the last link", () => {
  const extra = '<link name="finger"><visual><geometry><sphere radius="0.01"/></geometry></visual></link><joint name="grip" type="prismatic"><parent link="tool0"/><child link="finger"/></joint>';
  const finger = readUrdf(urdf({ extra }), CS66).at(-1)!;
  assert.deepEqual([finger.link, finger.form], [6, { kind: "sphere", size: [0.01] }]);
});

test("colours of materials, by name or in place", () => {
  const visual = (material: string) => `${material}<geometry><box size="1 1 1"/></geometry>`;
  assert.equal(readUrdf(urdf({ visual: visual('<material name="blue"/>') }), CS66)[0]!.color, "#0000ff");
  assert.equal(readUrdf(urdf({ visual: visual('<material name="x"><color rgba="1 0.5 0 1"/></material>') }), CS66)[0]!.color, "#ff8000");
});

const REFUSED: readonly (readonly [string, string, RegExp])[] = [
  ["a xacro", '<robot xmlns:xacro="http://x"/>', /xacro: expand it first/],
  ["other XML", "<html/>", /line 1: the outermost element is <html>, not <robot>/],
  ["no XML", "hello", /no element/],
  ["an element that stays open", "<robot>\n<link name='a'>\n</robot>", /line 3: <\/robot> closes nothing; <link> of line 2 is open/],
  ["five joints", urdf({ joints: JOINTS.slice(0, 5) }).replace('<parent link="l6"/>', '<parent link="l5"/>').replace(/<link name="l6">.*\n/, ""), /5 joints that turn/],
  ["another arm", urdf({ joints: JOINTS.map((joint, i) => (i === 2 ? ["-0.6 0 0", "0 0 0"] : joint)) }), /axis 3 \(j3\) is 173\.0 mm from that of the CS66/],
  ["another zero", urdf({ joints: JOINTS.map((joint, i) => (i === 4 ? ["0 -0.0965 0", "1.5707963267948966 0.5 0"] : joint)) }), /axis 6 \(j6\) points 28\.6 deg away/],
  ["a form that is none", urdf({ visual: "<geometry><blob/></geometry>" }), /no mesh, box, cylinder or sphere/],
  ["a number that is none", urdf({ visual: '<geometry><box size="1 x 1"/></geometry>' }), /size="1 x 1" has to be 3 numbers/],
  ["a link that there is not", urdf({ extra: '<joint name="k" type="fixed"><parent link="nowhere"/><child link="l1"/></joint>' }), /joint k names a link nowhere/],
  ["joints in a circle", urdf({ extra: '<joint name="k" type="fixed"><parent link="tool0"/><child link="l1"/></joint>' }), /circle|hangs on two joints/],
];

for (const [what, text, why] of REFUSED) {
  test(`refused: ${what}`, () => void assert.throws(() => readUrdf(text, CS66), why));
}

test("XML: comments, entities, either quote", () => {
  const root = readXml(`<?xml version="1.0"?><!-- <a> --><r a='1 &lt; "2"' b="3">\n<c/></r>`);
  assert.deepEqual([root.attributes, root.children.map(({ name, line }) => [name, line])], [{ a: '1 < "2"', b: "3" }, [["c", 2]]]);
});

const STL = "solid a\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 2 0 0\nvertex 0 2 0\nendloop\nendfacet\nendsolid a\n";
const bytes = (text: string) => new TextEncoder().encode(text).buffer as ArrayBuffer;

async function load(mesh: string, content: string) {
  const asked: string[] = [];
  const visual = `<geometry><mesh filename="${mesh}" scale="0.001 0.001 0.001"/></geometry>`;
  const pieces = await loadPieces(urdf({ visual }), CS66, async (file) => {
    asked.push(file);
    return bytes(content);
  });
  return { asked, pieces };
}

test("a mesh is read once, scaled and placed in its link", async () => {
  const { asked, pieces } = await load("package://mine/a.stl", STL);
  assert.deepEqual(asked, ["package://mine/a.stl"]);
  assert.equal(pieces.length, 8);
  const { geometry, link } = pieces[3]!;
  geometry.computeBoundingBox();
  assert.equal(link, 3);
  near(geometry.boundingBox!.max.toArray().map((value) => Math.round(1e6 * value) / 1e6), [0.102, 0.002, 0]);
});

const DAE = `<?xml version="1.0"?><COLLADA xmlns="x"><asset><unit meter="0.001"/><up_axis>Y_UP</up_axis></asset>
<library_effects><effect id="e"><profile_COMMON><technique sid="c"><phong><diffuse><color>1 0 0 1</color></diffuse></phong></technique></profile_COMMON></effect></library_effects>
<library_materials><material id="m"><instance_effect url="#e"/></material></library_materials>
<library_geometries><geometry id="g"><mesh>
<source id="p"><float_array id="pa" count="12">0 0 0 2 0 0 2 2 0 0 2 0</float_array></source>
<source id="n"><float_array id="na" count="3">0 0 1</float_array></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<polylist material="paint" count="1"><input semantic="VERTEX" source="#v" offset="0"/><input semantic="NORMAL" source="#n" offset="1"/><vcount>4</vcount><p>0 0 1 0 2 0 3 0</p></polylist>
</mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node><translate>10 0 0</translate><node><rotate>0 0 1 90</rotate><scale>2 2 2</scale>
<instance_geometry url="#g"><bind_material><technique_common><instance_material symbol="paint" target="#m"/></technique_common></bind_material></instance_geometry></node></node></visual_scene></library_visual_scenes>
<scene><instance_visual_scene url="#s"/></scene></COLLADA>`;

test("Collada: unit, nested nodes, polygons, normals and colours", () => {
  const [surface, ...others] = readCollada(DAE);
  assert.equal(others.length, 0);
  const millimetres = surface!.positions.map((value) => Math.round(1e6 * value) / 1e3 + 0);
  assert.deepEqual(millimetres, [10, 0, 0, 10, 4, 0, 6, 4, 0, 10, 0, 0, 6, 4, 0, 6, 0, 0]);
  near(surface!.normals!, Array.from({ length: 18 }, (_, i) => (i % 3 === 2 ? 1 : 0)));
  assert.equal(surface!.color, "#ff0000");
});

test("Collada: what is wrong is named", () => {
  assert.throws(() => readCollada("<robot/>"), /line 1: the outermost element is <robot>/);
  assert.throws(() => readCollada(DAE.replace("2 0 3 0</p>", "2 0 9 0</p>")), /line 8: a corner without a point/);
  assert.throws(() => readCollada(DAE.replace('<node><rotate>', '<node id="k"><instance_node url="#k"/><rotate>')), /64 nodes inside of each other/);
});

test("a Collada mesh has the colour of its material", async () => {
  const { pieces } = await load("meshes/a.dae", DAE);
  assert.equal(pieces[0]!.color, "#ff0000");
});

test("meshes that are not understood are named", async () => {
  await assert.rejects(load("a.obj", ""), /mesh a\.obj is neither STL nor Collada/);
  await assert.rejects(load("a.stl", "solid a\nendsolid a\n"), /mesh a\.stl (has no triangles|is not understood)/);
});
