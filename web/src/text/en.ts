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
};

export type Texts = { readonly [key in keyof typeof en]: string };
