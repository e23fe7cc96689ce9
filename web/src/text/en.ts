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

  // ---- Robot

  // ---- Time line

  // ---- lists

  // ---- Pendant

  // ---- compare and share
};

export type Texts = { readonly [key in keyof typeof en]: string };
