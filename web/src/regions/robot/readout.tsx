/** The numbers of the picture: joints with their limits, and the pose of the TCP. */

import { format, unitOf } from "../../model/units.ts";
import { text } from "../../text/text.ts";
import type { Drawing } from "./drawing.ts";

const AXES = ["x", "y", "z", "rx", "ry", "rz"] as const;

/** A joint nearer to a limit than this is marked, rad. */
const NEAR_LIMIT_RAD = 0.1;

export function Readout({ drawing }: { drawing: Drawing }) {
  const { studio } = drawing;
  const scene = studio.scene.value!;
  const display = studio.display.value;
  const { joints } = drawing.drawn.value;
  const pose = drawing.tcpPose.value;
  const { position_min, position_max } = scene.limits;
  return (
    <div class="readout">
      <table>
        <caption>{text("robot_joints", { unit: unitOf("angle", display) })}</caption>
        <tbody>
          {joints.map((joint, index) => {
            const [low, high] = [position_min[index]!, position_max[index]!];
            const isNear = Math.min(joint - low, high - joint) < NEAR_LIMIT_RAD;
            const range = text("robot_joint_range", { joint: index + 1, low: format(low, "angle", display), high: format(high, "angle", display) });
            return (
              <tr key={index} class={isNear ? "near" : ""}>
                <th scope="row">
                  <button
                    type="button" aria-pressed={drawing.chosen.value === index} title={range}
                    onClick={() => (drawing.chosen.value = drawing.chosen.value === index ? null : index)}
                    onPointerEnter={() => (drawing.pointed.value = index)} onPointerLeave={() => (drawing.pointed.value = null)}
                    onFocus={() => (drawing.pointed.value = index)} onBlur={() => (drawing.pointed.value = null)}
                  >
                    <i style={{ background: `var(--joint-${index + 1})` }} />J{index + 1}
                  </button>
                </th>
                <td>{format(joint, "angle", display)}</td>
                <td class="meter" aria-hidden="true">
                  <i style={{ left: `${(100 * Math.min(1, Math.max(0, (joint - low) / (high - low)))).toFixed(1)}%` }} />
                </td>
                <td class="warning">{isNear && <abbr title={range}>{text("robot_near_limit")}</abbr>}</td>
              </tr>
            );
          })}
        </tbody>
      </table>
      <table>
        <caption>{text("robot_tcp", { length: unitOf("length", display), angle: unitOf("angle", display) })}</caption>
        <tbody>
          {AXES.map((axis, index) => (
            <tr key={axis}>
              <th scope="row">{axis}</th>
              <td>{format(pose[index]!, index < 3 ? "length" : "angle", display)}</td>
            </tr>
          ))}
        </tbody>
      </table>
    </div>
  );
}
