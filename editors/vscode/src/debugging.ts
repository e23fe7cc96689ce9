// The debug adapter: `elitescript dap` on standard input and output.

import * as vscode from "vscode";
import { folderOf, needElitescript, settings } from "./program";

export const TYPE = "elitescript";

/** Of what can be launched: programs, and the files of program trees. */
const LANGUAGES: readonly string[] = [TYPE, "elitescript-task"];

/** Starts one process of the adapter for each session. */
export class AdapterFactory implements vscode.DebugAdapterDescriptorFactory {
  async createDebugAdapterDescriptor(session: vscode.DebugSession): Promise<vscode.DebugAdapterDescriptor | undefined> {
    const program: unknown = session.configuration["program"];
    const uri = typeof program === "string" ? vscode.Uri.file(program) : session.workspaceFolder?.uri;
    const found = await needElitescript(uri);
    if (!found) {
      return undefined;
    }
    const folder = session.workspaceFolder?.uri.fsPath ?? folderOf(uri);
    return new vscode.DebugAdapterExecutable(found.command, ["dap"], folder ? { cwd: folder } : {});
  }
}

/** Completes what a launch configuration leaves out. */
export class Configurations implements vscode.DebugConfigurationProvider {
  provideDebugConfigurations(): vscode.DebugConfiguration[] {
    return [launchOf("${file}")];
  }

  resolveDebugConfiguration(
    _folder: vscode.WorkspaceFolder | undefined,
    given: vscode.DebugConfiguration,
  ): vscode.DebugConfiguration | undefined {
    if (given.type || given.request || given.name) {
      return given;
    }
    // F5 without a launch.json.
    return LANGUAGES.includes(vscode.window.activeTextEditor?.document.languageId ?? "") ? launchOf("${file}") : undefined;
  }

  resolveDebugConfigurationWithSubstitutedVariables(
    folder: vscode.WorkspaceFolder | undefined,
    given: vscode.DebugConfiguration,
  ): vscode.DebugConfiguration {
    const program: unknown = given["program"];
    // A robot that is attached to, and a journal, have their options.
    if (given.request !== "launch" || String(program).endsWith(".journal")) {
      return given;
    }
    const section = settings(typeof program === "string" ? vscode.Uri.file(program) : folder?.uri);
    const resolved = { ...given };
    for (const name of ["robot", "firmware", "world", "network"]) {
      const value = section.get<string>(name, "").trim();
      if (resolved[name] === undefined && value) {
        resolved[name] = value;
      }
    }
    if (resolved["strict"] === undefined && section.get<boolean>("strict", false)) {
      resolved["strict"] = true;
    }
    return resolved;
  }
}

/** A configuration that debugs one program, and stays at its end, since one can step back from there. */
export function launchOf(program: string): vscode.DebugConfiguration {
  const name = "EliteScript: current program";
  return { type: TYPE, request: "launch", name, program, stopOnEntry: true, stopOnEnd: true };
}
