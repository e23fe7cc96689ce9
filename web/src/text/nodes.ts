/** What graphical programs are made of, in the language of the page: sources name it in English. */

import { language } from "./language.ts";

/** Kinds of nodes as the pendant names them in Chinese. */
const KINDS: { readonly [english: string]: string } = {
  "Initial variables": "初始化变量", "Before start": "启动前", "Main task": "主任务", "Sub-task": "子任务", Call: "调用子任务",
  Folder: "文件夹", "Script line": "脚本行", "Script file": "脚本文件", If: "如果", "Else if": "否则如果", Else: "否则", Loop: "循环",
  Switch: "开关", Case: "情况", Waypoint: "路点", Arc: "圆弧", Direction: "方向", Until: "直到", Wait: "等待", Set: "设置",
  Assignment: "赋值", Halt: "停机", Popup: "弹出窗口", Timer: "计时器", Comment: "注释", Thread: "线程", Event: "事件",
  Placeholder: "占位节点", "Plugin node": "插件节点", "Unknown node": "未知节点",
};

/** Words of what a node does; values stay as they are. */
const WORDS: readonly (readonly [RegExp, string])[] = [
  [/^for ever$/, "无限循环"], [/^once$/, "一次"], [/^(\d+) times$/, "$1 次"], [/^suppressed$/, "已停用"], [/^variable$/, "变量"], [/^relative$/, "相对"], [/^never taught$/, "未示教"],
  [/^while (.*)$/, "当 $1"], [/^tested after a turn$/, "循环后检查"], [/^tested all the time$/, "持续检查"],
  [/^(.*) is high$/, "$1 为高"], [/^(.*) is low$/, "$1 为低"], [/^(.*) = high$/, "$1 = 高"], [/^(.*) = low$/, "$1 = 低"],
  [/^at most (.*)$/, "最多 $1"], [/^blend (.*)$/, "交融 $1"], [/^frame (.*)$/, "坐标系 $1"], [/^joints (.*)$/, "关节 $1"], [/^pose (.*)$/, "位姿 $1"],
];

/** The name of a kind of node. */
export function kindOf(english: string): string {
  return language.value === "zh" ? (KINDS[english] ?? english) : english;
}

/** What a node does. */
export function summaryOf(english: string): string {
  if (language.value !== "zh" || english === "") return english;
  // Values in brackets hold commas of their own.
  const parts = english.split(/, (?![^[]*\])/);
  const chinese = parts.map((part) => WORDS.reduce((known, [from, to]) => known.replace(from, to), part));
  // What has no words of ours, such as a statement, stays as it is written.
  return chinese.some((part, index) => part !== parts[index]) ? chinese.join("，") : english;
}
