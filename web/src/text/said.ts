/**
 * What sources say in English, in the language of the page: reasons of waits, notices, refusals, words of channels.
 *
 * A source knows nothing of the language of a page. Each row is a sentence of ours with its values as `{1}`, `{2}`, in
 * the order of the English sentence. What is in no row is shown as it came: words of programs, and of controllers. A
 * test reads the sentences from the sources in Python and asks for a row of each.
 */

import { language } from "./language.ts";

export const SAID: readonly (readonly [english: string, chinese: string])[] = [
  // What threads wait for.
  ["{1}, until {2} s", "{1}，直到 {2} s"],
  ["{1}, which it holds itself", "{1}，由其自身持有"],
  ["{1}, held by {2}, which has ended", "{1}，由已结束的 {2} 持有"],
  ["{1}, held by {2}", "{1}，由 {2} 持有"],
  ["the end of its move", "其运动结束"],
  ["the time of its target", "其目标的时间"],
  ["the time of its speed", "其速度的时间"],
  ["its speed", "其速度"],
  ["time to go by", "时间经过"],
  ["its texts to leave", "其文本送出"],
  ["somebody to resume the program", "有人恢复程序"],
  ["somebody to confirm a popup", "有人确认弹窗"],
  ["the debugger", "调试器"],
  ["a lock", "一个锁"],
  ["lock {1}", "锁 {1}"],
  ["the next tick", "下一个控制周期"],
  ["a statement of interpreter mode", "解释器模式的语句"],
  ["a process to end", "一个进程结束"],
  ["the end of thread {1}", "线程 {1} 结束"],
  ["the MODBUS device at {1}", "位于 {1} 的 MODBUS 设备"],
  ["{1}:{2} to accept a connection", "{1}:{2} 接受连接"],
  ["room to send on socket {1}", "套接字 {1} 的发送空间"],
  ["room to send on {1}", "{1} 的发送空间"],
  ["{1} to open", "{1} 打开"],
  ["data on socket {1}", "套接字 {1} 上的数据"],
  ["the answer of slave {1} on {2}", "从站 {1} 在 {2} 上的应答"],
  ["the answer of {1}() from {2}", "来自 {2} 的 {1}() 应答"],
  ["{1} bytes on {2}", "{2} 上的 {1} 个字节"],
  // What channels say.
  ["socket", "套接字"],
  ["serial", "串口"],
  ["by the other side", "由对方"],
  ["connection refused", "连接被拒绝"],
  ["the address is not known", "地址未知"],
  ["closed at once", "立即关闭"],
  // What faults report.
  ["fault", "故障"],
  ["{1} on port {2} acts", "端口 {2} 上的 {1} 生效"],
  ["{1} on {2} acts", "{2} 上的 {1} 生效"],
  // Programs to begin with.
  ["First moves: joints, straight lines, a rounded corner", "第一批运动：关节运动、直线、圆角过渡"],
  ["Pick and place: a gripper, and a function for what is done twice", "抓取与放置：夹爪，以及重复动作的函数"],
  ["Wait for an input: a part arrives, a thread watches the light barrier", "等待输入：工件到达，线程监视光栅"],
  // Live runs.
  ["line {1} does not return: the run was ended after {2} s in which no time went by", "第 {1} 行不返回：{2} s 内时间没有推进，运行已结束"],
  ["the process of the run has ended ({1}); the next text is run again", "运行进程已结束（{1}）；下一个文本将重新运行"],
  ["the process that checks the text has ended ({1}); the next text is checked again", "检查文本的进程已结束（{1}）；下一个文本将重新检查"],
  ["the process that starts runs had ended and was started again", "启动运行的进程曾结束，已重新启动"],
  ["no process can be started: {1}", "无法启动进程：{1}"],
  ["this run is not shown any more", "此运行已不再显示"],
  ["a newer moment is asked for", "已请求更新的时刻"],
  ["a run with real connections cannot be repeated: its moments and details are not known", "带真实连接的运行无法重复：其各时刻与细节未知"],
  ["this moment is not found within {1} s", "{1} s 内未找到此时刻"],
  ["there is no thread {1} at this moment", "此时刻没有线程 {1}"],
  ["{1} steps wait", "已有 {1} 个单步在等待"],
  ["the run is held after {1} s of computing, at {2} s of robot time; it can go on", "计算 {1} s 后运行被暂停在机器人时间 {2} s；可以继续"],
  ["it took too long", "耗时过长"],
  ["while it looked for a moment", "在查找时刻时"],
  ["while it recorded a run", "在记录运行时"],
  ["while it computed a detail", "在计算细节时"],
  ["exit code {1}", "退出码 {1}"],
  ["signal {1}", "信号 {1}"],
  ["a live run has no controller: start the studio with --connect", "实时运行没有控制器：请用 --connect 启动 studio"],
  // Files, drafts, settings, services.
  ["{1}: no folder is open, so {2} cannot be read", "{1}：没有打开文件夹，无法读取 {2}"],
  ["{1}: {2} is outside of the opened folder", "{1}：{2} 在打开的文件夹之外"],
  ["cannot open {1}: {2}; it stays as it is", "无法打开 {1}：{2}；保持原样"],
  ["cannot read {1}: it {2}", "无法读取 {1}：它 {2}"],
  ["cannot read {1}: {2}", "无法读取 {1}：{2}"],
  ["cannot write {1}: U+{2} alone is half a character", "无法写入 {1}：单独的 U+{2} 只是半个字符"],
  ["cannot write {1}: {2}", "无法写入 {1}：{2}"],
  ["{1} has {2} bytes; the studio opens at most {3}", "{1} 有 {2} 字节；studio 最多打开 {3}"],
  ["{1} has {2} bytes; at most {3} are loaded", "{1} 有 {2} 字节；最多加载 {3}"],
  ["{1} is no path: {2}", "{1} 不是路径：{2}"],
  ["{1} is outside {2}: only programs in this folder can be opened", "{1} 在 {2} 之外：只能打开此文件夹中的程序"],
  ["{1} is outside {2}; name it on the command line", "{1} 在 {2} 之外；请在命令行中指定"],
  ["{1} is outside {2}", "{1} 在 {2} 之外"],
  ["{1}: only {2} is open; start the studio with its folder for others", "{1}：只打开了 {2}；其他文件请用其文件夹启动 studio"],
  ["{1}: the relative path of a {2} or {3} file is needed", "{1}：需要 {2} 或 {3} 文件的相对路径"],
  ["{1}: there is no folder {2}", "{1}：没有文件夹 {2}"],
  ["{1}: its script has {2} characters; the studio shows up to {3}", "{1}：其脚本有 {2} 个字符；studio 最多显示 {3} 个"],
  ["this text is generated from {1}: the tree is the source, so change it there", "此文本由 {1} 生成：程序树才是源，请在那里修改"],
  ["there is no file {1}", "没有文件 {1}"],
  ["{1}: only {2} are loaded", "{1}：只加载 {2}"],
  ["--urdf {1}:{2}: it is not UTF-8: {3}", "--urdf {1}:{2}：不是 UTF-8：{3}"],
  ["an old draft stays: {1}", "旧草稿保留：{1}"],
  ["unsaved text cannot be kept: {1}", "无法保留未保存的文本：{1}"],
  ["{1} has changed on disk: {2}", "{1} 在磁盘上已更改：{2}"],
  ["no program is open: start the studio with a file or a folder", "没有打开程序：请用文件或文件夹启动 studio"],
  ["no program is open", "没有打开程序"],
  ["the settings of the page are not kept: {1}", "页面设置未保留：{1}"],
  ["{1} requests wait for an answer", "{1} 个请求在等待应答"],
  ["internal error: {1}: {2}", "内部错误：{1}：{2}"],
  ["end_line, end_column: must be whole numbers, got {1}", "end_line、end_column：必须是整数，得到 {1}"],
  ["kind: there is no {1}", "kind：没有 {1}"],
  ["the studio was started without --urdf", "studio 启动时没有 --urdf"],
  ["the text has changed: it is version {1}, not {2}", "文本已更改：现为版本 {1}，不是 {2}"],
  ["there is no code {1}", "没有代码 {1}"],
  ["{1}: must be a text, got {2}", "{1}：必须是文本，得到 {2}"],
  // Controllers.
  ["primary port {1}", "主端口 {1}"],
  ["RTSI port {1}", "RTSI 端口 {1}"],
  ["dashboard port {1}", "仪表盘端口 {1}"],
  ["{1} port connected", "{1} 端口已连接"],
  ["{1}: no name of a computer", "{1}：不是计算机名"],
  ["{1}: nothing answers within {2} s", "{1}：{2} s 内无应答"],
  ["{1}: nothing came in time", "{1}：未按时收到数据"],
  ["{1}: the connection has ended ({2})", "{1}：连接已结束（{2}）"],
  ["{1}: the controller has closed the connection", "{1}：控制器关闭了连接"],
  ["{1}: the controller sends more than {2} a second: the connection was closed", "{1}：控制器每秒发送超过 {2}：连接已关闭"],
  ["ctl: no answer to {1} within {2} s", "ctl：{2} s 内对 {1} 无应答"],
  ["ctl: the answer is no record", "ctl：应答不是记录"],
  ["the dashboard port is not connected", "仪表盘端口未连接"],
  ["the primary port is not connected", "主端口未连接"],
  ["a program runs or is paused; stop it first", "有程序在运行或暂停；请先停止"],
  ["firmware {1} has no freedrive_mode; {2} brought it", "固件 {1} 没有 freedrive_mode；{2} 起提供"],
  ["only a robot that is served on this computer can do that", "只有在本机提供服务的机器人才能这样做"],
  ["only a robot that is served on this computer has {1}", "只有在本机提供服务的机器人才有 {1}"],
  ["the arm cannot move: robot mode {1}, safety {2}; it needs {3}", "手臂不能运动：机器人模式 {1}，安全 {2}；需要 {3}"],
  ["the controller does not start the program; is it under remote control?", "控制器没有启动程序；它处于远程控制吗？"],
  ["the controller is not connected", "控制器未连接"],
  ["the controller refuses: {1}", "控制器拒绝：{1}"],
  ["the name of a program is one line", "程序名只有一行"],
  ["the robot is under local control; switch it to remote control first", "机器人处于本地控制；请先切换到远程控制"],
  ["this studio only looks: start it with --control to command the controller", "此 studio 只查看：要控制请用 --control 启动"],
  ["the program runs on the controller", "程序在控制器上运行"],
  ["a dashboard command is one line", "仪表盘命令只有一行"],
  ["this connection only reads: it may not send programs", "此连接只读：不能发送程序"],
  ["this connection only reads: it may not send {1}", "此连接只读：不能发送 {1}"],
  ["this connection only reads: it may not set up RTSI inputs", "此连接只读：不能设置 RTSI 输入"],
  ["this connection only reads: it may not write RTSI inputs", "此连接只读：不能写入 RTSI 输入"],
  ["dashboard: no reply to `{1}` within {2} s", "仪表盘：{2} s 内对 `{1}` 无应答"],
  ["dashboard: the connection is out of step", "仪表盘：连接失步"],
  ["dashboard: the controller has closed the connection", "仪表盘：控制器关闭了连接"],
  ["dashboard: the controller does not answer to `echo`", "仪表盘：控制器不应答 `echo`"],
  ["dashboard: the controller sends without being asked: the connection was closed", "仪表盘：控制器未经请求不断发送：连接已关闭"],
  ["dashboard: the reply to `{1}` has no end", "仪表盘：对 `{1}` 的应答没有结尾"],
  ["primary port: the controller takes nothing for {1} s", "主端口：控制器 {1} s 内不接收数据"],
  ["primary port: a message says that it has {1} bytes; one has from {2} to {3}", "主端口：消息声称有 {1} 字节；应为 {2} 到 {3}"],
  ["primary port: a robot message has {1} bytes; its head alone has {2}", "主端口：机器人消息有 {1} 字节；仅其头部就有 {2}"],
  ["primary port: a robot state ends within the head of a part, at byte {1}", "主端口：机器人状态在子包头部内结束，位于字节 {1}"],
  ["primary port: part {1} of a robot state at byte {2} says that it has {3} bytes", "主端口：机器人状态的子包 {1}（字节 {2}）声称有 {3} 字节"],
  ["ctl: no controller is served here ({1}); start one with `elitescript serve`", "ctl：本机没有提供控制器（{1}）；用 `elitescript serve` 启动一个"],
  ["RTSI: the connection has ended", "RTSI：连接已结束"],
  ["RTSI: the controller does not start to send packages", "RTSI：控制器没有开始发送数据包"],
  ["RTSI: the controller does not stop to send packages", "RTSI：控制器没有停止发送数据包"],
  ["RTSI: the controller has none of {1}", "RTSI：控制器没有 {1} 中的任何一个"],
  ["RTSI: the controller refuses an output recipe of {1}", "RTSI：控制器拒绝 {1} 的输出配方"],
  ["RTSI: the controller refuses inputs: {1}", "RTSI：控制器拒绝输入：{1}"],
  ["RTSI: the controller refuses version 1 of the protocol", "RTSI：控制器拒绝协议版本 1"],
  ["RTSI: a message says that it has {1} bytes; the shortest has {2}", "RTSI：消息声称有 {1} 字节；最短的有 {2}"],
  ["RTSI: a package of recipe {1} has {2} bytes, not {3}", "RTSI：配方 {1} 的数据包有 {2} 字节，不是 {3}"],
  ["RTSI: the answer to the {1} recipe is empty", "RTSI：对 {1} 配方的应答为空"],
  ["RTSI: the answer to {1} is empty", "RTSI：对 {1} 的应答为空"],
  ["RTSI: the controller's version has {1} bytes, not {2}", "RTSI：控制器版本有 {1} 字节，不是 {2}"],
  ["RTSI: {1} {2} variables were asked for, and {3} types came back", "RTSI：请求了 {1} 个{2}变量，返回了 {3} 个类型"],
  ["another page moves the arm", "另一个页面正在移动手臂"],
  ["its program at the controller does not answer; another may have taken its place", "其在控制器上的程序没有应答；可能已被另一个程序取代"],
  ["joint {1} is at the end of its range", "关节 {1} 已到范围末端"],
  ["nothing was heard of the controller for {1} s", "{1} s 没有收到控制器的消息"],
  ["nothing was heard of the studio for {1} s", "{1} s 没有收到 studio 的消息"],
  ["nothing was heard of the page for {1} s; release the button first", "{1} s 没有收到页面的消息；请先松开按钮"],
  ["the controller does not start the program that moves the arm", "控制器没有启动移动手臂的程序"],
  ["the controller has ended the program; its messages say why", "控制器结束了程序；原因见其消息"],
  ["the controller has paused the program that moves the arm; it is ended", "控制器暂停了移动手臂的程序；程序已结束"],
  ["a controller shows what is now: it does not go back to a moment", "控制器显示当前状态：不能回到某一时刻"],
  ["a fault is one of {1}", "故障为以下之一：{1}"],
  ["the controller has not answered to what was asked for before", "控制器尚未应答先前的请求"],
];

interface Row {
  readonly pattern: RegExp;
  readonly chinese: string;
}

const special = /[.*+?^${}()|[\]\\]/g;
/** The one with the most words of its own counts. */
const words = (english: string) => english.replace(/\{\d\}/g, "").length;
/** What a port says of itself; at a connection its address stands instead. */
const ports = /^(?:primary port|RTSI|dashboard): /;
const withoutPort = SAID.filter(([english]) => ports.test(english)).map(([english, chinese]) => [english.replace(ports, ""), chinese.slice(chinese.indexOf("：") + 1)] as const);
const rows: readonly Row[] = [...SAID, ...withoutPort].sort(([a], [b]) => words(b) - words(a)).map(([english, chinese]) => ({
  pattern: new RegExp(`^${english.split(/\{\d\}/).map((part) => part.replace(special, "\\$&")).join("(.+?)")}$`, "s"),
  chinese,
}));

/** Parts of parts that are translated. */
const DEPTH_MAX = 4;
/** A longer text is none of ours. */
const LENGTH_MAX = 2000;

/** Returns a sentence of a source in the language of the page; one that is in no row as it is. */
export function said(words: string): string {
  return language.value === "zh" && words.length <= LENGTH_MAX ? inChinese(words, 0) : words;
}

function inChinese(words: string, depth: number): string {
  if (depth > DEPTH_MAX) return words;
  for (const { pattern, chinese } of rows) {
    const found = pattern.exec(words);
    if (found !== null) return chinese.replace(/\{(\d)\}/g, (_, place: string) => inChinese(found[Number(place)]!, depth + 1));
  }
  // In front of what a port says stand the robot and the port.
  const colon = words.indexOf(": ");
  if (colon > 0) {
    const rest = words.slice(colon + 2);
    const translated = inChinese(rest, depth + 1);
    if (translated !== rest) return `${words.slice(0, colon)}：${translated}`;
  }
  return words;
}
