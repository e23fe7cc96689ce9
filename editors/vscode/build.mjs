// Bundles the extension (or, with --tests, its tests), and writes down whose packages are in it.

import { copyFile, mkdir, readFile, writeFile } from "node:fs/promises";
import * as path from "node:path";
import { build } from "esbuild";

const HERE = import.meta.dirname;
const COMMON = { bundle: true, platform: "node", target: "node20", format: "cjs", logLevel: "warning", absWorkingDir: HERE };

if (process.argv.includes("--tests")) {
  await build({
    ...COMMON,
    entryPoints: ["test/all.test.ts"],
    outfile: "build/tests.cjs",
    sourcemap: "inline",
    external: ["vscode-oniguruma", "vscode-textmate"],
    // Neither an editor nor the client library is in these tests.
    alias: { vscode: "./test/fake_vscode.ts", "vscode-languageclient/node": "./test/fake_client.ts" },
  });
} else {
  await mkdir(path.join(HERE, "syntaxes"), { recursive: true });
  const grammar = "elitescript.tmLanguage.json";
  await copyFile(path.join(HERE, "..", "textmate", grammar), path.join(HERE, "syntaxes", grammar));
  await copyFile(path.join(HERE, "..", "..", "LICENSE"), path.join(HERE, "LICENSE"));
  const made = await build({
    ...COMMON,
    entryPoints: ["src/extension.ts"],
    outfile: "dist/extension.js",
    external: ["vscode"],
    minify: true,
    metafile: true,
  });
  await writeFile(path.join(HERE, "THIRD-PARTY.txt"), await licences(Object.keys(made.metafile.inputs)));
}

/** Returns name, version and licence of every package that was bundled. */
async function licences(inputs) {
  const packages = new Set();
  for (const input of inputs) {
    const found = /^(.*node_modules\/(?:@[^/]+\/)?[^/]+)\//.exec(input);
    if (found) {
      packages.add(found[1]);
    }
  }
  const parts = ["Packages of other people that are part of dist/extension.js, and their licences."];
  for (const folder of [...packages].sort()) {
    const about = JSON.parse(await readFile(path.join(HERE, folder, "package.json"), "utf8"));
    let text = "";
    for (const name of ["LICENSE", "LICENSE.md", "LICENSE.txt", "License.txt", "license.txt", "license"]) {
      text ||= await readFile(path.join(HERE, folder, name), "utf8").catch(() => "");
    }
    if (!text) {
      throw new Error(`${about.name} has no text of its licence`);
    }
    parts.push(`${"-".repeat(80)}\n${about.name} ${about.version} (${about.license})\n\n${text.trim()}`);
  }
  return `${parts.join("\n\n")}\n`;
}
