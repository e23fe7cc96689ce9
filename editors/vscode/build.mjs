// Bundles the extension (or, with --tests, its tests), and writes down whose packages are in it.

import { copyFile, mkdir, writeFile } from "node:fs/promises";
import * as path from "node:path";
import { build } from "esbuild";
import { licences } from "../../tools/third_party.mjs";

const HERE = import.meta.dirname;
const TITLE = "Packages of other people that are part of dist/extension.js, and their licences.";
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
  // Files of program trees are XML, whose grammar the editor has.
  const task = { name: "Elite Robots task", scopeName: "text.elitescript-task", patterns: [{ include: "text.xml" }] };
  await writeFile(path.join(HERE, "syntaxes", "elitescript-task.tmLanguage.json"), `${JSON.stringify(task, null, 2)}\n`);
  await copyFile(path.join(HERE, "..", "..", "LICENSE"), path.join(HERE, "LICENSE"));
  const made = await build({
    ...COMMON,
    entryPoints: ["src/extension.ts"],
    outfile: "dist/extension.js",
    external: ["vscode"],
    minify: true,
    metafile: true,
  });
  await writeFile(path.join(HERE, "THIRD-PARTY.txt"), await licences(HERE, Object.keys(made.metafile.inputs), TITLE));
}
