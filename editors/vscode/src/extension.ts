// What VS Code calls: everything that the extension offers is registered here.

import * as vscode from "vscode";
import { AdapterFactory, Configurations, launchOf, TYPE } from "./debugging";
import { PathPages } from "./path_page";
import { offerInstall } from "./program";
import { ScriptTests } from "./script_tests";
import { Server } from "./server";
import { runProgram, saved, Tasks } from "./tasks";
import { lastPass, runToTime, whoChanged } from "./travel";

const PROGRAM = `def hello():
  movej([0.3, -1.4, -1.7, -1.6, 1.57, 0], a=1.4, v=1.05)
  set_standard_digital_out(0, True)
  sleep(0.5)
  textmsg("the arm is at ", get_actual_tcp_pose())
end
`;

export async function activate(context: vscode.ExtensionContext): Promise<void> {
  context.subscriptions.push(vscode.commands.registerCommand("elitescript.newProgram", newProgram));
  if (vscode.workspace.isTrusted) {
    await start(context);
  } else {
    // Programs of the workspace, such as its .venv, run only when somebody trusts it.
    context.subscriptions.push(vscode.workspace.onDidGrantWorkspaceTrust(() => start(context)));
  }
}

async function start(context: vscode.ExtensionContext): Promise<void> {
  const server = new Server();
  const pages = new PathPages();
  const configurations = new Configurations();
  const tests = new ScriptTests();
  const { registerCommand } = vscode.commands;
  context.subscriptions.push(
    server,
    pages,
    tests,
    registerCommand("elitescript.run", (given?: unknown) => withProgram(given, runProgram)),
    registerCommand("elitescript.debug", (given?: unknown) => withProgram(given, debugProgram)),
    registerCommand("elitescript.debug.runToTime", runToTime),
    registerCommand("elitescript.debug.whoChanged", whoChanged),
    registerCommand("elitescript.debug.lastPass", lastPass),
    registerCommand("elitescript.showPath", (given?: unknown) => withProgram(given, (uri) => pages.show(uri))),
    registerCommand("elitescript.restartServer", () => server.restart()),
    registerCommand("elitescript.install", () => offerInstall(vscode.window.activeTextEditor?.document.uri)),
    vscode.debug.registerDebugAdapterDescriptorFactory(TYPE, new AdapterFactory()),
    vscode.debug.registerDebugConfigurationProvider(TYPE, configurations),
    vscode.debug.registerDebugConfigurationProvider(
      TYPE,
      configurations,
      vscode.DebugConfigurationProviderTriggerKind.Dynamic,
    ),
    vscode.tasks.registerTaskProvider("elitescript", new Tasks()),
    vscode.workspace.onDidChangeConfiguration((change) => {
      if (change.affectsConfiguration("elitescript.path")) {
        void server.start();
      }
    }),
  );
  await server.start();
}

async function newProgram(): Promise<void> {
  const document = await vscode.workspace.openTextDocument({ language: "elitescript", content: PROGRAM });
  await vscode.window.showTextDocument(document);
}

async function debugProgram(uri: vscode.Uri): Promise<void> {
  await saved(uri);
  await vscode.debug.startDebugging(vscode.workspace.getWorkspaceFolder(uri), launchOf(uri.fsPath));
}

/** Calls `work` with the program that a code lens, a menu or nothing names: the one in the editor. */
async function withProgram(given: unknown, work: (uri: vscode.Uri) => Promise<void>): Promise<void> {
  const uri = uriOf(given) ?? vscode.window.activeTextEditor?.document.uri;
  if (uri?.scheme !== "file") {
    void vscode.window.showInformationMessage("Open a program (*.script) and save it first.");
    return;
  }
  await work(uri);
}

function uriOf(given: unknown): vscode.Uri | undefined {
  return typeof given === "string" ? vscode.Uri.parse(given) : given instanceof vscode.Uri ? given : undefined;
}
