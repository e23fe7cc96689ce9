import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { test } from "node:test";
import { compose, FLANGE, fromRollPitchYaw, fromRotationVector, IDENTITY, linkFrames, tcpFrame, toRollPitchYaw } from "../src/model/kinematics.ts";
import type { Scene, Six } from "../src/source/messages.ts";

type Arm = Pick<Scene, "robot" | "dh" | "tcp"> & { cases: { joints: Six; flange: number[]; tcp_pose: Six }[] };

// Printed by Python's closed forms (`Arm.forward`), another way of computing than the chain of links here.
const ARMS = JSON.parse(readFileSync(new URL("kinematics.json", import.meta.url), "utf8")) as Arm[];

function assertNear(found: readonly number[], wanted: readonly number[], tolerance = 1e-9) {
  assert.equal(found.length, wanted.length);
  found.forEach((value, index) => assert.ok(Math.abs(value - wanted[index]!) <= tolerance, `${index}: ${value} for ${wanted[index]}`));
}

for (const arm of ARMS) {
  test(`the flange and the TCP of a ${arm.robot}`, () => {
    for (const { joints, flange, tcp_pose } of arm.cases) {
      assertNear(linkFrames(arm.dh, joints)[FLANGE]!, flange);
      assertNear(toRollPitchYaw(tcpFrame(arm, joints)), tcp_pose);
    }
  });
}

test("by hand: a CS66 stretched along -x has its flange at a2 + a3, d4 + d6 to the side, d5 below the shoulder", () => {
  const arm = ARMS.find(({ robot }) => robot === "CS66")!;
  const frames = linkFrames(arm.dh, [0, 0, 0, 0, 0, 0]);
  assertNear(frames[FLANGE]!.slice(9), [-0.427 - 0.3905, -(0.1475 + 0.092), 0.1625 - 0.0965]);
  assertNear(frames[1]!.slice(9), [0, 0, 0.1625]);
  assertNear(frames[3]!.slice(9), [-0.427, 0, 0.1625]);
  assert.equal(frames.length, FLANGE + 1);
});

test("poses: a quarter turn about z, either way of writing it", () => {
  const wanted = [0, -1, 0, 1, 0, 0, 0, 0, 1, 1, 2, 3];
  assertNear(fromRotationVector([1, 2, 3, 0, 0, Math.PI / 2]), wanted);
  assertNear(fromRollPitchYaw([1, 2, 3, 0, 0, Math.PI / 2]), wanted);
  assertNear(fromRotationVector([1, 2, 3, 0, 0, 0]), [...IDENTITY.slice(0, 9), 1, 2, 3]);
});

test("poses: roll, pitch and yaw come back, and at a pitch of a quarter turn as yaw alone", () => {
  const pose: Six = [0.1, -0.2, 0.3, 0.4, -0.5, 2.6];
  assertNear(toRollPitchYaw(fromRollPitchYaw(pose)), pose);
  assertNear(toRollPitchYaw(fromRollPitchYaw([0, 0, 0, 0.3, Math.PI / 2, 0.5])), [0, 0, 0, 0, Math.PI / 2, 0.2]);
  const turned = compose(fromRollPitchYaw([0, 0, 0, 0, 0, Math.PI / 2]), fromRollPitchYaw([1, 0, 0, 0, 0, 0]));
  assertNear(turned.slice(9), [0, 1, 0]);
});
