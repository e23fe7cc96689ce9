// Finds the command `elitescript`, and runs it.

import { execFile } from "node:child_process";
import { constants, promises as files } from "node:fs";
import * as path from "node:path";
import * as vscode from "vscode";

const IS_WINDOWS = process.platform === "win32";
const NAME = IS_WINDOWS ? "elitescript.exe" : "elitescript";
const BIN = IS_WINDOWS ? "Scripts" : "bin";

/** The command, and where it was found, in words. */
export interface Found {
  command: string;
  where: string;
}

export interface Ended {
  code: number;
  output: string;
  error: string;
}

/** Settings of the section `elitescript` that apply to a file. */
export function settings(uri?: vscode.Uri): vscode.WorkspaceConfiguration {
  return vscode.workspace.getConfiguration("elitescript", uri);
}

/** Returns the command of a file's workspace, or undefined if there is none; nothing is run for it. */
export async function findElitescript(uri?: vscode.Uri): Promise<Found | undefined> {
  const folder = folderOf(uri);
  const set = settings(uri).get<string>("path", "").trim();
  if (set) {
    const command = folder && !path.isAbsolute(set) && /[\\/]/.test(set) ? path.join(folder, set) : set;
    return { command, where: "the setting elitescript.path" };
  }
  for (const [command, where] of await candidates(folder, uri)) {
    if (await isExecutable(command)) {
      return { command, where };
    }
  }
  return undefined;
}

async function candidates(folder: string | undefined, uri?: vscode.Uri): Promise<[string, string][]> {
  const found: [string, string][] = [];
  for (const name of folder ? [".venv", "venv"] : []) {
    found.push([path.join(folder!, name, BIN, NAME), `${name} of the workspace`]);
  }
  const python = await selectedPython(uri);
  if (python) {
    found.push([path.join(path.dirname(python), NAME), "the selected Python environment"]);
  }
  for (const place of (process.env["PATH"] ?? "").split(path.delimiter).filter(Boolean)) {
    found.push([path.join(place, NAME), "the PATH"]);
  }
  return found;
}

/** Returns the interpreter that the Python extension has selected, if it is installed. */
async function selectedPython(uri?: vscode.Uri): Promise<string | undefined> {
  const extension = vscode.extensions.getExtension("ms-python.python");
  if (!extension) {
    return undefined;
  }
  try {
    const api = (extension.isActive ? extension.exports : await extension.activate()) as
      | { environments?: { getActiveEnvironmentPath(uri?: vscode.Uri): { path: string } } }
      | undefined;
    return api?.environments?.getActiveEnvironmentPath(uri).path;
  } catch {
    // Somebody else's extension; without it there are other places.
    return undefined;
  }
}

async function isExecutable(file: string): Promise<boolean> {
  try {
    await files.access(file, IS_WINDOWS ? constants.F_OK : constants.X_OK);
    return (await files.stat(file)).isFile();
  } catch {
    return false;
  }
}

/** Returns the folder of the workspace that a file belongs to, else the first one. */
export function folderOf(uri?: vscode.Uri): string | undefined {
  const folder = uri && vscode.workspace.getWorkspaceFolder(uri);
  return (folder ?? vscode.workspace.workspaceFolders?.[0])?.uri.fsPath;
}

/** Commands whose programs reach what the setting `network` names; others have no such option. */
const REACHING = ["check", "plot", "run"];

/** Options of the command line for the settings of a file. */
export function robotOptions(uri?: vscode.Uri, command = ""): string[] {
  const section = settings(uri);
  const options: string[] = [];
  for (const name of ["robot", "firmware", "world", ...(REACHING.includes(command) ? ["network"] : [])]) {
    const value = section.get<string>(name, "").trim();
    if (value) {
      options.push(`--${name}`, value);
    }
  }
  if (section.get<boolean>("strict", false)) {
    options.push("--strict");
  }
  return options;
}

/** Runs the command to its end. Relative paths of the settings count from the folder of the workspace. */
export function runToEnd(command: string, args: string[], folder?: string, signal?: AbortSignal): Promise<Ended> {
  return new Promise((resolve, reject) => {
    const options = { cwd: folder, maxBuffer: 256 * 1024 * 1024, windowsHide: true, ...(signal ? { signal } : {}) };
    execFile(command, args, options, (error, output, errorOutput) => {
      if (error && typeof error.code !== "number") {
        reject(error);
      } else {
        resolve({ code: Number(error?.code ?? 0), output, error: errorOutput });
      }
    });
  });
}

/** The command line that installs elitescript, for the user to confirm. */
export async function installCommand(uri?: vscode.Uri): Promise<string> {
  const python = (await selectedPython(uri)) ?? (IS_WINDOWS ? "python" : "python3");
  const quoted = /\s/.test(python) ? `"${python}"` : python;
  return `${quoted} -m pip install "elitescript[lsp]"`;
}

/** Writes the command that installs elitescript into a terminal; it runs when the user presses Enter. */
export async function offerInstall(uri?: vscode.Uri): Promise<void> {
  const folder = folderOf(uri);
  const terminal = vscode.window.createTerminal({ name: "Install elitescript", ...(folder ? { cwd: folder } : {}) });
  terminal.show();
  terminal.sendText(await installCommand(uri), false);
}

/** Says that there is no `elitescript`, once for each call, and offers what helps. */
export async function reportMissing(uri?: vscode.Uri): Promise<void> {
  const install = "Install in a terminal…";
  const choose = "Choose its path";
  const answer = await vscode.window.showWarningMessage(
    "The command `elitescript` was found neither in the workspace's .venv, nor in the selected Python environment, nor on the PATH.",
    install,
    choose,
  );
  if (answer === install) {
    await offerInstall(uri);
  } else if (answer === choose) {
    await vscode.commands.executeCommand("workbench.action.openSettings", "elitescript.path");
  }
}

/** Returns the command, or says that there is none. */
export async function needElitescript(uri?: vscode.Uri): Promise<Found | undefined> {
  const found = await findElitescript(uri);
  if (!found) {
    void reportMissing(uri);
  }
  return found;
}
