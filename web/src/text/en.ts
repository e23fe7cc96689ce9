/** Every text that people read, in English. `zh.ts` has the same keys. */

export const en = {
  region_program: "Program",
  region_problems: "Problems",
  region_robot: "Robot",
  region_variables: "Variables",
  region_signals: "Signals",
  region_threads: "Threads",
  region_timeline: "Time line",
  region_messages: "Messages",
  region_cycle: "Cycle time",
  region_pendant: "Pendant",

  // ---- toolbar, layout, keys
  not_saved: "Not saved: {why}",
  not_opened: "{name} was not opened: {why}",
  link_lost: "The link to the source is lost.",
  file_gone: "{name} is gone from the disk. Save writes it again.",
  file_read_again: "{name} has changed on the disk and was read again.",
  no_state: "No state at this time: {why}",

  // ---- Program
  editor_name: "Program text",
  editor_scroller: "Program text, scrolling area",
  editor_times: "times by line",
  editor_hints: "hints",
  editor_hint: "hint: {hint}",
  editor_line_time: "moving {moving} s, standing {standing} s, {visits} visits",
  editor_empty: "No program: open a file or start from an example.",
  editor_on_controller: "The program is on the controller.",
  editor_no_text: "The recording holds no text of the program.",
  editor_new_name: "New name",
  editor_no_name: "No name here.",
  editor_no_definition: "No definition in this text.",
  editor_uses: "{count} uses",
  editor_no_fix: "No fix here.",
  editor_formatted: "Formatted.",
  editor_nothing_to_format: "Nothing to format.",

  // ---- Robot

  // ---- Time line

  // ---- lists

  // ---- Pendant

  // ---- compare and share
};

export type Texts = { readonly [key in keyof typeof en]: string };
