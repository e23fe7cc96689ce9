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
  robot_fit: "Fit the view (F)",
  robot_fit_short: "Fit",
  robot_front: "Front view (1)",
  robot_front_short: "Front",
  robot_side: "Side view (2)",
  robot_side_short: "Side",
  robot_top: "Top view (3)",
  robot_top_short: "Top",
  robot_iso: "View from a corner (4)",
  robot_iso_short: "Iso",
  robot_reach: "Sphere of reach",
  robot_reach_short: "Reach",
  robot_views: "Views of the robot",
  robot_keys: "Arrow keys turn the view, with Shift they move it; plus and minus zoom.",
  robot_none: "No robot yet.",
  robot_no_webgl: "This browser gives no WebGL: the robot is drawn flat, from above and from the side.",
  robot_mesh_fault: "Your meshes are not drawn. {why}",
  robot_speed: "TCP speed, {unit}",
  robot_stale: "earlier run",
  robot_compared: "compared run",
  robot_target: "target",
  robot_asked: "pose that was asked for",
  robot_words: "{robot} at {t}: TCP at x {x}, y {y}, z {z}; joints {joints} {unit}.",
  robot_words_line: "Line {line}.",
  robot_words_asked: "Alarm: {why}.",
  robot_words_contacts: "Contacts: {count}.",
  robot_contact: "{first} – {second}: {millimetres} mm deep",
  robot_closest: "{first} – {second}: {millimetres} mm apart",
  robot_joints: "Joints, {unit}",
  robot_joint_range: "Joint {joint}: from {low} to {high}",
  robot_near_limit: "limit",
  robot_tcp: "TCP in the base frame, {length} and {angle}",

  // ---- Time line

  // ---- lists

  // ---- Pendant

  // ---- compare and share
};

export type Texts = { readonly [key in keyof typeof en]: string };
