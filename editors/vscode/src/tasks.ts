// Tasks: commands of elitescript whose problems are shown at their lines.

import * as vscode from "vscode";
import { findElitescript, needElitescript, robotOptions } from "./program";

interface Definition extends vscode.TaskDefinition {
  command: string;
  files?: string[];
  args?: string[];
}

/** Offers to check each folder, and completes tasks of `tasks.json`. */
export class Tasks implements vscode.TaskProvider {
  async provideTasks(): Promise<vscode.Task[]> {
    const tasks: vscode.Task[] = [];
    for (const folder of vscode.workspace.workspaceFolders ?? []) {
      const found = await findElitescript(folder.uri);
      if (found) {
        const definition: Definition = { type: "elitescript", command: "check", files: ["."] };
        tasks.push(taskOf(definition, folder, found.command, `check ${folder.name}`));
      }
    }
    return tasks;
  }

  async resolveTask(task: vscode.Task): Promise<vscode.Task | undefined> {
    const definition = task.definition as Definition;
    const scope = task.scope;
    const folder = typeof scope === "object" ? scope : vscode.workspace.workspaceFolders?.[0];
    const found = await findElitescript(folder?.uri);
    return found && taskOf(definition, scope ?? vscode.TaskScope.Workspace, found.command, task.name);
  }
}

function taskOf(
  definition: Definition,
  scope: vscode.WorkspaceFolder | vscode.TaskScope,
  command: string,
  name: string,
): vscode.Task {
  const uri = typeof scope === "object" ? scope.uri : undefined;
  const options = definition.command === "fmt" ? [] : robotOptions(uri, definition.command);
  const words = [definition.command, ...(definition.files ?? ["."]), ...options, ...(definition.args ?? [])];
  const execution = new vscode.ProcessExecution(command, words, typeof scope === "object" ? { cwd: scope.uri.fsPath } : {});
  const task = new vscode.Task(definition, scope, name, "elitescript", execution, "$elitescript");
  if (definition.command === "check") {
    task.group = vscode.TaskGroup.Build;
  }
  return task;
}

/** Saves a program and runs it in the terminal. */
export async function runProgram(uri: vscode.Uri): Promise<void> {
  const found = await needElitescript(uri);
  if (!found) {
    return;
  }
  await saved(uri);
  const folder = vscode.workspace.getWorkspaceFolder(uri);
  const definition: Definition = { type: "elitescript", command: "run", files: [uri.fsPath] };
  const name = `run ${vscode.workspace.asRelativePath(uri)}`;
  const task = taskOf(definition, folder ?? vscode.TaskScope.Global, found.command, name);
  task.presentationOptions = { clear: true, panel: vscode.TaskPanelKind.Dedicated, showReuseMessage: false };
  await vscode.tasks.executeTask(task);
}

/** Saves the text of a file, if it is open and changed. */
export async function saved(uri: vscode.Uri): Promise<void> {
  const open = vscode.workspace.textDocuments.find((document) => document.uri.toString() === uri.toString());
  if (open?.isDirty) {
    await open.save();
  }
}
