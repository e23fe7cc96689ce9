// Builds the pages into src/elitescript/page/built/: `studio.html` with its code and style beside it, `recorded.html` and
// `sweep.html` with everything inside, and THIRD_PARTY.txt. With --watch, again at each change, and not minified.

import { createHash } from "node:crypto";
import { mkdir, readFile, rm, writeFile } from "node:fs/promises";
import * as path from "node:path";
import { gzipSync } from "node:zlib";
import { build, context } from "esbuild";
import { licences } from "../tools/third_party.mjs";

const HERE = import.meta.dirname;
const TARGET = path.join(HERE, "..", "src", "elitescript", "page", "built");
const IS_WATCHING = process.argv.includes("--watch");
const TITLE = "Packages of other people that are part of the pages of elitescript, and their licences.";

const options = {
  absWorkingDir: HERE,
  entryPoints: { studio: "src/studio.tsx", recorded: "src/recorded.tsx", sweep: "src/sweep.tsx" },
  outdir: TARGET,
  bundle: true,
  format: "esm",
  target: "es2022",
  jsx: "automatic",
  jsxImportSource: "preact",
  minify: !IS_WATCHING,
  sourcemap: IS_WATCHING ? "inline" : false,
  // The texts of all licences are in THIRD_PARTY.txt, which the pages show.
  legalComments: "none",
  logLevel: "warning",
  metafile: true,
  write: false,
  plugins: [{ name: "pages", setup: (made) => made.onEnd((result) => (result.errors.length === 0 ? pages(result) : undefined)) }],
};

if (IS_WATCHING) {
  await (await context(options)).watch();
} else {
  await build(options);
}

async function pages(result) {
  const file = (name) => result.outputFiles.find((output) => path.basename(output.path) === name)?.text ?? "";
  const html = (name) => readFile(path.join(HERE, "src", name), "utf8");
  const loader = await html("loader.js");
  const frame = await html("single.html");
  const single = (name) => {
    // Its code is a script of its own, so that none of its names is a property of the window.
    const code = `{${file(`${name}.js`)}}`;
    const parts = { scripts: [loader, code].map(hash).join(" "), style: packed(file(`${name}.css`)), code: packed(code), loader };
    return frame.replace(/@@(\w+)@@/g, (place, part) => parts[part] ?? place);
  };
  const written = {
    "studio.html": await html("studio.html"),
    "studio.js": file("studio.js"),
    "studio.css": file("studio.css"),
    "recorded.html": single("recorded"),
    "sweep.html": single("sweep"),
    "THIRD_PARTY.txt": await licences(HERE, Object.keys(result.metafile.inputs), TITLE),
  };
  await rm(TARGET, { recursive: true, force: true });
  await mkdir(TARGET, { recursive: true });
  for (const [name, text] of Object.entries(written)) {
    await writeFile(path.join(TARGET, name), text);
  }
}

/** The only scripts that the policy of a page of one file lets run are those with these hashes. */
function hash(text) {
  return `'sha256-${createHash("sha256").update(text).digest("base64")}'`;
}

function packed(text) {
  return gzipSync(text, { level: 9 }).toString("base64");
}
