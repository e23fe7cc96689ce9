/** Every text that people read, in Chinese. */

import type { Texts } from "./en.ts";

export const zh: Texts = {
  region_program: "程序",
  region_problems: "问题",
  region_robot: "机器人",
  region_variables: "变量",
  region_signals: "信号",
  region_threads: "线程",
  region_timeline: "时间线",
  region_messages: "消息",
  region_cycle: "节拍时间",
  region_pendant: "示教器",
};
