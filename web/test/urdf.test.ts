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

// ---------------------------------------------------------------- bombs

/** Processor time: of a quadratic or exponential reader it would be minutes, whatever else this computer does. */
const CPU_MS = 15_000;
const cpuMs = () => process.cpuUsage().user / 1000;

function refusedSoon(read: () => unknown, why: RegExp) {
  const began = cpuMs();
  assert.throws(read, why);
  assert.ok(cpuMs() - began < CPU_MS, `${cpuMs() - began} ms`);
}

const stl = (facets: number, claimed = facets) => {
  const bytes = new ArrayBuffer(84 + 50 * facets);
  new DataView(bytes).setUint32(80, claimed, true);
  return bytes;
};
const ofText = (words: string) => new TextEncoder().encode(words).buffer as ArrayBuffer;
const mesh = (file: string) => urdf({ visual: `<geometry><mesh filename="${file}"/></geometry>` });

test("bombs: XML that is opened a million times and never closed", () => {
  for (const part of ["<!-- >", "<? >", "<![CDATA[ >", "<!a ", '<a b="', "<a ", "<a>", "</a>"]) {
    refusedSoon(() => readXml(part.repeat(1_000_000)), /./);
  }
});

test("bombs: links in more ways than can be counted, in a circle, too many, too deep", () => {
  const link = (n: number) => `<link name="x${n}"/>`;
  const joint = (from: string, to: string, name: string) => `<joint name="${name}" type="fixed"><parent link="${from}"/><child link="${to}"/></joint>`;
  const many = Array.from({ length: 60 }, (_, n) => link(n) + joint(n === 0 ? "tool0" : `x${n - 1}`, `x${n}`, `a${n}`) + joint(n === 0 ? "tool0" : `x${n - 1}`, `x${n}`, `b${n}`));
  refusedSoon(() => readUrdf(urdf({ extra: many.join("") }), CS66), /hangs on two joints/);
  const ring = link(0) + link(1) + joint("x0", "x1", "a") + joint("x1", "x0", "b");
  assert.ok(readUrdf(urdf({ extra: ring }), CS66).length > 0, "beside the arm");
  const chain = Array.from({ length: 20_000 }, (_, n) => link(n) + joint(n === 0 ? "tool0" : `x${n - 1}`, `x${n}`, `a${n}`));
  refusedSoon(() => readUrdf(urdf({ extra: chain.join("") }), CS66), /20009 links and 20008 joints; at most 1000/);
  const visual = '<geometry><box size="1 1 1"/></geometry></visual><visual>'.repeat(2000) + '<geometry><box size="1 1 1"/></geometry>';
  refusedSoon(() => readUrdf(urdf({ visual }), CS66), /shapes; at most 1000 are drawn/);
});

const STLS: readonly (readonly [string, ArrayBuffer, RegExp])[] = [
  ["claims four billion triangles", stl(1, 0xffffffff), /4294967295 triangles, which are 214748364834 bytes; it has 134/],
  ["is cut off", stl(3, 4), /says that it has 4 triangles/],
  ["is empty", new ArrayBuffer(0), /it has 0 bytes/],
  ["has more triangles than are drawn", stl(1_000_001), /more than 1,000,000 triangles/],
  ["begins facets that never end", ofText(`solid ${"facet ".repeat(2_000_000)}`), /has no triangles/],
  ["begins vertices that never end", ofText(`solid ${"vertex ".repeat(2_000_000)}`), /has no triangles/],
  ["has one endless number", ofText(`solid vertex ${"1".repeat(4_000_000)} 2 3`), /has no triangles/],
  ["ends within a triangle", ofText("solid a\nfacet normal 0 0 1\nouter loop\nvertex 1 2 3\nvertex 1 2 4\n"), /ends within a triangle/],
  ["has a corner at infinity", ofText("solid vertex 1e999 2 3 vertex 1 2 3 vertex 1 2 4"), /triangle 1 has a corner that is no place/],
];
for (const [what, bytes, why] of STLS) {
  test(`bombs: an STL that ${what}`, async () => {
    const began = cpuMs();
    await assert.rejects(loadPieces(mesh("a.stl"), CS66, () => Promise.resolve(bytes)), why);
    assert.ok(cpuMs() - began < CPU_MS);
  });
}

test("an STL as text and as bytes has the same triangles", async () => {
  const corners = [0, 0, 0, 1, 0, 0, 0, 1, 0];
  const bytes = stl(1);
  corners.forEach((value, index) => new DataView(bytes).setFloat32(84 + 12 + 4 * index, value, true));
  const words = ofText(`solid x\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1.0e0 0 0\n   vertex 0 1 0\n  endloop\n endfacet\nendsolid x\n`);
  const [first, second] = await Promise.all([bytes, words].map((given) => loadPieces(mesh("a.stl"), CS66, () => Promise.resolve(given))));
  assert.deepEqual([...first![0]!.geometry.getAttribute("position").array], [...second![0]!.geometry.getAttribute("position").array]);
  assert.equal(first![0]!.geometry.getAttribute("position").count, 3);
});

const dae = (nodes: string, p = "0 1 2", vcount = "") => `<COLLADA><library_geometries><geometry id="g"><mesh><source id="s"><float_array>0 0 0 1 0 0 0 1 0</float_array></source>
<vertices id="v"><input semantic="POSITION" source="#s"/></vertices>${vcount === "" ? "<triangles>" : `<polylist><vcount>${vcount}</vcount>`}<input semantic="VERTEX" source="#v" offset="0"/><p>${p}</p>${vcount === "" ? "</triangles>" : "</polylist>"}</mesh></geometry></library_geometries>
<library_nodes>${nodes}</library_nodes><library_visual_scenes><visual_scene id="z"><node><instance_node url="#n0"/></node></visual_scene></library_visual_scenes><scene><instance_visual_scene url="#z"/></scene></COLLADA>`;

test("bombs: a Collada file whose nodes name others again and again", () => {
  const doubled = Array.from({ length: 40 }, (_, n) => `<node id="n${n}">${`<instance_node url="#n${n + 1}"/>`.repeat(2)}</node>`).join("");
  refusedSoon(() => readCollada(dae(`${doubled}<node id="n40"><instance_geometry url="#g"/></node>`)), /more than 10,000 nodes/);
  const itself = '<node id="n0"><instance_node url="#n0"/></node>';
  refusedSoon(() => readCollada(dae(itself)), /more than 64 nodes inside of each other/);
});

test("bombs: polygons of more corners than there are", () => {
  const node = '<node id="n0"><instance_geometry url="#g"/></node>';
  for (const vcount of ["1e12", "Infinity", "-4", "NaN", "3 3"]) refusedSoon(() => readCollada(dae(node, "0 1 2", vcount)), /corners, which are not there|triangles/);
  refusedSoon(() => readCollada(dae(node, "0 1 2 ".repeat(1_000_001))), /more than 1,000,000 triangles/);
  refusedSoon(() => readCollada(dae(`<node id="n0"><scale>1e300 1 1</scale><scale>1e300 1 1</scale><instance_geometry url="#g"/></node>`)), /a corner that is no place/);
});

test("bombs: one file drawn a hundred times, and files without end", async () => {
  const visual = '<geometry><mesh filename="a.stl"/></geometry></visual><visual>'.repeat(99) + '<geometry><mesh filename="a.stl"/></geometry>';
  await assert.rejects(loadPieces(urdf({ visual }), CS66, () => Promise.resolve(stl(2000))), /more than 1,000,000 triangles/);
  const files = Array.from({ length: 101 }, (_, n) => `<geometry><mesh filename="${n}.stl"/></geometry>`).join("</visual><visual>");
  let read = 0;
  await assert.rejects(loadPieces(urdf({ visual: files }), CS66, () => Promise.resolve((read++, new ArrayBuffer(2 ** 22)))), /128 MB|is not understood/);
  assert.ok(read <= 33);
});
