/**
 * Frames of the arm: forward kinematics of the modified Denavit-Hartenberg rule, and poses.
 *
 * A transform is the rotation, row by row, then the position in m, as in Python's `elitescript.kinematics.transforms`.
 */

import type { Scene, Six } from "../source/messages.ts";

export type Transform = readonly [
  number, number, number, number, number, number, number, number, number, number, number, number,
];
export type Point = readonly [number, number, number];

export const IDENTITY: Transform = [1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0];

/** Number of `Part.link` for the flange. */
export const FLANGE = 7;

/** Returns the pose in frame a of what has pose `t` in frame b. */
export function compose(a: Transform, t: Transform): Transform {
  return [
    a[0] * t[0] + a[1] * t[3] + a[2] * t[6], a[0] * t[1] + a[1] * t[4] + a[2] * t[7], a[0] * t[2] + a[1] * t[5] + a[2] * t[8],
    a[3] * t[0] + a[4] * t[3] + a[5] * t[6], a[3] * t[1] + a[4] * t[4] + a[5] * t[7], a[3] * t[2] + a[4] * t[5] + a[5] * t[8],
    a[6] * t[0] + a[7] * t[3] + a[8] * t[6], a[6] * t[1] + a[7] * t[4] + a[8] * t[7], a[6] * t[2] + a[7] * t[5] + a[8] * t[8],
    ...apply(a, [t[9], t[10], t[11]]),
  ];
}

/** Returns a point of frame b in frame a. */
export function apply(a: Transform, [x, y, z]: Point): Point {
  return [
    a[0] * x + a[1] * y + a[2] * z + a[9],
    a[3] * x + a[4] * y + a[5] * z + a[10],
    a[6] * x + a[7] * y + a[8] * z + a[11],
  ];
}

/** Reads a pose with a rotation vector: solids, the TCP in the flange frame, the mounting. */
export function fromRotationVector([px, py, pz, x, y, z]: Six): Transform {
  const angle = Math.hypot(x, y, z);
  const sine = angle < 1e-9 ? 1 : Math.sin(angle) / angle;
  const half = angle < 1e-9 ? 0.5 : 2 * (Math.sin(angle / 2) / angle) ** 2;
  const [kx, ky, kz] = [half * x, half * y, half * z];
  const c = 1 - (kx * x + ky * y + kz * z);
  return [
    c + kx * x, kx * y - sine * z, kx * z + sine * y,
    kx * y + sine * z, c + ky * y, ky * z - sine * x,
    kx * z - sine * y, ky * z + sine * x, c + kz * z,
    px, py, pz,
  ];
}

/** Reads a pose of the TCP: roll, pitch and yaw, R = Rz(rz) Ry(ry) Rx(rx). */
export function fromRollPitchYaw([px, py, pz, rx, ry, rz]: Six): Transform {
  const [cx, sx, cy, sy, cz, sz] = [Math.cos(rx), Math.sin(rx), Math.cos(ry), Math.sin(ry), Math.cos(rz), Math.sin(rz)];
  return [
    cz * cy, cz * sy * sx - sz * cx, cz * sy * cx + sz * sx,
    sz * cy, sz * sy * sx + cz * cx, sz * sy * cx - cz * sx,
    -sy, cy * sx, cy * cx,
    px, py, pz,
  ];
}

/** Pitch this close to a quarter turn leaves only the sum of roll and yaw, rad; roll is then 0, as on the controller. */
const GIMBAL_MARGIN = 1e-12;

/** Returns a pose with roll, pitch and yaw. */
export function toRollPitchYaw(t: Transform): Six {
  const ry = Math.atan2(-t[6], Math.hypot(t[0], t[3]));
  if (Math.abs(ry) <= Math.PI / 2 - GIMBAL_MARGIN) return [t[9], t[10], t[11], Math.atan2(t[7], t[8]), ry, Math.atan2(t[3], t[0])];
  return [t[9], t[10], t[11], 0, ry, Math.atan2(-t[1], t[4])];
}

/** Returns the frames of `Part.link` in the base frame: base, six links, flange. */
export function linkFrames(dh: Scene["dh"], joints: Six): readonly Transform[] {
  const frames = [IDENTITY];
  dh.forEach(({ a, d, alpha }, index) => {
    const [ca, sa, c, s] = [Math.cos(alpha), Math.sin(alpha), Math.cos(joints[index]!), Math.sin(joints[index]!)];
    frames.push(compose(frames[index]!, [c, -s, 0, ca * s, ca * c, -sa, sa * s, sa * c, ca, a, -sa * d, ca * d]));
  });
  frames.push(frames.at(-1)!); // the last frame lies in the flange
  return frames;
}

/** Returns the pose of the TCP in the base frame. */
export function tcpFrame(scene: Pick<Scene, "dh" | "tcp">, joints: Six): Transform {
  return compose(linkFrames(scene.dh, joints)[FLANGE]!, fromRotationVector(scene.tcp));
}

/** Turns of each joint towards a point that nothing reaches; more change nothing that can be seen. */
const STRETCHES = 60;

/** Returns joints that bring the TCP near to a point, within the ranges of the joints: an arm stretched towards it where it is out of reach. */
export function stretchedTo(scene: Pick<Scene, "dh" | "tcp" | "limits">, from: Six, [x, y, z]: Point): Six {
  const joints = [...from] as [number, number, number, number, number, number];
  for (let turn = 0; turn < STRETCHES; turn++) {
    for (let joint = 5; joint >= 0; joint--) {
      const frames = linkFrames(scene.dh, joints);
      const frame = frames[joint + 1]!;
      const tcp = compose(frames[FLANGE]!, fromRotationVector(scene.tcp));
      // Both points seen along the axis of the joint, which is z of its frame.
      const angle = ([px, py, pz]: Point) => {
        const [dx, dy, dz] = [px - frame[9], py - frame[10], pz - frame[11]];
        return Math.atan2(frame[1] * dx + frame[4] * dy + frame[7] * dz, frame[0] * dx + frame[3] * dy + frame[6] * dz);
      };
      const difference = angle([x, y, z]) - angle([tcp[9], tcp[10], tcp[11]]);
      const shortest = Math.atan2(Math.sin(difference), Math.cos(difference));
      joints[joint] = Math.min(Math.max(joints[joint]! + shortest, scene.limits.position_min[joint]!), scene.limits.position_max[joint]!);
    }
  }
  return joints;
}
