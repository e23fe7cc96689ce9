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
  editor_name: "程序文本",
  editor_scroller: "程序文本滚动区",
  editor_times: "每行时间",
  editor_hints: "提示",
  editor_hint: "提示：{hint}",
  editor_line_time: "运动 {moving} s，静止 {standing} s，{visits} 次",
  editor_empty: "没有程序：请打开文件或从示例开始。",
  editor_on_controller: "程序在控制器上。",
  editor_no_text: "记录中没有程序文本。",
  editor_new_name: "新名称",
  editor_no_name: "此处没有名称。",
  editor_no_definition: "本文中没有定义。",
  editor_uses: "{count} 处使用",
  editor_no_fix: "此处没有可用的修复。",
  editor_formatted: "已格式化。",
  editor_nothing_to_format: "无需格式化。",

  // ---- Robot

  // ---- Time line

  // ---- lists

  // ---- Pendant

  // ---- compare and share
};
