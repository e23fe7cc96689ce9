/**
 * The messages between the page and its source: a live engine, a recorded run, or a controller on the network.
 *
 * The page knows nothing else of where its data comes from. Text messages are JSON; rows are binary (`rows.ts`). Times
 * are seconds of robot time; joints rad; lengths m. Poses of the TCP (`tcp_pose`, `asked_pose`, columns `x` to `rz`) are
 * `[x, y, z, rx, ry, rz]` with roll, pitch and yaw in the base frame, R = Rz(rz) Ry(ry) Rx(rx), as in programs and
 * traces; poses of solids and frames (`Part.pose`, `Scene.tcp`, `mounting`) have rotation vectors. Lines and columns
 * count from 1, columns in characters (code points), ends are exclusive. NaN and infinities are the strings "NaN",
 * "Infinity", "-Infinity". The Python side is `elitescript.conversation`.
 *
 * `run` is a number that grows with each run of a program; the page drops what is not of the newest. `ask` is a number
 * of the page's own; the answer repeats it.
 */

export const PROTOCOL = 1;

export type Six = readonly [number, number, number, number, number, number];
export type Json = null | boolean | number | string | readonly Json[] | { readonly [key: string]: Json };
export type Value = boolean | number | string;

/** What a source can do. Controls of what it cannot are absent. */
export type Ability =
  | "edit" // takes texts: `program`
  | "save"
  | "services" // answers `service`: completion, hover, ...
  | "seek" // exact moments at any time of the run
  | "step"
  | "record" // records runs for comparisons and pages: `record`
  | "inputs" // schedules of inputs in the options of a program
  | "connect" // can allow real connections
  | "live" // time goes on by itself: `moment` messages
  | "signals" // sets signals now
  | "control" // power, brakes, programs, speed, jog, freedrive
  | "faults"; // of a robot of our own on this computer: faults, emergency stop, safeguard

// ---------------------------------------------------------------- from the page

/** Options of a live run. What is absent is as the command line gave it. */
export interface RunOptions {
  readonly robot?: string;
  readonly firmware?: string;
  readonly world?: string;
  readonly joints?: Six;
  readonly seed?: number;
  /** End of the run; 120 s if absent. */
  readonly until_s?: number;
  /** Whether sockets, serial ports and other connections of the program may leave the simulation. */
  readonly may_connect?: boolean;
  /** Signals that take values from outside at a time; 0 s: before the program begins. */
  readonly inputs?: readonly { readonly name: string; readonly value: Value; readonly at_s: number }[];
}

export type ControlAction =
  | "power_on" | "power_off" | "release_brakes" | "play" | "pause" | "resume" | "stop" | "unlock" | "close_popup"
  | "freedrive_on" | "freedrive_off" | "emergency_stop" | "emergency_stop_release" | "safeguard_open" | "safeguard_close";

export type Service =
  | "completion" | "resolve" | "hover" | "signature" | "definition" | "references" | "rename" | "actions" | "format"
  | "tokens" | "hints" | "typing" | "folding" | "outline" | "explain" | "commands" | "robots" | "mesh" | "examples" | "signals";

export type ToSource =
  /** A new text of the editor: is checked, and run. `version` grows with each text. */
  | { readonly type: "program"; readonly version: number; readonly text: string; readonly options?: RunOptions }
  /** Lets a run that reached its limit of time go on to `until_s`. */
  | { readonly type: "go_on"; readonly run: number; readonly until_s: number }
  /** Ends what is being computed. */
  | { readonly type: "stop" }
  /** Asks for rows of a stretch, `step_s` apart; they come as rows and end with `detail_ended`. */
  | { readonly type: "detail"; readonly run: number; readonly ask: number; readonly from_s: number; readonly to_s: number; readonly step_s: number }
  /** Asks for the exact state at a time: `state`. */
  | { readonly type: "seek"; readonly run: number; readonly ask: number; readonly t: number }
  /** Asks for the state at the next (1) or previous (-1) beginning of a statement of a thread, from `position` of the last `state`, else from `t`. */
  | { readonly type: "step"; readonly run: number; readonly ask: number; readonly by: 1 | -1; readonly thread: string; readonly t: number; readonly position?: string }
  | { readonly type: "service"; readonly ask: number; readonly service: Service; readonly version: number; readonly line?: number; readonly column?: number; readonly [argument: string]: Json | undefined }
  /** Writes the file. `seen`: digest of the file as the page knows it; `force`: although it has changed since. */
  | { readonly type: "save"; readonly ask: number; readonly text: string; readonly seen: string; readonly force?: boolean }
  /** Runs a text from begin to end, with the options of the last program, or reads a trace; answered by `recorded`. */
  | { readonly type: "record"; readonly ask: number; readonly name: string; readonly text: string; readonly form: "recording" | "page" }
  /** Opens a file of the folder (a relative path), or a new one. */
  | { readonly type: "open"; readonly ask: number; readonly name: string }
  /** What the page remembers from one start to the next (sizes, language, theme); opaque to the source. */
  | { readonly type: "settings"; readonly values: { readonly [key: string]: Json } }
  // with "control", "signals", "faults"
  | { readonly type: "control"; readonly ask: number; readonly action: ControlAction }
  | { readonly type: "signal"; readonly ask: number; readonly name: string; readonly value: Value }
  | { readonly type: "speed"; readonly ask: number; readonly fraction: number }
  | { readonly type: "fault"; readonly ask: number; readonly words: readonly string[] }
  | { readonly type: "load"; readonly ask: number; readonly program: string }
  /** Sends the text of the editor to the controller as a program, and runs it there. */
  | { readonly type: "send_program"; readonly ask: number; readonly text: string }
  /** Moves while it is repeated, at most every 200 ms; `jog_end`, 300 ms without one, or a lost connection stop. `speed` from 0 to 1. */
  | { readonly type: "jog"; readonly frame: "joint" | "base" | "tool"; readonly axis: 0 | 1 | 2 | 3 | 4 | 5; readonly direction: 1 | -1; readonly speed: number }
  | { readonly type: "jog_end" }
  /** Keeps hand guiding on, which ends 2 s after the last of these; it begins none. */
  | { readonly type: "guiding" };

// ---------------------------------------------------------------- from the source

/** A solid in the frame of a link: 0 is the base, 1 to 6 the frames of the modified DH rule, 7 the flange. */
export interface Part {
  readonly link: number;
  /** `cylinder`: radius, length along z, centred; `cone`: radius at -z, radius at +z, length; `sphere`: radius; `box`: x, y, z; `capsule`: radius, length between the centres of its ends. */
  readonly kind: "cylinder" | "cone" | "sphere" | "box" | "capsule";
  readonly size: readonly number[];
  /** Of the solid's centre in the frame of its link (`world` things: in the base frame, link 0). */
  readonly pose: Six;
  readonly role: "base" | "housing" | "tube" | "cap" | "ring" | "flange" | "tool" | "payload" | "thing";
  /** Of a thing or a tool, as the world file has it. */
  readonly name?: string;
  readonly color?: string;
}

export interface Scene {
  readonly type: "scene";
  readonly robot: string;
  /** a, d, alpha of modified DH for joints 1 to 6: T_i = Rx(alpha) Tx(a) Rz(q) Tz(d). */
  readonly dh: readonly { readonly a: number; readonly d: number; readonly alpha: number }[];
  readonly parts: readonly Part[];
  readonly limits: {
    readonly position_min: Six; readonly position_max: Six; readonly speed: Six; readonly acceleration: Six;
    readonly tcp_speed: number; readonly reach: number;
  };
  /** TCP in the flange frame, and the payload, as the run begins. */
  readonly tcp: Six;
  readonly payload_kg: number;
  readonly center_of_gravity: readonly [number, number, number];
  /** Pose of the base in the world, for the direction of gravity. */
  readonly mounting: Six;
  /** Name of the user's URDF, whose files `service: "mesh"` gives. */
  readonly urdf?: string;
}

export interface Problem {
  readonly severity: "error" | "warning" | "information" | "hint";
  readonly code: string;
  readonly text: string;
  readonly hint: string;
  readonly line: number;
  readonly column: number;
  readonly end_line: number;
  readonly end_column: number;
  readonly template: string;
  readonly values: Values;
  readonly hint_template: string;
  readonly hint_values: Values;
  /** Edits of a safe fix, with its title. */
  readonly fix?: { readonly title: string; readonly edits: readonly TextEdit[] };
}

export interface TextEdit { readonly line: number; readonly column: number; readonly end_line: number; readonly end_column: number; readonly text: string }

/**
 * An event as `run --json` has it: its type, time, and further fields of that type (docs/reference). Long texts are cut;
 * `cut` is how many characters are missing.
 */
export interface RunEvent { readonly type: string; readonly t: number; readonly line?: number; readonly thread?: string; readonly cut?: number; readonly [field: string]: Json | undefined }

export interface Move { readonly start_s: number; readonly end_s: number; readonly kind: string; readonly line: number }

export interface ThreadState { readonly name: string; readonly line: number; readonly waits_for: string; readonly function: string; readonly because?: string }

export interface VariableState { readonly name: string; readonly value: string; readonly type: string; readonly changed: boolean }

/** The exact state at a moment. */
export interface Moment {
  readonly t: number;
  readonly line: number;
  readonly joints: Six;
  readonly tcp_pose: Six;
  readonly globals: readonly VariableState[];
  readonly signals: { readonly [name: string]: Value };
  readonly threads: readonly ThreadState[];
  /** How many further globals and threads are left out, if any are. */
  readonly left_out?: number;
  /** Where in the program this is, for `step`. */
  readonly position?: string;
  readonly tcp_force?: Six;
}

/** What stands in the holes of a template (`{name}`; braces for themselves are doubled): what is shown, or a text with parts of its own. */
export interface Values { readonly [name: string]: Json }

/** What a text is made of. */
export interface Parts { readonly template: string; readonly values: Values }

export interface AlarmReport {
  readonly t: number; readonly line: number; readonly column: number; readonly code: string; readonly text: string;
  readonly hints: readonly string[];
  readonly template: string; readonly values: Values;
  /** Of each hint. */
  readonly hint_parts: readonly Parts[];
  /** Joints or pose that were asked for, where the alarm is about a target. */
  readonly asked_joints?: Six; readonly asked_pose?: Six;
  /** The limit that was broken, in words: "joint 3: 3.2 rad, limit 3.05 rad". */
  readonly limit?: string;
}

export interface CycleRow { readonly line: number; readonly moving_s: number; readonly standing_s: number; readonly visits: number }

export interface Contact {
  readonly start_s: number; readonly end_s: number; readonly line: number;
  readonly first: string; readonly second: string;
  /** Deepest penetration, m, at `t`; or the closest distance of the run (then `is_contact` is false). */
  readonly distance_m: number; readonly t: number; readonly is_contact: boolean;
  readonly points?: readonly [readonly [number, number, number], readonly [number, number, number]];
}

/** A node of a graphical program, in English; its number is that of its place in the list, from 1. */
export interface TreeRow { readonly level: number; readonly kind: string; readonly name: string; readonly summary: string; readonly is_suppressed: boolean }

/** A graphical program, whose script is the text. */
export interface ProgramTree {
  /** Empty where the file is no task, and the text shows it as it is; and in recordings, which know no tree. */
  readonly rows: readonly TreeRow[];
  /** For each line of the text a number of `places`: that of its row, if there are rows; 0: it belongs to no node. */
  readonly lines: readonly number[];
  /** Places as people say them, such as `4 MoveJ > 5 W1`; the first is empty. */
  readonly places: readonly string[];
}

export type LeftOut = { readonly [severity in Problem["severity"]]?: number };

export type FromSource =
  | { readonly type: "hello"; readonly protocol: number; readonly product: string; readonly mode: "live" | "recorded" | "connected";
      readonly abilities: readonly Ability[]; readonly settings?: { readonly [key: string]: Json };
      /** Title of the page: file, or which controller at which address. */
      readonly title: string;
      /** Names of programs that can be opened or loaded. */
      readonly programs?: readonly string[] }
  | Scene
  /** The file that is open. `draft`: text that was never saved, and of which file text it is a draft. */
  | { readonly type: "file"; readonly name: string; readonly text: string; readonly digest: string; readonly is_new?: boolean; readonly tree?: ProgramTree;
      readonly draft?: { readonly text: string; readonly seen: string; readonly at: string } }
  /** The file has changed on disk (or is gone: no text). */
  | { readonly type: "file_changed"; readonly name: string; readonly text?: string; readonly digest: string; readonly tree?: ProgramTree }
  | { readonly type: "saved"; readonly ask: number; readonly digest: string }
  /** `rules`: how many were checked. `start`: the text holds nothing yet, and no run comes; the robot as a run would begin.
   * `left_out`: how many more findings there are, by severity. */
  | { readonly type: "problems"; readonly version: number; readonly list: readonly Problem[]; readonly compiles: boolean; readonly rules?: number; readonly start?: Moment;
      readonly left_out?: LeftOut }
  /** `same_until_s`: up to then it is the run before; those rows are not sent again, all else is. `options`: as they are in force. */
  | { readonly type: "run_began"; readonly run: number; readonly version: number; readonly same_until_s: number; readonly options: RunOptions }
  | { readonly type: "progress"; readonly run: number; readonly t: number }
  | { readonly type: "events"; readonly run: number; readonly list: readonly RunEvent[] }
  /** Takes the place of the one before: events that are not sent, the first at `from_s`, and about how many bytes these and cut texts have. */
  | { readonly type: "left_out"; readonly run: number; readonly events: number; readonly bytes: number; readonly from_s: number }
  /** Further begins of stretches of a thread in a line; line 0: there is no such thread. Each lasts until the next. */
  | { readonly type: "lines"; readonly run: number; readonly thread: string; readonly t: readonly number[]; readonly line: readonly number[] }
  /** Further times at which nodes of a graphical program began: numbers of rows of the tree. */
  | { readonly type: "marks"; readonly run: number; readonly t: readonly number[]; readonly node: readonly number[] }
  | { readonly type: "moves"; readonly run: number; readonly list: readonly Move[] }
  | { readonly type: "cycle"; readonly run: number; readonly table: readonly CycleRow[] }
  | { readonly type: "contacts"; readonly run: number; readonly list: readonly Contact[] }
  | { readonly type: "run_ended"; readonly run: number; readonly state: "finished" | "stopped" | "alarm" | "time_limit" | "stuck" | "killed";
      readonly moment: Moment; readonly alarm?: AlarmReport; readonly killed?: string; readonly refused_connections?: readonly string[];
      /** What the run itself has found, the worst first, besides alarm and contacts. */
      readonly findings?: readonly RunFinding[] }
  | { readonly type: "state"; readonly ask: number; readonly run: number; readonly moment: Moment }
  | { readonly type: "detail_ended"; readonly ask: number; readonly run: number }
  | { readonly type: "answer"; readonly ask: number; readonly result: Json }
  | { readonly type: "done"; readonly ask: number; readonly text?: string }
  /** `content`: a recording in base 64, or the text of a page. */
  | { readonly type: "recorded"; readonly ask: number; readonly content: string }
  | { readonly type: "refused"; readonly ask?: number; readonly text: string; readonly conflict?: { readonly text: string; readonly digest: string } }
  | { readonly type: "notice"; readonly severity: "information" | "warning" | "error"; readonly text: string }
  // with "live"
  | { readonly type: "moment"; readonly moment: Moment; readonly controller: ControllerState };

/** `t`: of the first time, s; `count`: how often. */
export interface RunFinding {
  readonly severity: Problem["severity"];
  readonly code: string;
  readonly line: number;
  readonly t: number;
  readonly count: number;
  readonly text: string;
  readonly hint: string;
  readonly template: string;
  readonly values: Values;
  readonly hint_template: string;
  readonly hint_values: Values;
}

export interface ControllerState {
  /** "connected", "connecting", "lost". */
  readonly link: "connected" | "connecting" | "lost";
  readonly address: string;
  readonly model: string; readonly firmware: string; readonly serial: string;
  readonly robot_mode: string; readonly safety_mode: string; readonly task_state: string; readonly program: string;
  readonly speed_fraction: number;
  readonly target_joints?: Six;
  readonly popup?: { readonly title: string; readonly text: string; readonly level: string; readonly id: number };
  readonly operation_mode?: string;
}
