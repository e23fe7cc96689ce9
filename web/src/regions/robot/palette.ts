/** Colours of the scene, light and dark. */

import type { Part } from "../../source/messages.ts";

export interface Palette {
  readonly isDark: boolean;
  readonly parts: { readonly [role in Part["role"]]: string };
  readonly ink: string;
  readonly grid: string;
  readonly shadow: string;
  readonly axes: readonly [string, string, string];
  readonly hovered: string;
  readonly asked: string;
  readonly target: string;
  readonly compared: string;
  readonly stale: string;
  readonly contact: string;
}

const LIGHT: Palette = {
  isDark: false,
  parts: {
    base: "#59636f", housing: "#d3d9e0", tube: "#eef1f4", cap: "#2b86a6", ring: "#262c33", flange: "#8a94a0",
    tool: "#5d6b7a", payload: "#a98b5d", thing: "#c2a878",
  },
  ink: "#20262d", grid: "#76828f", shadow: "#27313c",
  axes: ["#c62828", "#1b7f37", "#1d4fd7"],
  hovered: "#1f77d0", asked: "#c62828", target: "#8a5a00", compared: "#7b3fb5", stale: "#8b949e", contact: "#c2185b",
};

const DARK: Palette = {
  isDark: true,
  parts: {
    base: "#5f6b78", housing: "#b9c2cc", tube: "#d9dfe5", cap: "#3aa0c2", ring: "#1c2127", flange: "#98a3af",
    tool: "#74839a", payload: "#b3945f", thing: "#9c8558",
  },
  ink: "#e8edf2", grid: "#8b98a6", shadow: "#000000",
  axes: ["#ff6b63", "#4cc46a", "#6ea2ff"],
  hovered: "#63b3ff", asked: "#ff6b63", target: "#f0b429", compared: "#c792ff", stale: "#77818c", contact: "#ff6fa8",
};

export function palette(isDark: boolean): Palette {
  return isDark ? DARK : LIGHT;
}

/** Returns whether a colour of CSS, as computed (`rgb(r, g, b)`), is dark. */
export function isDarkColour(computed: string): boolean {
  const [r = 255, g = 255, b = 255] = (computed.match(/[\d.]+/g) ?? []).map(Number);
  return 0.2126 * r + 0.7152 * g + 0.0722 * b < 110;
}
