// Tests in the language, in the test explorer: what pytest collects of *.script files.

import * as path from "node:path";
import * as vscode from "vscode";
import { findElitescript, runToEnd } from "./program";

/** Exit codes of pytest: there are tests, there are none. */
const COLLECTED = [0, 5];
const OPTIONS = ["-q", "--no-header", "-p", "no:cacheprovider", "--color=no"];

/** Collects and runs through pytest, with the Python beside `elitescript`. Tests in Python are the Python extension's. */
export class ScriptTests implements vscode.Disposable {
  private readonly controller = vscode.tests.createTestController("elitescript", "EliteScript");
  private readonly watcher = vscode.workspace.createFileSystemWatcher("**/test_*.script");

  constructor() {
    this.controller.refreshHandler = () => this.refresh();
    this.controller.resolveHandler = (item) => (item ? Promise.resolve() : this.refresh());
    this.controller.createRunProfile("Run", vscode.TestRunProfileKind.Run, (request, token) => this.run(request, token), true);
    for (const changed of [this.watcher.onDidChange, this.watcher.onDidCreate, this.watcher.onDidDelete]) {
      changed(() => void this.refresh());
    }
  }

  dispose(): void {
    this.watcher.dispose();
    this.controller.dispose();
  }

  /** Collects the tests of all folders. */
  async refresh(): Promise<void> {
    const roots: vscode.TestItem[] = [];
    for (const folder of vscode.workspace.workspaceFolders ?? []) {
      if ((await vscode.workspace.findFiles(new vscode.RelativePattern(folder, "**/test_*.script"), undefined, 1)).length === 0) {
        continue;
      }
      const python = await pythonOf(folder.uri);
      if (python) {
        roots.push(...(await this.collected(folder, python)));
      }
    }
    this.controller.items.replace(roots);
  }

  private async collected(folder: vscode.WorkspaceFolder, python: string): Promise<vscode.TestItem[]> {
    const words = ["-m", "pytest", "--collect-only", ...OPTIONS];
    const ended = await runToEnd(python, words, folder.uri.fsPath).catch((error) => ({ code: -1, output: "", error: String(error) }));
    const roots = await this.items(folder, namesIn(ended.output));
    if (!COLLECTED.includes(ended.code)) {
      const failed = this.controller.createTestItem(`${folder.uri.toString()}#`, `pytest in ${folder.name}`);
      failed.error = `${ended.error}${ended.output}`;
      roots.push(failed);
    }
    return roots;
  }

  private async items(folder: vscode.WorkspaceFolder, names: string[]): Promise<vscode.TestItem[]> {
    const byFile = new Map<string, vscode.TestItem>();
    for (const name of names) {
      const [file = "", test = ""] = name.split("::");
      const uri = vscode.Uri.joinPath(folder.uri, file);
      let parent = byFile.get(file);
      if (!parent) {
        parent = this.controller.createTestItem(`${folder.uri.toString()}#${file}`, file, uri);
        byFile.set(file, parent);
      }
      const item = this.controller.createTestItem(`${folder.uri.toString()}#${name}`, test, uri);
      item.range = await rangeOf(uri, test);
      parent.children.add(item);
    }
    return [...byFile.values()];
  }

  private all(): vscode.TestItem[] {
    return [...this.controller.items].map(([, item]) => item).filter((item) => !item.error);
  }

  private async run(request: vscode.TestRunRequest, token: vscode.CancellationToken): Promise<void> {
    const run = this.controller.createTestRun(request);
    const stop = new AbortController();
    token.onCancellationRequested(() => stop.abort());
    try {
      for (const [folder, items] of byFolder(request.include ?? this.all())) {
        const asked = items.filter((item) => !request.exclude?.includes(item));
        asked.forEach((item) => run.started(item));
        const uri = vscode.Uri.parse(folder);
        const python = await pythonOf(uri);
        if (!python) {
          asked.forEach((item) => run.errored(item, new vscode.TestMessage("The command `elitescript` was not found.")));
          continue;
        }
        const words = ["-m", "pytest", "-v", "-rA", "--no-header", "-p", "no:cacheprovider", "--color=no", ...asked.map(nameOf)];
        const ended = await runToEnd(python, words, uri.fsPath, stop.signal);
        run.appendOutput(`${ended.output}${ended.error}`.replace(/\r?\n/g, "\r\n"));
        const outcomes = outcomesIn(ended.output);
        asked.forEach((item) => report(run, item, outcomes.get(nameOf(item)), `${ended.output}${ended.error}`));
      }
    } catch (error) {
      if (!stop.signal.aborted) {
        run.appendOutput(`${String(error)}\r\n`);
      }
    } finally {
      run.end();
    }
  }
}

/** What pytest says of a test in its summary. */
export interface Outcome {
  word: string;
  text: string;
}

/** Returns the names of script tests in what `pytest --collect-only -q` prints. */
export function namesIn(output: string): string[] {
  return output.split(/\r?\n/).filter((line) => /\.script::\S+$/.test(line));
}

/** Returns the outcomes in the summary that `pytest -rA` prints, by name of the test. */
export function outcomesIn(output: string): Map<string, Outcome> {
  const found = new Map<string, Outcome>();
  for (const line of output.split(/\r?\n/)) {
    const match = /^(PASSED|FAILED|ERROR|SKIPPED|XFAIL|XPASS) (\S+\.script::\S+?)(?: - (.*))?$/.exec(line);
    if (match) {
      found.set(match[2]!, { word: match[1]!, text: match[3] ?? "" });
    }
  }
  return found;
}

function report(run: vscode.TestRun, item: vscode.TestItem, outcome: Outcome | undefined, output: string): void {
  if (outcome?.word === "PASSED" || outcome?.word === "XFAIL") {
    run.passed(item);
  } else if (outcome?.word === "SKIPPED") {
    run.skipped(item);
  } else if (outcome?.word === "FAILED") {
    const message = new vscode.TestMessage(sectionOf(output, item.label) ?? outcome.text);
    const line = /\.script:(\d+): /.exec(`${message.message as string}`)?.[1];
    if (line && item.uri) {
      message.location = new vscode.Location(item.uri, new vscode.Position(Number(line) - 1, 0));
    }
    run.failed(item, message);
  } else {
    run.errored(item, new vscode.TestMessage(outcome?.text || output));
  }
}

/** Returns what pytest prints of the failure of a test, below a line of underscores with its name. */
function sectionOf(output: string, test: string): string | undefined {
  const lines = output.split(/\r?\n/);
  const first = lines.findIndex((line) => /^_+ /.test(line) && line.includes(` ${test} `));
  if (first < 0) {
    return undefined;
  }
  const rest = lines.slice(first + 1);
  const end = rest.findIndex((line) => /^(_+ .* _+|=+ .* =+)$/.test(line));
  return rest.slice(0, end < 0 ? undefined : end).join("\n").trim();
}

function byFolder(items: readonly vscode.TestItem[]): Map<string, vscode.TestItem[]> {
  const found = new Map<string, vscode.TestItem[]>();
  const add = (item: vscode.TestItem): void => {
    if (item.children.size > 0) {
      item.children.forEach(add);
    } else {
      const folder = item.id.split("#")[0]!;
      found.set(folder, [...(found.get(folder) ?? []), item]);
    }
  };
  items.forEach(add);
  return found;
}

function nameOf(item: vscode.TestItem): string {
  return item.id.slice(item.id.indexOf("#") + 1);
}

async function rangeOf(uri: vscode.Uri, test: string): Promise<vscode.Range | undefined> {
  const text = new TextDecoder().decode(await vscode.workspace.fs.readFile(uri));
  const line = text.split(/\r\n|\r|\n/).findIndex((row) => new RegExp(`^\\s*def\\s+${test}\\b`).test(row));
  return line < 0 ? undefined : new vscode.Range(line, 0, line, 0);
}

/** Returns the Python of the environment that `elitescript` is in. */
async function pythonOf(uri: vscode.Uri): Promise<string | undefined> {
  const found = await findElitescript(uri);
  return found && path.join(path.dirname(found.command), process.platform === "win32" ? "python.exe" : "python");
}
