// Going through the history of a stopped run, by requests to the debug adapter. No logic of its own.

import * as vscode from "vscode";
import { TYPE } from "./debugging";

interface Change {
  old: string;
  new: string;
  t: number;
  thread: string;
  statement: number;
  line?: number;
  cause?: { statement: number };
}

/** Goes to a time of the robot, earlier or later. */
export async function runToTime(): Promise<void> {
  await inSession(async (session) => {
    const text = await vscode.window.showInputBox({ prompt: "Robot time, s", validateInput: refusal });
    if (text !== undefined && refusal(text) === undefined) {
      await session.customRequest("elitescript/goto", { t: Number(text) });
    }
  });
}

/** Shows all changes of the word at the cursor, the latest one first, and goes to the statement that made the chosen one. */
export async function whoChanged(): Promise<void> {
  await inSession(async (session) => {
    const prompt = "Variable or signal, such as count or standard_digital_out[3]";
    const name = await vscode.window.showInputBox({ prompt, value: wordAtCursor() });
    if (!name?.trim()) {
      return;
    }
    const frame = vscode.debug.activeStackItem;
    const { changes } = (await session.customRequest("elitescript/history", {
      name: name.trim(),
      // A local variable is that of the call that the user looks at.
      ...(frame && "frameId" in frame ? { frameId: frame.frameId } : {}),
    })) as { changes: Change[] };
    const items = [...changes].reverse().map((change) => ({
      label: `${change.old || "(not there)"} → ${change.new || "(not there)"}`,
      description: [`${change.t.toFixed(3)} s`, change.line && `line ${change.line}`, change.thread].filter(Boolean).join(", "),
      statement: change.cause?.statement ?? change.statement,
    }));
    const chosen = await vscode.window.showQuickPick(items, { placeHolder: `Changes of ${name.trim()}` });
    if (chosen) {
      await session.customRequest("elitescript/goto", { statement: chosen.statement });
    }
  });
}

/** Goes back to the last time that the line of the cursor was about to run. */
export async function lastPass(): Promise<void> {
  await inSession(async (session) => {
    const editor = vscode.window.activeTextEditor;
    if (editor) {
      const source = { path: editor.document.uri.fsPath };
      await session.customRequest("elitescript/lastPass", { source, line: editor.selection.active.line + 1 });
    }
  });
}

async function inSession(work: (session: vscode.DebugSession) => Promise<void>): Promise<void> {
  const session = vscode.debug.activeDebugSession;
  if (session?.type !== TYPE) {
    void vscode.window.showInformationMessage("Debug a program first (F5).");
    return;
  }
  try {
    await work(session);
  } catch (error) {
    void vscode.window.showErrorMessage(error instanceof Error ? error.message : String(error));
  }
}

function refusal(text: string): string | undefined {
  return text.trim() !== "" && Number(text) >= 0 && Number.isFinite(Number(text)) ? undefined : "A time in seconds, 0 or more";
}

function wordAtCursor(): string {
  const editor = vscode.window.activeTextEditor;
  const range = editor?.document.getWordRangeAtPosition(editor.selection.active, /[A-Za-z_]\w*(\[\d+\])?/);
  return editor && range ? editor.document.getText(range) : "";
}
