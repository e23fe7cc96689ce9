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
  robot_fit: "适合窗口 (F)",
  robot_fit_short: "适合",
  robot_front: "前视图 (1)",
  robot_front_short: "前",
  robot_side: "侧视图 (2)",
  robot_side_short: "侧",
  robot_top: "俯视图 (3)",
  robot_top_short: "俯",
  robot_iso: "等轴测视图 (4)",
  robot_iso_short: "等轴测",
  robot_reach: "工作半径球面",
  robot_reach_short: "工作半径",
  robot_views: "机器人视图",
  robot_keys: "方向键旋转视图，加 Shift 平移；加号和减号缩放。",
  robot_none: "尚无机器人。",
  robot_no_webgl: "此浏览器不提供 WebGL：机器人以俯视和侧视的平面图绘制。",
  robot_mesh_fault: "未绘制您的网格模型。{why}",
  robot_speed: "TCP 速度，{unit}",
  robot_stale: "先前的运行",
  robot_compared: "对比的运行",
  robot_target: "目标",
  robot_asked: "请求的位姿",
  robot_words: "{robot}，{t}：TCP 位于 x {x}、y {y}、z {z}；关节 {joints} {unit}。",
  robot_words_line: "第 {line} 行。",
  robot_words_asked: "报警：{why}。",
  robot_words_contacts: "接触：{count} 处。",
  robot_contact: "{first} – {second}：重叠 {millimetres} mm",
  robot_closest: "{first} – {second}：相距 {millimetres} mm",
  robot_joints: "关节，{unit}",
  robot_joint_range: "关节 {joint}：{low} 至 {high}",
  robot_near_limit: "限位",
  robot_tcp: "基坐标系中的 TCP，{length} 和 {angle}",

  // ---- Time line

  // ---- lists

  // ---- Pendant

  // ---- compare and share
};
