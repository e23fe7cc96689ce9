/**
 * Colours, once for style sheets (as variables, `--ink` ...), canvases and the 3-D view. Text has a contrast of at least
 * 4.5:1 on `ground` and `panel`, graphics and the focus ring 3:1; the joints are the palette whose smallest distance
 * under three colour deficiencies is largest (29.8 CIELAB units).
 */

import { computed, signal } from "@preact/signals-core";

export type Theme = "system" | "light" | "dark";

const LIGHT = {
  /** Behind panels, of panels, of heads and fields. */
  ground: "#e8ebef",
  panel: "#ffffff",
  raised: "#f4f6f8",
  /** Behind a row under the pointer, and a chosen one. */
  hovered: "#eaf1fb",
  chosen: "#d5e5fa",
  line: "#d3d9e0",
  /** Edge of fields and buttons: 3:1. */
  edge: "#7d8894",
  ink: "#1a2129",
  /** Secondary text. */
  faint: "#56616d",
  accent: "#0b5cc0",
  /** Text on the accent. */
  on_accent: "#ffffff",
  focus: "#0b5cc0",
  error: "#b3121d",
  error_ground: "#fdecec",
  warning: "#8a5200",
  warning_ground: "#fdf3df",
  good: "#17693a",
  good_ground: "#e6f5eb",
  /** What belongs to an earlier text. */
  stale: "#626c77",
  /** The moment that is shown, and the one that is pointed at. */
  cursor: "#b3121d",
  hover: "#6f7a85",
  joints: ["#0000ff", "#d60000", "#227060", "#9a40d6", "#32325c", "#700016"],
};

export type Palette = { readonly [key in Exclude<keyof typeof LIGHT, "joints">]: string } & { readonly joints: readonly string[] };

const DARK: Palette = {
  ground: "#0c0f13",
  panel: "#14181d",
  raised: "#1b2027",
  hovered: "#1d2937",
  chosen: "#203a58",
  line: "#2c343d",
  edge: "#6f7d8b",
  ink: "#e4e9ee",
  faint: "#a0acb8",
  accent: "#6cb0ff",
  on_accent: "#08131f",
  focus: "#8cc2ff",
  error: "#ff8b86",
  error_ground: "#3a1a1c",
  warning: "#f0b354",
  warning_ground: "#33260e",
  good: "#6fd394",
  good_ground: "#12301f",
  stale: "#8592a0",
  cursor: "#ff8b86",
  hover: "#8592a0",
  joints: ["#769cd6", "#eb5e00", "#46ebca", "#b84dff", "#d6d676", "#c26b6b"],
};

export const PALETTES: { readonly light: Palette; readonly dark: Palette } = { light: LIGHT, dark: DARK };

/** What is set, and whether the system is dark. */
export const theme = signal<Theme>("system");
export const systemIsDark = signal(false);

export const isDark = computed(() => theme.value === "dark" || (theme.value === "system" && systemIsDark.value));

/** The colours in force. */
export const palette = computed(() => (isDark.value ? DARK : LIGHT));
