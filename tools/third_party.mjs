// Texts of the licences of the packages that a bundle contains.

import { readFile } from "node:fs/promises";
import * as path from "node:path";

const FILES = ["LICENSE", "LICENSE.md", "LICENSE.txt", "License.txt", "license.txt", "license", "LICENCE"];

/**
 * Returns name, version and licence of every package of a bundle.
 *
 * `folder`: where it was built; `inputs`: files of which it was made, as esbuild's metafile names them; `title`: first
 * line. Throws if a package has no text of its licence.
 */
export async function licences(folder, inputs, title) {
  const packages = new Set();
  for (const input of inputs) {
    const found = /^(.*node_modules\/(?:@[^/]+\/)?[^/]+)\//.exec(input);
    if (found) {
      packages.add(found[1]);
    }
  }
  const parts = [title];
  for (const name of [...packages].sort()) {
    const about = JSON.parse(await readFile(path.join(folder, name, "package.json"), "utf8"));
    let text = "";
    for (const file of FILES) {
      text ||= await readFile(path.join(folder, name, file), "utf8").catch(() => "");
    }
    if (!text) {
      throw new Error(`${about.name} has no text of its licence`);
    }
    parts.push(`${"-".repeat(80)}\n${about.name} ${about.version} (${about.license})\n\n${text.trim()}`);
  }
  return `${parts.join("\n\n")}\n`;
}
