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

  // ---- toolbar, layout, keys
  not_saved: "未保存：{why}",
  not_opened: "未能打开 {name}：{why}",
  link_lost: "与数据源的连接已断开。",
  file_gone: "{name} 已从磁盘上删除。保存会重新写入该文件。",
  file_read_again: "{name} 已在磁盘上更改，已重新读取。",
  no_state: "无法得到该时刻的状态：{why}",

  // ---- Program

  // ---- Robot

  // ---- Time line

  // ---- lists

  // ---- Pendant

  // ---- compare and share
};
