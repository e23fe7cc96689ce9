/** Icons, drawn on 16 by 16; each stands beside or instead of a text that its button carries as its name. */

const PATHS = {
  run: "M4 2.5v11l9-5.5z",
  pause: "M4 3h3v10H4zM9 3h3v10H9z",
  stop: "M3.5 3.5h9v9h-9z",
  step: "M3 3v10l6.5-5zM11 3h2v10h-2z",
  step_back: "M13 3v10L6.5 8zM3 3h2v10H3z",
  save: "M2.5 2.5h8.5l2.5 2.5v8.5h-11zM5 2.5v4h5v-4M4.5 13.5v-4h7v4",
  undo: "M6 3 2.5 6.5 6 10M3 6.5h6a4 4 0 0 1 0 7H7",
  redo: "M10 3l3.5 3.5L10 10M13 6.5H7a4 4 0 0 0 0 7h2",
  close: "M4 4l8 8M12 4l-8 8",
  open: "M4 6l4 4 4-4",
  closed: "M6 4l4 4-4 4",
  error: "M8 1.5a6.5 6.5 0 1 0 0 13 6.5 6.5 0 0 0 0-13zM8 4.5v4.2M8 10.7v1",
  warning: "M8 2 1.5 13.5h13zM8 6.3v3.5M8 11.2v.9",
  information: "M8 1.5a6.5 6.5 0 1 0 0 13 6.5 6.5 0 0 0 0-13zM8 7.2v4M8 4.4v1",
  contact: "M1.5 8a4 4 0 1 0 8 0 4 4 0 1 0-8 0M6.5 8a4 4 0 1 0 8 0 4 4 0 1 0-8 0",
  compare: "M2 11c3 0 3-6 6-6s3 6 6 6M2 5c3 0 3 6 6 6s3-6 6-6",
  link: "M6.5 9.5l3-3M7 4.5l1.7-1.7a2.9 2.9 0 0 1 4.1 4.1L11 8.6M9 11.5l-1.7 1.7a2.9 2.9 0 0 1-4.1-4.1L5 7.4",
  share: "M8 10V2.5M5 5.5l3-3 3 3M3 8v5.5h10V8",
  options: "M2 4.5h6M11 4.5h3M2 11.5h3M8 11.5h6M8 4.5a1.5 1.5 0 1 0 3 0 1.5 1.5 0 1 0-3 0M5 11.5a1.5 1.5 0 1 0 3 0 1.5 1.5 0 1 0-3 0",
} as const;

const FILLED: ReadonlySet<string> = new Set(["run", "pause", "stop", "step", "step_back"]);

export type IconName = keyof typeof PATHS;

export function Icon({ name }: { name: IconName }) {
  return (
    <svg class={FILLED.has(name) ? "icon filled" : "icon"} viewBox="0 0 16 16" width="16" height="16" aria-hidden="true" focusable="false">
      <path d={PATHS[name]} />
    </svg>
  );
}
