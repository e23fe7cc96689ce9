/** What the run says of the lines: which ran, which runs at the cursor, which raised the alarm; times and visits. */

import { RangeSet, RangeSetBuilder, StateEffect, StateField, type Extension, type Text } from "@codemirror/state";
import { Decoration, EditorView, gutter, GutterMarker, lineNumberMarkers, type DecorationSet } from "@codemirror/view";

/** Marks of the lines of the text as it is now. */
export interface LineMarks {
  /** Lines that ran. */
  readonly ran: ReadonlySet<number>;
  /** Lines in which a thread is at the cursor; the first is that of the main thread. */
  readonly at: readonly number[];
  /** Line of the alarm, 0 for none, and its text. */
  readonly alarm: number;
  readonly alarm_text: string;
  /** Lines of the node of a graphical program that is looked at. */
  readonly node: ReadonlySet<number>;
  /** Line that another region points at; 0 for none. */
  readonly outlined: number;
  /** Seconds and visits by line; empty while the column is not shown. */
  readonly times: ReadonlyMap<number, { readonly text: string; readonly label: string; readonly share: number }>;
}

export const NO_MARKS: LineMarks = { ran: new Set(), at: [], alarm: 0, alarm_text: "", node: new Set(), outlined: 0, times: new Map() };

export const setMarks = StateEffect.define<LineMarks>();

const CLASSES = {
  main: Decoration.line({ class: "cm-at-main" }),
  thread: Decoration.line({ class: "cm-at-thread" }),
  alarm: Decoration.line({ class: "cm-alarm-line" }),
  node: Decoration.line({ class: "cm-node-line" }),
  outlined: Decoration.line({ class: "cm-outlined" }),
};

interface Drawn {
  readonly lines: DecorationSet;
  readonly bars: RangeSet<GutterMarker>;
  readonly numbers: RangeSet<GutterMarker>;
  readonly times: RangeSet<GutterMarker>;
}

const field = StateField.define<Drawn>({
  create: () => ({ lines: Decoration.none, bars: RangeSet.empty, numbers: RangeSet.empty, times: RangeSet.empty }),
  update(drawn, change) {
    for (const effect of change.effects) if (effect.is(setMarks)) return draw(change.state.doc, effect.value);
    if (!change.docChanged) return drawn;
    const changes = change.changes;
    return { lines: drawn.lines.map(changes), bars: drawn.bars.map(changes), numbers: drawn.numbers.map(changes), times: drawn.times.map(changes) };
  },
  provide: (own) => [
    EditorView.decorations.from(own, (drawn) => drawn.lines),
    lineNumberMarkers.from(own, (drawn) => drawn.numbers),
    gutter({ class: "cm-run-gutter", markers: (view) => view.state.field(own).bars, initialSpacer: () => new Bar("", "") }),
    gutter({ class: "cm-time-gutter", markers: (view) => view.state.field(own).times }),
  ],
});

class Bar extends GutterMarker {
  readonly kind: string;
  readonly label: string;

  constructor(kind: string, label: string) {
    super();
    this.kind = kind;
    this.label = label;
  }

  override eq(other: Bar): boolean {
    return other.kind === this.kind && other.label === this.label;
  }

  override toDOM(): Node {
    const made = document.createElement("span");
    made.className = `cm-bar ${this.kind}`;
    if (this.label !== "") made.title = this.label;
    if (this.kind === "alarm") made.textContent = "!";
    else if (this.kind === "main" || this.kind === "thread") made.textContent = "▸";
    return made;
  }
}

class Time extends GutterMarker {
  readonly text: string;
  readonly label: string;
  readonly share: number;

  constructor(text: string, label: string, share: number) {
    super();
    this.text = text;
    this.label = label;
    this.share = share;
  }

  override eq(other: Time): boolean {
    return other.text === this.text && other.label === this.label && other.share === this.share;
  }

  override toDOM(): Node {
    const made = document.createElement("span");
    made.className = "cm-time";
    made.textContent = this.text;
    made.title = this.label;
    made.style.setProperty("--share", this.share.toFixed(3));
    return made;
  }
}

class NumberMark extends GutterMarker {
  override elementClass: string;

  constructor(name: string) {
    super();
    this.elementClass = name;
  }

  override eq(other: NumberMark): boolean {
    return other.elementClass === this.elementClass;
  }
}

function draw(text: Text, marks: LineMarks): Drawn {
  const lines = new RangeSetBuilder<Decoration>();
  const bars = new RangeSetBuilder<GutterMarker>();
  const numbers = new RangeSetBuilder<GutterMarker>();
  const times = new RangeSetBuilder<GutterMarker>();
  const main = marks.at[0] ?? 0;
  const marked = new Set([...marks.ran, ...marks.at, ...marks.times.keys(), ...marks.node, marks.alarm, marks.outlined].filter((line) => line >= 1 && line <= text.lines));
  for (const line of [...marked].sort((a, b) => a - b)) {
    const { from } = text.line(line);
    const isAlarm = line === marks.alarm;
    const isThread = marks.at.includes(line);
    if (line === main) lines.add(from, from, CLASSES.main);
    else if (isThread) lines.add(from, from, CLASSES.thread);
    if (isAlarm) lines.add(from, from, CLASSES.alarm);
    if (marks.node.has(line)) lines.add(from, from, CLASSES.node);
    if (line === marks.outlined) {
      lines.add(from, from, CLASSES.outlined);
      numbers.add(from, from, new NumberMark("cm-outlined-number"));
    }
    const kind = isAlarm ? "alarm" : line === main ? "main" : isThread ? "thread" : marks.ran.has(line) ? "ran" : "";
    if (kind !== "") bars.add(from, from, new Bar(kind, isAlarm ? marks.alarm_text : ""));
    const time = marks.times.get(line);
    if (time !== undefined) times.add(from, from, new Time(time.text, time.label, time.share));
  }
  return { lines: lines.finish(), bars: bars.finish(), numbers: numbers.finish(), times: times.finish() };
}

export function runMarks(): Extension {
  return field;
}
