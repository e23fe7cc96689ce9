"use strict";
(() => {
const D = JSON.parse(document.getElementById("data").textContent);
const $ = id => document.getElementById(id);
const make = (tag, attributes = {}, ...children) => {
  const element = Object.assign(document.createElement(tag), attributes);
  element.append(...children);
  return element;
};
const clamp = (value, low, high) => Math.min(high, Math.max(low, value));
const undo = deltas => { let sum = 0; return deltas.map(delta => (sum += delta)); };
const unpackTimes = deltas => undo(deltas).map(ms => ms / 1000);
const unpack = curve => ({ ...curve, t: unpackTimes(curve.t), v: undo(curve.v).map(n => n * curve.step) });

// ---------------------------------------------------------------- data
const joints = D.joints.map(j => ({ name: j.name, q: unpack(j.q), qd: unpack(j.qd), qdd: unpack(j.qdd) }));
const speed = unpack(D.speed), errors = D.errors.map(unpack);
const path = { t: unpackTimes(D.path.t), v: D.path.v, jumps: new Set(D.path.jumps) };
[path.x, path.y, path.z] = D.path.xyz.map(axis => undo(axis).map(n => n * D.path.step));
const spanEnds = unpackTimes(D.spans.t);
const spans = D.spans.line.map((line, i) => ({ line, t0: spanEnds[i], t1: spanEnds[i + 1] }));
const T0 = D.start, T1 = Math.max(D.end, D.start + 0.004), duration = D.end - D.start;
const table = D.table.map(([line, moving, still, visits]) => ({ line, moving, still, visits, total: moving + still }));
const sourceOf = line => line ? (D.source[line] ?? "").trim() : "(no program line)";
const threads = D.threads.map(({ name, t, line }) => {
  const ends = unpackTimes(t);
  return { name, starts: ends.slice(0, -1), spans: line.map((line, i) => ({ line, t0: ends[i], t1: ends[i + 1] })) };
});
const signals = D.signals.lanes.map(lane => ({ ...lane, t: unpackTimes(lane.t) }));
const channels = D.channels.lanes.map(lane => ({ ...lane, t: unpackTimes(lane.t), what: lane.what.map(i => D.channels.whats[i]),
  data: lane.data.map(i => D.channels.texts[i]), count: lane.count ?? lane.t.map(() => 1) }));
const alarms = D.marks.filter(mark => mark.kind === "alarm");
const lastAlarm = D.state === "alarm" && alarms.length ? alarms.at(-1) : null;

const before = (times, t) => {
  let low = 0, high = times.length - 1;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (times[middle] <= t) low = middle; else high = middle - 1;
  }
  return low;
};
const between = (times, values, t) => {
  const i = before(times, t), j = Math.min(i + 1, times.length - 1);
  if (j === i || t <= times[i]) return values[i];
  return values[i] + (values[j] - values[i]) * Math.min(1, (t - times[i]) / (times[j] - times[i]));
};
const spanStarts = spans.map(span => span.t0);
const lineOfThread = (thread, t) => {
  const span = thread.spans[before(thread.starts, t)];
  return span && span.t0 <= t && (t < span.t1 || span.t1 >= T1) ? span.line : 0;
};
// An alarm names its line even when the program has not been there for a tick.
const lineAt = t => lastAlarm && lastAlarm.line && !lastAlarm.thread && t >= lastAlarm.t - 1e-6 ? lastAlarm.line : spanAt(t).line;
const spanAt = t => spans.length ? spans[before(spanStarts, t)] : { line: 0, t0: T0, t1: T1 };

// ---------------------------------------------------------------- state
const state = { t: lastAlarm ? clamp(lastAlarm.t, T0, T1) : T0, view: [T0, T1], chosen: null, inDegrees: false, allLimits: false, drag: null, playing: 0 };
let C = {};
const readColours = () => {
  const style = getComputedStyle(document.documentElement);
  for (const name of ["back", "card", "ink", "soft", "line", "faint", "accent", "red", "amber", "green", "j0", "j1", "j2", "j3", "j4", "j5"])
    C[name] = style.getPropertyValue("--" + name).trim();
  C.dark = matchMedia("(prefers-color-scheme: dark)").matches;
};
const lineOrder = [...new Set([...table.map(row => row.line), ...threads.flatMap(thread => thread.spans.map(span => span.line))])].sort((a, b) => a - b);
const lineColour = line => {
  if (!line) return C.soft;
  const hue = (lineOrder.indexOf(line) * 137.5 + 205) % 360;
  return `hsl(${hue} ${C.dark ? "55% 62%" : "58% 45%"})`;
};
const RAMP = [[64, 96, 220], [30, 165, 185], [70, 180, 75], [245, 160, 20], [225, 45, 50]];
const speedMax = Math.max(...path.v, 1e-9);
const speedColour = v => {
  const u = clamp(v / speedMax, 0, 1) * (RAMP.length - 1), i = Math.min(RAMP.length - 2, Math.floor(u));
  return `rgb(${RAMP[i].map((a, k) => Math.round(a + (RAMP[i + 1][k] - a) * (u - i))).join()})`;
};
const angle = value => state.inDegrees ? value * 180 / Math.PI : value;
const angleUnit = suffix => (state.inDegrees ? "°" : "rad") + suffix;
const fix = (value, digits) => (Math.abs(value) < 0.5 * 10 ** -digits ? 0 : value).toFixed(digits);
const SANS = "system-ui, -apple-system, 'Segoe UI', Roboto, 'Noto Sans', sans-serif";
const MONO = "ui-monospace, SFMono-Regular, 'DejaVu Sans Mono', Menlo, Consolas, monospace";

// ---------------------------------------------------------------- charts over time
const charts = [];
// Width of the names on the left; on a narrow page they are shortened.
let GUTTER = 250;
const isNarrow = () => GUTTER < 200;
const RIGHT = 14;
const prepare = canvas => {
  const ratio = devicePixelRatio || 1, w = canvas.clientWidth, h = canvas.clientHeight;
  if (canvas.width !== Math.round(w * ratio) || canvas.height !== Math.round(h * ratio)) {
    canvas.width = Math.round(w * ratio);
    canvas.height = Math.round(h * ratio);
  }
  const g = canvas.getContext("2d");
  g.setTransform(ratio, 0, 0, ratio, 0, 0);
  g.clearRect(0, 0, w, h);
  return [g, w, h];
};
const ticks = (low, high, count) => {
  const rough = (high - low) / Math.max(1, count), power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 5, 10].map(n => n * power).find(n => n >= rough * 0.999);
  const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9)), found = [];
  for (let k = Math.ceil(low / step - 1e-9); k * step <= high + step * 1e-9; k++) found.push([k * step, fix(k * step, digits)]);
  return found;
};
// Line ends and tabs as they are written, so that each entry of a tip is one line.
const visible = text => text.replace(/\n/g, '\\n').replace(/\r/g, '\\r').replace(/\t/g, '\\t');
const fitText = (g, text, width) => {
  if (g.measureText(text).width <= width) return text;
  let low = 0, high = text.length;
  while (low < high) {
    const middle = (low + high + 1) >> 1;
    if (g.measureText(text.slice(0, middle) + "…").width <= width) low = middle; else high = middle - 1;
  }
  return text.slice(0, low) + "…";
};
// The end of a name of a signal or a channel tells it from the others.
const fitEnd = (g, text, width) => {
  if (g.measureText(text).width <= width) return text;
  let low = 0, high = text.length;
  while (low < high) {
    const middle = (low + high) >> 1;
    if (g.measureText("…" + text.slice(middle)).width <= width) high = middle; else low = middle + 1;
  }
  return "…" + text.slice(low);
};
// `times` are those at which something happens in a lane: `n` and `p` go from one to the next.
const chart = (parent, height, name, drawBase, drawOver, hover, times = null) => {
  const base = make("canvas"), over = make("canvas", { className: "over", tabIndex: 0 });
  over.setAttribute("role", "img");
  over.setAttribute("aria-label", name);
  const box = make("div", { className: "chart" }, base, over);
  const entry = { base, over, drawBase, drawOver, hover, times };
  for (const canvas of [base, over]) canvas.style.height = height + "px";
  parent.append(box);
  charts.push(entry);
  const timeAt = event => {
    const box = over.getBoundingClientRect(), w = box.width - GUTTER - RIGHT;
    return clamp(state.view[0] + (event.clientX - box.left - GUTTER) / w * (state.view[1] - state.view[0]), ...state.view);
  };
  over.addEventListener("pointerdown", event => {
    stop();
    if (event.pointerType !== "touch") over.setPointerCapture(event.pointerId);
    state.drag = { from: timeAt(event), x: event.clientX, wide: false, touch: event.pointerType === "touch" };
    moveTo(timeAt(event));
  });
  over.addEventListener("pointermove", event => {
    if (state.drag && !state.drag.touch && Math.abs(event.clientX - state.drag.x) > 5) state.drag.wide = true;
    if (state.playing && !state.drag) return;
    moveTo(timeAt(event));
    const rect = over.getBoundingClientRect();
    const text = entry.hover?.(event.clientX - rect.left, event.clientY - rect.top, timeAt(event), rect.width);
    tip(text, event);
  });
  over.addEventListener("pointerup", event => {
    const drag = state.drag;
    state.drag = null;
    if (drag?.wide) {
      const range = [drag.from, timeAt(event)].sort((a, b) => a - b);
      if (range[1] - range[0] >= 0.02) state.view = range;
      drawAll();
    } else {
      const rect = over.getBoundingClientRect();
      entry.click?.(event.clientX - rect.left, event.clientY - rect.top, timeAt(event));
    }
  });
  over.addEventListener("pointercancel", () => { state.drag = null; });
  over.addEventListener("pointerleave", () => tip());
  over.addEventListener("focus", () => { focused = entry; if (over.matches(":focus-visible")) tipAtCursor(); });
  over.addEventListener("blur", () => { focused = null; tip(); });
  over.addEventListener("dblclick", () => showWhole());
  return entry;
};
let focused = null;
const tipAtCursor = () => {
  if (!focused) return;
  const rect = focused.over.getBoundingClientRect(), x = xOf(rect.width)(state.t);
  const text = focused.hover?.(x, 12, state.t, rect.width) ?? "";
  tip(text, { clientX: rect.left + x, clientY: rect.top + Math.min(rect.height, 30) });
  focused.over.setAttribute("aria-description", text);
};
const xOf = w => {
  const scale = (w - GUTTER - RIGHT) / (state.view[1] - state.view[0]);
  return t => GUTTER + (t - state.view[0]) * scale;
};
const clipPlot = (g, w, h, top = 0) => { g.save(); g.beginPath(); g.rect(GUTTER, top, w - GUTTER - RIGHT, h); g.clip(); };
const verticals = (g, w, top, bottom) => {
  const x = xOf(w);
  g.strokeStyle = C.faint;
  g.lineWidth = 1;
  for (const [t] of ticks(...state.view, (w - GUTTER) / (isNarrow() ? 70 : 110))) {
    g.beginPath(); g.moveTo(x(t), top); g.lineTo(x(t), bottom); g.stroke();
  }
};
const timeAxis = (g, w, y) => {
  const x = xOf(w), unit = isNarrow() ? "s" : "time, s";
  g.font = "12px " + SANS; g.fillStyle = C.soft; g.textAlign = "center"; g.textBaseline = "top";
  const free = w - 2 - g.measureText(unit).width - 10;
  for (const [t, label] of ticks(...state.view, (w - GUTTER) / (isNarrow() ? 70 : 110)))
    if (x(t) + g.measureText(label).width / 2 < free) g.fillText(label, x(t), y + 3);
  g.textAlign = "right";
  g.fillText(unit, w - 2, y + 3);
};
const cursorLine = (g, w, h, top = 0) => {
  const x = xOf(w);
  if (state.drag?.wide) {
    g.fillStyle = C.accent; g.globalAlpha = 0.15;
    g.fillRect(x(state.drag.from), top, x(state.t) - x(state.drag.from), h - top);
    g.globalAlpha = 1;
  }
  if (state.t < state.view[0] - 1e-9 || state.t > state.view[1] + 1e-9) return;
  g.strokeStyle = C.ink; g.globalAlpha = 0.75; g.lineWidth = 1;
  g.beginPath(); g.moveTo(x(state.t), top); g.lineTo(x(state.t), h); g.stroke();
  g.globalAlpha = 1;
};
const lane = (g, y, h, text, { mono = false, colour = C.ink, room = 18, fit = fitText } = {}) => {
  g.font = mono ? "12px " + MONO : "12.5px " + SANS;
  g.textAlign = "left"; g.textBaseline = "middle"; g.fillStyle = colour;
  g.fillText(fit(g, text, GUTTER - room), 0, y + h / 2);
};
// Lanes of one kind: the first ones, and a button for the rest.
const lanesGroup = (noun, count, shown) => {
  const rest = make("div", { hidden: true }), first = make("div");
  $("timeline").append(first);
  if (count <= shown + 2) return () => first;
  const more = count - shown;
  const button = make("button", { className: "more", onclick: () => {
    rest.hidden = !rest.hidden;
    label();
    drawAll();
  } });
  const label = () => {
    button.textContent = rest.hidden ? `▸ ${more} more ${noun}` : `▾ hide ${more} ${noun}`;
    button.setAttribute("aria-expanded", String(!rest.hidden));
  };
  label();
  $("timeline").append(button, rest);
  return i => i < shown ? first : rest;
};

// Program lines, one lane each.
const LANES = 22, LANE = 20;
const lanesOf = (() => {
  const chosen = table.slice(0, table.length > LANES ? LANES - 1 : LANES).map(row => row.line).sort((a, b) => a - b);
  return table.length > LANES ? [...chosen, null] : chosen;
})();
const laneOf = new Map(lanesOf.map((line, i) => [line, i]));
const laneIndex = line => laneOf.get(line) ?? lanesOf.length - 1;
const linesHeight = lanesOf.length * LANE + 6;
const lineChart = chart($("timeline"), linesHeight, "Program line over time", (g, w, h) => {
  const x = xOf(w);
  lanesOf.forEach((line, i) => {
    const y = i * LANE;
    if (line !== null && line === state.chosen) { g.fillStyle = C.faint; g.fillRect(0, y, w, LANE); }
    const label = line === null ? "other lines" : `${String(line || "–").padStart(4)}  ${sourceOf(line)}`;
    lane(g, y, LANE, label, { mono: true, colour: line === state.chosen ? C.accent : C.ink });
    g.strokeStyle = C.faint; g.beginPath(); g.moveTo(GUTTER, y + LANE - 0.5); g.lineTo(w - RIGHT, y + LANE - 0.5); g.stroke();
  });
  verticals(g, w, 0, linesHeight - 6);
  clipPlot(g, w, h);
  for (const span of spans) {
    if (span.t1 < state.view[0] || span.t0 > state.view[1]) continue;
    g.fillStyle = lineColour(span.line);
    g.globalAlpha = state.chosen === null || span.line === state.chosen ? 1 : 0.35;
    g.fillRect(x(span.t0), laneIndex(span.line) * LANE + 3, Math.max(1, x(span.t1) - x(span.t0)), LANE - 6);
  }
  g.globalAlpha = 1;
  g.restore();
}, (g, w, h) => cursorLine(g, w, h), (px, py, t) => {
  if (px < GUTTER) {
    const line = lanesOf[Math.floor(py / LANE)];
    return line == null ? "" : describe(line);
  }
  const span = spanAt(t);
  return `${describe(span.line)}\n${fix(span.t0, 3)} s to ${fix(span.t1, 3)} s (${fix(span.t1 - span.t0, 3)} s)`;
}, spans.map(span => span.t0));
lineChart.click = (px, py, t) => choose(px < GUTTER ? lanesOf[Math.floor(py / LANE)] ?? null : spanAt(t).line);
const describe = line => {
  const row = table.find(entry => entry.line === line);
  const total = row ? `\n${fix(row.total, 3)} s in all, ${fix(100 * row.total / (duration || 1), 1)} % of the time` : "";
  return (line ? `line ${line}  ${sourceOf(line)}` : "no program line") + total;
};

// Moves.
if (D.moves.length) {
  const kinds = [...new Set(D.moves.map(move => move[2]))];
  chart($("timeline"), 26, "Moves over time", (g, w, h) => {
    const x = xOf(w);
    lane(g, 0, 24, "moves");
    let right = GUTTER - 10;
    for (const kind of [...kinds].reverse().slice(0, GUTTER > 200 ? 4 : 0)) {
      g.font = "600 12px " + SANS; g.textAlign = "right"; g.fillStyle = C["j" + kinds.indexOf(kind) % 6];
      g.fillText(kind, right, 12);
      right -= g.measureText(kind).width + 8;
      if (right < 70) break;
    }
    verticals(g, w, 0, 24);
    clipPlot(g, w, h);
    for (const [t0, t1, kind] of D.moves) {
      if (t1 < state.view[0] || t0 > state.view[1]) continue;
      const width = x(t1) - x(t0);
      g.fillStyle = C["j" + kinds.indexOf(kind) % 6]; g.globalAlpha = 0.8;
      g.fillRect(x(t0) + 0.5, 3, Math.max(1, width - 1), 18);
      g.globalAlpha = 1;
      g.font = "11.5px " + SANS; g.textAlign = "left"; g.textBaseline = "middle"; g.fillStyle = C.card;
      if (width > g.measureText(kind).width + 8) g.fillText(kind, x(t0) + 4, 12.5);
    }
    g.restore();
  }, (g, w, h) => cursorLine(g, w, h), (px, py, t) => {
    const move = D.moves.find(([t0, t1]) => t0 <= t && t <= t1);
    return move && px >= GUTTER ? `${move[2]}, ${fix(move[1] - move[0], 3)} s\nline ${move[3]}  ${sourceOf(move[3])}` : "";
  }, D.moves.map(move => move[0]));
}

// Threads beside the main one.
const threadsParent = lanesGroup("threads", threads.length, 4);
threads.forEach((thread, i) => chart(threadsParent(i), 22, `Lines of thread ${thread.name} over time`, (g, w, h) => {
  const x = xOf(w);
  lane(g, 0, 20, `thread ${thread.name}`);
  verticals(g, w, 0, 20);
  clipPlot(g, w, h);
  for (const span of thread.spans) {
    if (!span.line || span.t1 < state.view[0] || span.t0 > state.view[1]) continue;
    g.fillStyle = lineColour(span.line);
    g.fillRect(x(span.t0), 3, Math.max(1, x(span.t1) - x(span.t0)), 14);
  }
  g.restore();
}, (g, w, h) => cursorLine(g, w, h), (px, py, t) => {
  const line = lineOfThread(thread, t);
  return `thread ${thread.name}: ${line ? `line ${line}  ${sourceOf(line)}` : "does not run"}`;
}, thread.starts));

// Signals: levels of digital ones, steps of the others.
const signalAt = (signal, t) => signal.v[before(signal.t, t)];
const levelText = (signal, value) => value === null ? "not finite" : signal.kind === "bool" ? (value ? "high" : "low") : String(value);
const CAUSES = { client: "a client", device: "a device of the world", wire: "a wire", schedule: "a schedule", fault: "a fault", program: "the program" };
const causeText = ([by, line]) => !by ? "" : line ? `line ${line}  ${sourceOf(line)}` : CAUSES[by] ?? by;
const signalParent = lanesGroup("signals", signals.length, 10);
signals.forEach((signal, index) => {
  const digital = signal.kind === "bool", known = signal.v.filter(v => v !== null);
  const [low, high] = digital ? [0, 1] : [Math.min(...known), Math.max(...known)];
  const unit = signal.unit ? " " + signal.unit : "";
  chart(signalParent(index), 24, `Signal ${signal.name} over time`, (g, w, h) => {
    const x = xOf(w), y = v => 19 - 14 * (high > low ? ((v ?? low) - low) / (high - low) : 0);
    lane(g, 0, 22, signal.name + (signal.unit && !isNarrow() ? "," + unit : ""), { room: 66, fit: fitEnd });
    verticals(g, w, 0, 22);
    clipPlot(g, w, h);
    const outline = new Path2D();
    signal.t.forEach((t, i) => {
      if (i) outline.lineTo(x(t), y(signal.v[i - 1]));
      else outline.moveTo(x(t), y(signal.v[0]));
      outline.lineTo(x(t), y(signal.v[i]));
    });
    outline.lineTo(x(T1), y(signal.v.at(-1)));
    g.strokeStyle = C.green; g.lineWidth = 1.6; g.stroke(outline);
    if (digital) {
      outline.lineTo(x(T1), 19); outline.lineTo(x(T0), 19); outline.closePath();
      g.fillStyle = C.green; g.globalAlpha = 0.28; g.fill(outline); g.globalAlpha = 1;
    }
    g.restore();
  }, (g, w, h) => {
    cursorLine(g, w, h);
    const value = signalAt(signal, state.t);
    g.font = "600 12px " + SANS; g.textAlign = "right"; g.textBaseline = "middle";
    g.fillStyle = value ? C.green : C.soft; const text = levelText(signal, value), short = g.measureText(text).width > 54 && value !== null ? value.toPrecision(3) : text;
    g.fillText(fitText(g, short, 56), GUTTER - 10, 11);
  }, (px, py, t) => {
    const i = before(signal.t, t), cause = causeText(D.signals.causes[signal.by[i]]);
    const since = i || cause ? `since ${fix(signal.t[i], 3)} s` + (cause ? `, by ${cause}` : "") : "since the start";
    const count = signal.t.length - 1 + signal.left_out, range = digital || low === high ? "" : `, ${low} to ${high}${unit}`;
    return `${signal.name}: ${levelText(signal, signal.v[i])}${unit}\n${since}\n${count} change${count === 1 ? "" : "s"}${range}`;
  }, signal.t.slice(1));
});
if (D.signals.other_changes.length) channels.push({ name: `${D.signals.others.length} more signals`, kind: "", t: D.signals.other_changes.map(each => each[0]),
  what: D.signals.other_changes.map(() => "changed"), data: D.signals.other_changes.map(each => each[1]), line: D.signals.other_changes.map(each => each[2]),
  count: D.signals.other_changes.map(() => 1), total: D.signals.other_changes.length + D.signals.other_changes_left_out });

// Connections: what was opened, sent, received, closed, refused, or took too long.
const whatColour = what => ({ refused: C.red, timeout: C.red, received: C.green, closed: C.soft, changed: C.green }[what] ?? C.accent);
const drawWhat = (g, what, x, y) => {
  g.fillStyle = g.strokeStyle = whatColour(what); g.lineWidth = 1.7;
  g.beginPath();
  if (what === "sent") { g.moveTo(x, y - 7); g.lineTo(x + 5, y + 1); g.lineTo(x - 5, y + 1); g.closePath(); g.fill(); }
  else if (what === "received") { g.moveTo(x, y + 8); g.lineTo(x + 5, y); g.lineTo(x - 5, y); g.closePath(); g.fill(); }
  else if (what === "open") { g.arc(x, y, 4, 0, 7); g.stroke(); }
  else if (what === "closed") g.fillRect(x - 3.5, y - 3.5, 7, 7);
  else if (what === "changed") { g.arc(x, y, 3, 0, 7); g.fill(); }
  else {
    g.moveTo(x - 5, y - 5); g.lineTo(x + 5, y + 5); g.moveTo(x + 5, y - 5); g.lineTo(x - 5, y + 5); g.stroke();
    if (what === "timeout") { g.beginPath(); g.arc(x, y, 7, 0, 7); g.stroke(); }
  }
};
const channelParent = lanesGroup("connections", channels.length, 8);
channels.forEach((channel, index) => {
  const spans = [];
  let opened = null;
  channel.t.forEach((t, i) => {
    if (!channel.kind) return;
    if (channel.what[i] === "open") opened ??= t;
    else if (channel.what[i] === "closed" && opened !== null) { spans.push([opened, t]); opened = null; }
  });
  if (opened !== null) spans.push([opened, T1]);
  const name = `${channel.kind} ${channel.name}`.trim();
  chart(channelParent(index), 24, `${name} over time`, (g, w, h) => {
    const x = xOf(w), count = channel.total > 999 ? `${Math.round(channel.total / 1000)}k` : String(channel.total);
    lane(g, 0, 22, isNarrow() ? channel.name : name, { room: 50, fit: channel.kind ? fitEnd : fitText });
    g.textAlign = "right"; g.fillStyle = C.soft; g.font = "12px " + SANS; g.fillText(count, GUTTER - 10, 11);
    verticals(g, w, 0, 22);
    g.save(); g.beginPath(); g.rect(GUTTER - 6, 0, w - GUTTER - RIGHT + 12, h); g.clip();
    g.fillStyle = C.accent; g.globalAlpha = 0.16;
    for (const [t0, t1] of spans) g.fillRect(x(t0), 5, Math.max(1, x(t1) - x(t0)), 13);
    g.globalAlpha = 1;
    const order = channel.t.map((_, i) => i).sort((a, b) => (whatColour(channel.what[a]) === C.red) - (whatColour(channel.what[b]) === C.red));
    for (const i of order) if (channel.t[i] >= state.view[0] && channel.t[i] <= state.view[1]) drawWhat(g, channel.what[i], x(channel.t[i]), 11.5);
    g.restore();
  }, (g, w, h) => cursorLine(g, w, h), (px, py, t, w) => {
    if (px < GUTTER) return `${name}: ${channel.total} event${channel.total === 1 ? "" : "s"}`;
    const reach = 6 / (w - GUTTER - RIGHT) * (state.view[1] - state.view[0]);
    const near = channel.t.map((_, i) => i).filter(i => Math.abs(channel.t[i] - t) <= reach + 0.0005);
    if (!near.length) return "";
    const rows = near.slice(0, 8).map(i => `${fix(channel.t[i], 3)} s  ${channel.what[i]}${channel.line[i] ? `, line ${channel.line[i]}` : ""}` +
      `${channel.data[i] ? `: ${visible(channel.data[i])}` : ""}${channel.count[i] > 1 ? `  (and ${channel.count[i] - 1} more until the next mark)` : ""}`);
    if (near.length > 8) rows.push(`and ${near.length - 8} more marks here: zoom in`);
    return `${name}\n${rows.join("\n")}`;
  }, channel.t);
});
// Messages and alarms, and the time axis of the time line.
const markColour = kind => ({ alarm: C.red, warning: C.amber, popup: C.j3, print: C.soft, device: C.green }[kind] ?? C.accent);
const drawMark = (g, kind, x, y) => {
  g.fillStyle = g.strokeStyle = markColour(kind);
  g.lineWidth = 1.6;
  g.beginPath();
  if (kind === "alarm") { g.moveTo(x, y - 8); g.lineTo(x + 8, y); g.lineTo(x, y + 8); g.lineTo(x - 8, y); g.closePath(); g.fill(); }
  else if (kind === "warning") { g.moveTo(x, y - 7); g.lineTo(x + 7, y + 6); g.lineTo(x - 7, y + 6); g.closePath(); g.fill(); }
  else if (kind === "popup") g.fillRect(x - 5, y - 5, 10, 10);
  else { g.arc(x, y, 4.5, 0, 7); kind === "print" ? g.stroke() : g.fill(); }
};
const hasMarks = D.marks.length > 0, axisY = hasMarks ? 26 : 2;
chart($("timeline"), axisY + 20, "Messages over time", (g, w, h) => {
  const x = xOf(w);
  if (hasMarks) {
    lane(g, 0, 24, "messages");
    verticals(g, w, 0, 24);
    g.save(); g.beginPath(); g.rect(GUTTER - 9, 0, w - GUTTER - RIGHT + 18, 26); g.clip();
    for (const mark of [...D.marks].sort((a, b) => (a.kind === "alarm") - (b.kind === "alarm"))) drawMark(g, mark.kind, x(mark.t), 12);
    g.restore();
  }
  g.strokeStyle = C.line; g.lineWidth = 1;
  g.beginPath(); g.moveTo(GUTTER, axisY + 0.5); g.lineTo(w - RIGHT, axisY + 0.5); g.stroke();
  timeAxis(g, w, axisY);
}, (g, w, h) => cursorLine(g, w, axisY), (px, py, t, w) => {
  const reach = 8 / (w - GUTTER - RIGHT) * (state.view[1] - state.view[0]);
  return D.marks.filter(mark => Math.abs(mark.t - t) <= reach).slice(0, 8)
    .map(mark => [`${fix(mark.t, 3)} s  ${mark.kind}${mark.line ? ", line " + mark.line : ""}: ${mark.text}`, ...(mark.hints ?? []).map(hint => `hint: ${hint}`)].join("\n")).join("\n");
}, D.marks.map(mark => mark.t));

if (channels.some(channel => channel.kind)) {
  const key = make("div", { className: "key" });
  const kinds = new Set(channels.flatMap(channel => channel.what));
  for (const [what, sign] of [["open", "○"], ["sent", "▲"], ["received", "▼"], ["closed", "■"], ["refused", "✕"], ["timeout", "⊗"]])
    if (kinds.has(what)) { const mark = make("b", { textContent: sign, className: "sign " + what }); key.append(mark, what === "timeout" ? "time-out" : what); }
  key.append(make("span", { textContent: " · number: events of the connection" }));
  $("timeline").append(key);
}

// What this picture does not show.
const thinned = signals.filter(signal => signal.left_out);
const notes = [
  D.spans_left_out && "very short visits of lines are drawn as one, under the line that took most of the time; the table counts each",
  thinned.length && `${thinned.map(signal => signal.name).join(", ")}: more changes than can be drawn (${thinned.reduce((sum, signal) => sum + signal.left_out, 0)} are left out)`,
  D.signals.others.length && `${D.signals.others.length} more signals changed (${D.signals.others.slice(0, 6).join(", ")}${D.signals.others.length > 6 ? ", …" : ""})`,
  ...channels.filter(channel => channel.kind && channel.count.some(n => n > 1)).map(channel => `${channel.kind} ${channel.name}: ${channel.t.length} marks for ${channel.total} events`),
  D.channels.others && `${D.channels.others} more connections share one lane`,
  D.threads_left_out && `${D.threads_left_out} more threads`,
  D.marks_left_out && `${D.marks_left_out} later messages are left out`,
].filter(Boolean);
if (notes.length) $("timeline").append(make("div", { className: "key", textContent: `Not shown in full: ${notes.join("; ")}.` }));

// Curves against their limits.
const NEAR = 0.95;
const curveChart = ({ title, unit, factor, series, height, last = false, zeroBased = false, fine = false }) => {
  const plotHeight = height - (last ? 22 : 4);
  // On a narrow page the title has a row of its own, since the names on the left leave it no room.
  let pad = 6;
  const range = () => {
    let low = Math.min(...series.map(s => s.curve.min)), high = Math.max(...series.map(s => s.curve.max));
    // A standing arm shows a flat line, not the noise of the last digit.
    const least = (fine ? 1e-4 : 0.02) * Math.min(...series.map(s => s.curve.high));
    [low, high] = [zeroBased ? 0 : Math.min(low, -least), Math.max(high, least)];
    const size = Math.max(-low, high, 1e-9);
    for (const { curve } of series) {
      if (state.allLimits || (curve.high < 1.8 * size && curve.high < 1.8 * Math.max(high, 1e-9))) high = Math.max(high, curve.high);
      if (!zeroBased && (state.allLimits || (-curve.low < 1.8 * size && -curve.low < 1.8 * Math.max(-low, 1e-9)))) low = Math.min(low, curve.low);
    }
    const margin = Math.max(0.05 * (high - low), 1e-6);
    return [zeroBased ? 0 : low - margin, high + margin];
  };
  return chart($("curves"), height, title + " over time", (g, w, h) => {
    pad = isNarrow() ? 26 : 6;
    const f = factor(), [low, high] = range(), x = xOf(w);
    const y = v => pad + (plotHeight - pad) * (1 - (v - low) / (high - low));
    g.font = "600 13px " + SANS; g.textAlign = "left"; g.textBaseline = "top"; g.fillStyle = C.ink;
    g.fillText(`${title}, ${unit()}`, 0, 4);
    verticals(g, w, pad, plotHeight);
    g.font = "11.5px " + SANS; g.textAlign = "right"; g.textBaseline = "middle";
    for (const [value, label] of ticks(low * f, high * f, plotHeight / 34)) {
      const py = y(value / f);
      g.strokeStyle = Math.abs(value) < 1e-12 ? C.line : C.faint; g.lineWidth = 1;
      g.beginPath(); g.moveTo(GUTTER, py); g.lineTo(w - RIGHT, py); g.stroke();
      g.fillStyle = C.soft; g.fillText(label, GUTTER - 6, py);
    }
    g.strokeStyle = C.line; g.strokeRect(GUTTER + 0.5, pad + 0.5, w - GUTTER - RIGHT - 1, plotHeight - pad - 1);
    clipPlot(g, w, plotHeight - pad, pad);
    // Limits that several joints share are one neutral line.
    const limits = new Map();
    for (const s of series) for (const limit of zeroBased ? [s.curve.high] : [s.curve.low, s.curve.high])
      limits.set(limit, limits.has(limit) ? null : s.colour);
    const offScale = new Set();
    for (const [limit, colour] of limits) {
      if (limit < low || limit > high) { offScale.add(limit); continue; }
      g.strokeStyle = colour ? C[colour] : C.red; g.setLineDash([7, 4]); g.lineWidth = 1.3;
      g.beginPath(); g.moveTo(GUTTER, y(limit)); g.lineTo(w, y(limit)); g.stroke();
      g.setLineDash([]);
    }
    for (const { curve, colour } of series) {
      const i0 = Math.max(0, before(curve.t, state.view[0])), i1 = Math.min(curve.t.length - 1, before(curve.t, state.view[1]) + 1);
      g.strokeStyle = C[colour]; g.lineWidth = 1.5; g.lineJoin = "round";
      g.beginPath();
      for (let i = i0; i <= i1; i++) g.lineTo(x(curve.t[i]), y(curve.v[i]));
      g.stroke();
      if (curve.used < NEAR) continue;
      // A point within 5 % of the limit is exact; the line is marked from where it enters that band.
      g.strokeStyle = C.red; g.lineWidth = 4; g.lineCap = "round";
      const top = NEAR * curve.high, bottom = zeroBased ? -Infinity : NEAR * curve.low;
      g.beginPath();
      for (let i = i0; i < i1; i++) nearPart(curve, i, top, bottom, x, y, g);
      g.stroke();
      g.lineCap = "butt";
    }
    g.restore();
    if (offScale.size) {
      const sizes = [...new Set([...offScale].map(Math.abs))].sort((a, b) => a - b).map(v => +(v * f).toPrecision(4));
      const isBoth = [...offScale].some(v => v < 0) && [...offScale].some(v => v > 0);
      const sign = isBoth ? "±" : [...offScale][0] < 0 ? "−" : "";
      const range = sizes.length > 1 ? `${sizes[0]} to ${sizes.at(-1)}` : sizes[0];
      const text = isNarrow() ? `limit ${sign}${range} is off scale` : `limit ${sign}${range} ${unit()} is off this scale`;
      g.font = "11.5px " + SANS; g.textAlign = "right"; g.textBaseline = "top";
      // On a narrow page it stands beside the title, where it hides no curve.
      const width = g.measureText(text).width, top = isNarrow() ? 5 : pad + 5;
      g.fillStyle = C.card; g.globalAlpha = 0.85; g.fillRect(w - RIGHT - width - 14, top - 2, width + 10, 17); g.globalAlpha = 1;
      g.fillStyle = C.soft; g.fillText(text, w - RIGHT - 9, top);
    }
    if (last) timeAxis(g, w, plotHeight);
  }, (g, w, h) => {
    cursorLine(g, w, plotHeight, pad);
    const f = factor(), wide = !isNarrow(), top = wide ? 44 : 36, step = Math.min(18, (plotHeight - top + 8) / series.length);
    g.font = "11px " + SANS; g.fillStyle = C.soft; g.textBaseline = "top"; g.textAlign = "right";
    if (wide) { g.fillText("at cursor", 134, 23); g.fillText("peak/limit", 200, 23); }
    g.textBaseline = "middle";
    series.forEach(({ name, curve, colour }, i) => {
      const py = top + i * step, value = between(curve.t, curve.v, state.t), near = curve.used >= NEAR;
      g.font = "12px " + SANS; g.textAlign = "left"; g.fillStyle = C[colour];
      g.fillText(name, 0, py);
      g.textAlign = "right"; g.fillStyle = C.ink;
      g.fillText(fix(value * f, state.inDegrees && f !== 1 ? 1 : 3), wide ? 134 : GUTTER - 42, py);
      if (!wide) return;
      g.fillStyle = near ? C.red : C.soft;
      g.font = (near ? "600 " : "") + "12px " + SANS;
      g.fillText(`${fix(100 * curve.used, curve.used < 0.1 ? 1 : 0)} %`, 200, py);
    });
  });
};
const nearPart = (curve, i, top, bottom, x, y, g) => {
  const [t0, t1, v0, v1] = [curve.t[i], curve.t[i + 1], curve.v[i], curve.v[i + 1]];
  for (const [edge, beyond] of [[top, v => v >= top], [bottom, v => v <= bottom]]) {
    if (!beyond(v0) && !beyond(v1)) continue;
    const cross = v1 === v0 ? t0 : t0 + (t1 - t0) * (edge - v0) / (v1 - v0);
    const [a, b] = [beyond(v0) ? [t0, v0] : [cross, edge], beyond(v1) ? [t1, v1] : [cross, edge]];
    g.moveTo(x(a[0]), y(a[1]));
    g.lineTo(x(b[0]) + 0.01, y(b[1]));
  }
};
const ofJoints = key => joints.map((joint, i) => ({ name: joint.name, curve: joint[key], colour: "j" + i }));
const angular = () => angle(1);
curveChart({ title: "Joints q", unit: () => angleUnit(""), factor: angular, series: ofJoints("q"), height: 190 });
curveChart({ title: "Joint speeds qd", unit: () => angleUnit("/s"), factor: angular, series: ofJoints("qd"), height: 190 });
curveChart({ title: "Joint accelerations", unit: () => angleUnit("/s²"), factor: angular, series: ofJoints("qdd"), height: 190 });
if (errors.length) curveChart({ title: "Tracking error", unit: () => "mrad", factor: () => 1000, height: 150, fine: true,
  series: errors.map((curve, i) => ({ name: joints[i].name, curve, colour: "j" + i })) });
curveChart({ title: "TCP speed", unit: () => "m/s", factor: () => 1, series: [{ name: "TCP", curve: speed, colour: "j0" }],
  height: 130, last: true, zeroBased: true });

// ---------------------------------------------------------------- the path in space
const scene = $("scene"), camera = { yaw: -0.75, pitch: 0.5, zoom: 1 };
const [d1, a2, a3, d4, d5, d6] = D.arm;
const DH = [[0, d1, Math.PI / 2], [a2, 0, 0], [a3, 0, 0], [0, d4, Math.PI / 2], [0, d5, -Math.PI / 2], [0, d6, 0]];
const armPoints = q => {
  let R = [1, 0, 0, 0, 1, 0, 0, 0, 1], p = [0, 0, 0];
  const points = [p], to = (R, p, v) => [0, 1, 2].map(i => p[i] + R[3 * i] * v[0] + R[3 * i + 1] * v[1] + R[3 * i + 2] * v[2]);
  DH.forEach(([a, d, alpha], i) => {
    const c = Math.cos(q[i]), s = Math.sin(q[i]), ca = Math.cos(alpha), sa = Math.sin(alpha);
    // The offset of the wrist is drawn where the next joint is, so that links meet at right angles.
    if (d && a) points.push(to(R, p, [0, 0, d]));
    p = to(R, p, [a * c, a * s, d]);
    const B = [c, -s * ca, s * sa, s, c * ca, -c * sa, 0, sa, ca];
    R = [0, 3, 6].flatMap(r => [0, 1, 2].map(k => R[r] * B[k] + R[r + 1] * B[3 + k] + R[r + 2] * B[6 + k]));
    points.push(p);
  });
  return points;
};
const times = Array.from({ length: 61 }, (_, i) => T0 + (T1 - T0) * i / 60);
const poses = times.flatMap(t => armPoints(joints.map(joint => between(joint.q.t, joint.q.v, t))));
const [bx, by, bz] = [path.x, path.y, path.z].map((axis, i) => {
  const values = [0, ...axis, ...poses.map(point => point[i])];
  return [Math.min(...values), Math.max(...values)];
});
const centre = [bx, by, bz].map(([low, high]) => (low + high) / 2);
const extent = Math.max(Math.hypot(...[bx, by, bz].map(([low, high]) => high - low)), 0.4);
const cell = extent > 1.6 ? 0.2 : 0.1;
const projector = (w, h) => {
  const size = Math.min(w, h * 1.15) * 0.92 / extent * camera.zoom;
  const [cy, sy, cp, sp] = [Math.cos(camera.yaw), Math.sin(camera.yaw), Math.cos(camera.pitch), Math.sin(camera.pitch)];
  return ([px, py, pz]) => {
    const x = px - centre[0], y = py - centre[1], z = pz - centre[2];
    // x to the right of the view, u into it, z up; then tilted by the pitch.
    const r = x * cy - y * sy, u = x * sy + y * cy;
    const depth = u * cp - z * sp, k = size * 3 * extent / (3 * extent + depth);
    return [w / 2 + r * k, h * 0.5 - (z * cp + u * sp) * k];
  };
};
const pointAt = t => {
  const i = before(path.t, t), next = i + 1 < path.t.length && path.jumps.has(i + 1);
  return [path.x, path.y, path.z].map(axis => next ? axis[i] : between(path.t, axis, t));
};
const drawScene = () => {
  const [g, w, h] = prepare(scene), at = projector(w, h);
  const stroke = (points, colour, width, dash = []) => {
    g.strokeStyle = colour; g.lineWidth = width; g.setLineDash(dash); g.lineJoin = g.lineCap = "round";
    g.beginPath(); points.map(at).forEach(([x, y]) => g.lineTo(x, y)); g.stroke(); g.setLineDash([]);
  };
  const snap = v => Math.round(v / cell) * cell;
  const [gx0, gx1] = [snap(bx[0] - 0.15) - cell, snap(bx[1] + 0.15) + cell], [gy0, gy1] = [snap(by[0] - 0.15) - cell, snap(by[1] + 0.15) + cell];
  for (let x = gx0; x <= gx1 + 1e-9; x += cell) stroke([[x, gy0, 0], [x, gy1, 0]], C.line, 0.7);
  for (let y = gy0; y <= gy1 + 1e-9; y += cell) stroke([[gx0, y, 0], [gx1, y, 0]], C.line, 0.7);
  const label = (point, text, colour, dx = 8, dy = -9) => {
    const [x, y] = at(point);
    g.font = "600 12.5px " + SANS; g.textAlign = "left"; g.textBaseline = "middle"; g.lineWidth = 3.5;
    g.strokeStyle = C.card; g.strokeText(text, x + dx, y + dy); g.fillStyle = colour; g.fillText(text, x + dx, y + dy);
  };
  // Base of the arm, and its frame.
  const ring = r => Array.from({ length: 33 }, (_, i) => [r * Math.cos(i * Math.PI / 16), r * Math.sin(i * Math.PI / 16), 0]);
  g.fillStyle = C.soft; g.globalAlpha = 0.35; g.beginPath(); ring(0.085).map(at).forEach(p => g.lineTo(...p)); g.fill(); g.globalAlpha = 1;
  stroke(ring(0.085), C.soft, 1.5);
  [["x", C.red], ["y", C.green], ["z", C.accent]].forEach(([name, colour], i) => {
    const end = [0, 0, 0]; end[i] = 0.2;
    stroke([[0, 0, 0], end], colour, 2);
    label(end, name, colour, 4, -4);
  });
  // Shadow on the ground, the path, and the chosen line's part of it.
  const n = path.t.length;
  g.globalAlpha = 0.3;
  const shadow = [];
  for (let i = 0; i < n; i++) {
    if (path.jumps.has(i)) { stroke(shadow.splice(0), C.soft, 1); }
    shadow.push([path.x[i], path.y[i], 0]);
  }
  if (shadow.length) stroke(shadow, C.soft, 1);
  g.globalAlpha = 1;
  g.lineCap = "round"; g.setLineDash([]);
  const screen = path.t.map((_, i) => at([path.x[i], path.y[i], path.z[i]]));
  for (let i = 1; i < n; i++) {
    if (path.jumps.has(i)) continue;
    const middle = (path.t[i - 1] + path.t[i]) / 2;
    const out = middle < state.view[0] || middle > state.view[1];
    const isChosen = state.chosen !== null && spanAt(middle).line === state.chosen;
    g.globalAlpha = out ? 0.12 : state.chosen === null || isChosen ? 1 : 0.22;
    g.strokeStyle = speedColour((path.v[i - 1] + path.v[i]) / 2);
    g.lineWidth = isChosen ? 4 : 2.2;
    g.beginPath(); g.moveTo(...screen[i - 1]); g.lineTo(...screen[i]); g.stroke();
  }
  g.globalAlpha = 1;
  // The arm at the cursor.
  const links = armPoints(joints.map(joint => between(joint.q.t, joint.q.v, state.t))), tcp = pointAt(state.t);
  g.globalAlpha = 0.5;
  stroke(links, C.soft, 9);
  g.globalAlpha = 0.9;
  stroke(links, C.ink, 1.6);
  stroke([links.at(-1), tcp], C.accent, 2.5);
  g.globalAlpha = 1;
  for (const point of links.slice(1)) { g.fillStyle = C.card; g.strokeStyle = C.ink; g.lineWidth = 1.4; g.beginPath(); g.arc(...at(point), 3.4, 0, 7); g.fill(); g.stroke(); }
  const first = [path.x[0], path.y[0], path.z[0]], final = [path.x[n - 1], path.y[n - 1], path.z[n - 1]];
  g.fillStyle = C.green; g.beginPath(); g.arc(...at(first), 5.5, 0, 7); g.fill();
  g.fillStyle = C.red; const [ex, ey] = at(final); g.fillRect(ex - 4.5, ey - 4.5, 9, 9);
  const isEndLower = at(final)[1] >= at(first)[1];
  label(first, "start", C.green, 9, isEndLower ? -9 : 12);
  label(final, "end", C.red, 9, isEndLower ? 12 : -9);
  g.fillStyle = C.accent; g.strokeStyle = C.card; g.lineWidth = 2; g.beginPath(); g.arc(...at(tcp), 6, 0, 7); g.fill(); g.stroke();
  // Scale of the speed.
  const bar = Math.min(190, w * 0.35), bar0 = 4, barY = h - 24;
  const shade = g.createLinearGradient(bar0, 0, bar0 + bar, 0);
  RAMP.forEach((_, i) => shade.addColorStop(i / (RAMP.length - 1), speedColour(speedMax * i / (RAMP.length - 1))));
  g.fillStyle = shade; g.fillRect(bar0, barY, bar, 8);
  g.font = "12px " + SANS; g.fillStyle = C.soft; g.textBaseline = "top"; g.textAlign = "left";
  g.fillText("0", bar0, barY + 10);
  g.textAlign = "right"; g.fillText(speedMax < 1e-6 ? "" : fix(speedMax, 2), bar0 + bar, barY + 10);
  g.textAlign = "left"; g.textBaseline = "bottom"; g.fillText("TCP speed, m/s", bar0, barY - 3); g.textBaseline = "top";
  g.textAlign = "right"; g.fillText(`grid ${cell} m`, w - 4, barY + 10);
};
const fingers = new Map();
scene.addEventListener("pointerdown", event => { scene.setPointerCapture(event.pointerId); fingers.set(event.pointerId, event); });
scene.addEventListener("pointermove", event => {
  const last = fingers.get(event.pointerId);
  if (!last) return;
  if (fingers.size === 2) {
    const [other] = [...fingers.values()].filter(finger => finger.pointerId !== event.pointerId);
    const gap = finger => Math.hypot(finger.clientX - other.clientX, finger.clientY - other.clientY) || 1;
    camera.zoom = clamp(camera.zoom * gap(event) / gap(last), 0.3, 12);
  } else {
    camera.yaw += (event.clientX - last.clientX) * 0.008;
    camera.pitch = clamp(camera.pitch + (event.clientY - last.clientY) * 0.008, -0.3, Math.PI / 2);
  }
  fingers.set(event.pointerId, event);
  later(drawScene);
});
for (const name of ["pointerup", "pointercancel"]) scene.addEventListener(name, event => fingers.delete(event.pointerId));
scene.addEventListener("wheel", event => {
  event.preventDefault();
  camera.zoom = clamp(camera.zoom * Math.exp(-event.deltaY * 0.0012), 0.3, 12);
  later(drawScene);
}, { passive: false });
scene.addEventListener("dblclick", () => { Object.assign(camera, { yaw: -0.75, pitch: 0.5, zoom: 1 }); later(drawScene); });

// ---------------------------------------------------------------- words and tables
const buildWords = () => {
  const moving = table.reduce((sum, row) => sum + row.moving, 0);
  const share = part => duration ? `${fix(100 * part / duration, 0)} %` : "–";
  const peak = key => joints.reduce((best, joint) => joint[key].used > best[key].used ? joint : best);
  const tile = (value, text, bad) => make("div", { className: bad ? "tile bad" : "tile" }, make("b", { textContent: value }), make("span", { textContent: text }));
  const [fast, hard] = [peak("qd"), peak("qdd")];
  const ending = { finished: "finished", alarm: "alarm", time_limit: "cut off", stuck: "stuck", stopped: "stopped" }[D.state];
  $("tiles").replaceChildren(
    tile(`${fix(duration, 3)} s`, `${ending ? ending + ", " : ""}${D.model}`, D.state === "alarm" || D.state === "stuck"),
    tile(share(moving), "of the time moving"),
    tile(share(duration - moving), "standing"),
    tile(`${fix(speed.max, 2)} m/s`, "fastest TCP", speed.used >= NEAR),
    tile(`${fix(100 * fast.qd.used, 0)} %`, `of a speed limit: ${fast.name}`, fast.qd.used >= NEAR),
    tile(`${fix(100 * hard.qdd.used, 0)} %`, `of an acceleration limit: ${hard.name}`, hard.qdd.used >= NEAR));
  if (errors.length) {
    const largest = Math.max(...errors.map(curve => Math.max(curve.max, -curve.min)));
    $("tiles").append(tile(`${fix(1000 * largest, 2)} mrad`, "largest tracking error", errors.some(curve => curve.used >= NEAR)));
  }
  $("alarms").replaceChildren(...alarms.slice(-5).map(mark => make("button", {
    className: "alarm", onclick: () => { moveTo(mark.t); showLine(mark.line); } },
    make("b", { textContent: mark.line ? `Alarm at ${fix(mark.t, 3)} s in line ${mark.line}` : `Alarm at ${fix(mark.t, 3)} s` }),
    make("span", { textContent: mark.text }), ...(mark.line ? [make("code", { textContent: sourceOf(mark.line) })] : []),
    ...(mark.hints ?? []).map(hint => make("i", { textContent: `hint: ${hint}` })))));
  const head = make("tr", {}, ...[["line", "n"], ["program", ""], ["", ""], ["time, s", "n"], ["share", "n"], ["visits", "n"], ["each, s", "n"]]
    .map(([textContent, className]) => make("th", { textContent, className })));
  const longest = Math.max(...table.map(row => row.total), 1e-9);
  const rows = table.filter((row, i) => i < 200 && (row.total > 0 || table.length < 40)).map(row => {
    const colour = lineColour(row.line);
    const part = (seconds, alpha) => { const piece = make("span"); piece.style.cssText = `width:${100 * seconds / longest}%;background:${colour};opacity:${alpha}`; return piece; };
    const swatch = make("span", { className: "swatch" });
    swatch.style.background = colour;
    const cells = [make("td", { className: "n" }, swatch, String(row.line || "–")), make("td", { className: "src", textContent: sourceOf(row.line), title: sourceOf(row.line) }),
      make("td", { className: "bar", title: `${fix(row.moving, 3)} s moving, ${fix(row.still, 3)} s standing` }, make("div", { className: "bars" }, part(row.moving, 1), part(row.still, 0.32))),
      ...[fix(row.total, 3), `${fix(100 * row.total / (duration || 1), 1)} %`, row.visits, fix(row.total / row.visits, 3)].map(text => make("td", { className: "n", textContent: text }))];
    const tr = make("tr", { tabIndex: 0, onclick: () => choose(row.line, true), onkeydown: event => { if (event.key === "Enter") choose(row.line, true); } }, ...cells);
    tr.dataset.line = row.line;
    return tr;
  });
  const key = make("div", { className: "key" }, "Line of the main thread.", make("i"), "arm moves", make("i", { className: "still" }), "arm stands");
  $("table").replaceChildren(make("table", {}, make("thead", {}, head), make("tbody", {}, ...rows)), key);
  const messages = $("messages");
  messages.hidden = !hasMarks;
  messages.querySelector("summary").textContent = `Messages (${D.marks.length}${D.marks_left_out ? `, ${D.marks_left_out} more left out` : ""})`;
  messages.querySelector("table").replaceChildren(...D.marks.map(mark => make("tr", { onclick: () => { moveTo(mark.t); showLine(mark.line); } },
    make("td", { className: "n", textContent: `${fix(mark.t, 3)} s` }), make("td", { className: "kind-" + mark.kind, textContent: mark.kind }),
    make("td", { className: "n", textContent: mark.line ? `line ${mark.line}` : "" }), make("td", { textContent: [mark.text, ...(mark.hints ?? []).map(hint => `hint: ${hint}`)].join("\n") }))));
};
// The whole program, with the line that each thread is in.
const programRows = new Map();
const alarmLines = new Set(alarms.map(mark => mark.line)), warningLines = new Set(D.marks.filter(mark => mark.kind === "warning").map(mark => mark.line));
const buildProgram = () => {
  const numbers = Object.keys(D.source).map(Number).sort((a, b) => a - b);
  $("program").parentElement.hidden = !numbers.length;
  $("program").closest(".pair").classList.toggle("bare", !numbers.length);
  const totals = new Map(table.map(row => [row.line, row.total])), longest = Math.max(...totals.values(), 1e-9);
  const rows = [];
  let last = 0;
  const gap = next => { if (next > last + 1) rows.push(make("div", { className: "gap", textContent: next - last === 2 ? "1 line is left out" : `${next - last - 1} lines are left out` })); };
  for (const number of numbers) {
    gap(number);
    last = number;
    const total = totals.get(number) ?? 0, bar = make("i", { className: "share" });
    bar.style.width = total ? `${Math.max(6, 100 * total / longest)}%` : "0";
    const row = make("div", { className: "row", id: `L${number}`, title: total ? `${fix(total, 3)} s in line ${number}` : "" },
      make("span", { className: "who" }), make("span", { className: "no", textContent: number }),
      make("span", { className: "time" }, bar), make("code", { textContent: D.source[number] || " " }));
    row.setAttribute("role", "option");
    row.setAttribute("aria-selected", "false");
    row.onclick = () => goToLine(number);
    row.classList.toggle("alarmed", alarmLines.has(number));
    row.classList.toggle("warned", warningLines.has(number));
    programRows.set(number, row);
    rows.push(row);
  }
  gap(D.source_lines + 1);
  $("program").replaceChildren(...rows);
  $("program").classList.toggle("threads", threads.length > 0);
};
const firstTime = line => {
  const times = [...spans, ...threads.flatMap(thread => thread.spans)].filter(span => span.line === line).map(span => span.t0);
  times.push(...D.marks.filter(mark => mark.line === line).map(mark => mark.t), ...D.moves.filter(move => move[3] === line).map(move => move[0]));
  for (const signal of signals) signal.t.forEach((t, i) => { if (D.signals.causes[signal.by[i]][1] === line) times.push(t); });
  for (const channel of channels) channel.t.forEach((t, i) => { if (channel.line[i] === line) times.push(t); });
  return times.length ? Math.min(...times) : null;
};
const goToLine = line => {
  const t = firstTime(line), row = programRows.get(line);
  cursorRow = line;
  markCursorRow();
  if (t !== null) { held = line; state.chosen = null; choose(line); moveTo(t); return; }
  const box = row.getBoundingClientRect();
  tip(`line ${line}: no time is known; it was not reached, or took no tick`, { clientX: box.left + 60, clientY: box.bottom - 14 });
  setTimeout(tip, 2500);
};
let cursorRow = 0, shownRows = [], held = 0, followed = -1;
const markCursorRow = () => {
  for (const row of $("program").querySelectorAll(".at")) row.classList.remove("at");
  const row = programRows.get(cursorRow);
  if (!row) return;
  row.classList.add("at");
  $("program").setAttribute("aria-activedescendant", row.id);
};
const scrollToRow = row => {
  const box = $("program"), top = row.offsetTop;
  if (top < box.scrollTop + 20 || top > box.scrollTop + box.clientHeight - 40) box.scrollTop = top - box.clientHeight / 2;
};
const showLine = line => { const row = programRows.get(line); if (row) { followed = lineAt(state.t); scrollToRow(row); } };
const drawProgram = () => {
  for (const row of shownRows) { row.classList.remove("now", "other"); row.setAttribute("aria-selected", "false"); row.firstChild.textContent = ""; }
  shownRows = [];
  const put = (line, className, name) => {
    const row = programRows.get(line);
    if (!row) return;
    row.classList.add(className);
    row.setAttribute("aria-selected", "true");
    row.firstChild.textContent = row.firstChild.textContent ? `${row.firstChild.textContent}, ${name}` : name;
    shownRows.push(row);
  };
  const line = lineAt(state.t);
  put(line, "now", "▶");
  for (const thread of threads) put(lineOfThread(thread, state.t), "other", thread.name);
  if (line !== followed && !held) { followed = line; const row = programRows.get(line); if (row) scrollToRow(row); }
  held = 0;
};
$("program").addEventListener("keydown", event => {
  const numbers = [...programRows.keys()], at = numbers.indexOf(cursorRow);
  const jump = { ArrowDown: 1, ArrowUp: -1, PageDown: 15, PageUp: -15, Home: -1e9, End: 1e9 }[event.key];
  if (jump !== undefined) {
    event.preventDefault();
    cursorRow = numbers[clamp((at < 0 ? numbers.indexOf(spanAt(state.t).line) : at) + jump, 0, numbers.length - 1)];
    markCursorRow();
    scrollToRow(programRows.get(cursorRow));
  } else if (event.key === "Enter" && at >= 0) goToLine(cursorRow);
});
const readout = () => {
  const line = lineAt(state.t), [x, y, z] = pointAt(state.t).map(v => fix(v * 1000, 1));
  const pair = (name, value) => { const box = make("div"); box.append(make("span", { textContent: name + " " }), value); return box; };
  $("readout").replaceChildren(pair("t", `${fix(state.t, 3)} s`), pair("TCP x y z", `${x}  ${y}  ${z} mm`),
    pair("TCP speed", `${fix(between(speed.t, speed.v, state.t), 3)} m/s`), pair("line", String(line || "–")), make("code", { textContent: sourceOf(line) }));
};
const tip = (text, event) => {
  const box = $("tip");
  box.hidden = !text;
  if (!text) return;
  box.textContent = text;
  box.style.left = clamp(event.clientX + 14, 4, Math.max(4, innerWidth - box.offsetWidth - 6)) + "px";
  box.style.top = (event.clientY + 18 + box.offsetHeight > innerHeight ? event.clientY - box.offsetHeight - 10 : event.clientY + 18) + "px";
};

// ---------------------------------------------------------------- everything together
const waiting = new Set();
const later = draw => {
  if (!waiting.size) requestAnimationFrame(() => { const all = [...waiting]; waiting.clear(); all.forEach(each => each()); });
  waiting.add(draw);
};
const drawCursor = () => {
  for (const { over, drawOver } of charts) if (over.clientWidth) drawOver(...prepare(over));
  drawScene();
  drawProgram();
  readout();
};
const drawNow = () => {
  GUTTER = innerWidth > 900 ? 250 : innerWidth > 600 ? 190 : 146;
  for (const { base, drawBase } of charts) if (base.clientWidth) drawBase(...prepare(base));
  drawCursor();
};
const drawAll = () => later(drawNow);
const moveTo = t => { state.t = clamp(t, T0, T1); later(drawCursor); };
const choose = (line, jump = false) => {
  state.chosen = state.chosen === line ? null : line;
  for (const row of document.querySelectorAll("#table tr[data-line]")) row.classList.toggle("chosen", state.chosen !== null && +row.dataset.line === state.chosen);
  const span = jump && state.chosen !== null && spans.find(each => each.line === line);
  if (span) moveTo(span.t0);
  drawAll();
};
const showWhole = () => { state.view = [T0, T1]; drawAll(); };
const stop = () => { state.playing = 0; $("play").textContent = "▶ play"; };
const play = () => {
  if (state.playing) return stop();
  let last = performance.now();
  if (state.t >= state.view[1] - 1e-6) state.t = state.view[0];
  const mine = state.playing = last;
  $("play").textContent = "❚❚ stop";
  const frame = now => {
    if (state.playing !== mine) return;
    moveTo(Math.min(state.view[1], state.t + Math.max(0, now - last) / 1000));
    last = now;
    if (state.t >= state.view[1] - 1e-6) stop(); else requestAnimationFrame(frame);
  };
  requestAnimationFrame(frame);
};
$("play").onclick = play;
$("whole").onclick = showWhole;
$("unit").onclick = () => { state.inDegrees = !state.inDegrees; $("unit").textContent = state.inDegrees ? "deg → rad" : "rad → deg"; drawAll(); };
$("scale").onclick = () => { state.allLimits = !state.allLimits; $("scale").textContent = state.allLimits ? "fit to the curves" : "show all limits"; drawAll(); };
addEventListener("keydown", event => {
  if (event.ctrlKey || event.altKey || event.metaKey) return;
  if (event.key === " " && event.target.closest?.("button, summary")) return;
  const step = (state.view[1] - state.view[0]) / (event.shiftKey ? 20 : 400);
  const times = focused?.times ?? D.marks.map(mark => mark.t);
  if (event.key === "ArrowLeft") moveTo(state.t - step);
  else if (event.key === "ArrowRight") moveTo(state.t + step);
  else if (event.key === "n") moveTo(Math.min(...times.filter(t => t > state.t + 1e-6), T1));
  else if (event.key === "p") moveTo(Math.max(...times.filter(t => t < state.t - 1e-6), T0));
  else if (event.key === " ") { event.preventDefault(); play(); }
  else if (event.key === "Escape") { state.chosen = null; choose(null); }
  else return;
  if (focused) later(tipAtCursor);
});
addEventListener("resize", drawAll);
const recolour = () => { readColours(); buildWords(); drawAll(); };
matchMedia("(prefers-color-scheme: dark)").addEventListener("change", recolour);
buildProgram();
recolour();
drawNow();
if (lastAlarm) showLine(lastAlarm.line);
})();
