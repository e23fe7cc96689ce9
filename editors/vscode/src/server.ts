// The language server: `elitescript lsp` on standard input and output.

import * as vscode from "vscode";
import { LanguageClient, State } from "vscode-languageclient/node";
import { Found, findElitescript, folderOf, offerInstall, reportMissing } from "./program";

/**
 * Makes an edit that adds lines at the cursor, and returns the others. VS Code would put the cursor behind the added
 * lines: below the `end` of a new block instead of into its body.
 */
export async function keepCursor(
  document: vscode.TextDocument,
  position: vscode.Position,
  edits: vscode.TextEdit[] | null | undefined,
): Promise<vscode.TextEdit[]> {
  const [edit, ...others] = edits ?? [];
  const editor = vscode.window.activeTextEditor;
  if (!edit || others.length > 0 || editor?.document !== document) {
    return edits ?? [];
  }
  const cut = edit.newText.indexOf("\n");
  if (cut < 0 || !edit.range.contains(position)) {
    return [edit];
  }
  const snippet = new vscode.SnippetString().appendText(edit.newText.slice(0, cut)).appendTabstop(0);
  await editor.insertSnippet(snippet.appendText(edit.newText.slice(cut)), edit.range, {
    undoStopBefore: false,
    undoStopAfter: true,
  });
  return [];
}

/** Starts and stops the server, and starts it again when its command changes. */
export class Server implements vscode.Disposable {
  private client: LanguageClient | undefined;
  private command = "";
  private queue: Promise<void> = Promise.resolve();
  private isMissingReported = false;

  /** Starts the server that the settings name; does nothing if it runs already. */
  start(): Promise<void> {
    return this.inTurn(async () => {
      const uri = vscode.window.activeTextEditor?.document.uri;
      const found = await findElitescript(uri);
      await vscode.commands.executeCommand("setContext", "elitescript.found", found !== undefined);
      if (!found) {
        await this.end();
        if (!this.isMissingReported) {
          this.isMissingReported = true;
          void reportMissing(uri);
        }
        return;
      }
      if (found.command !== this.command || this.client?.state === State.Stopped) {
        await this.end();
        await this.begin(found);
      }
    });
  }

  /** Ends the server and starts it. */
  async restart(): Promise<void> {
    await this.inTurn(() => this.end());
    await this.start();
  }

  dispose(): Promise<void> {
    return this.inTurn(() => this.end());
  }

  private async begin(found: Found): Promise<void> {
    const folder = folderOf();
    const client = new LanguageClient(
      "elitescript",
      "EliteScript",
      { command: found.command, args: ["lsp"], options: folder ? { cwd: folder } : {} },
      {
        documentSelector: [
          { language: "elitescript", scheme: "file" },
          { language: "elitescript", scheme: "untitled" },
          // Files of the pendant's program trees: outline, hover and findings.
          { language: "elitescript-task", scheme: "file" },
        ],
        synchronize: { configurationSection: "elitescript" },
        initializationFailedHandler: () => false,
        middleware: {
          provideOnTypeFormattingEdits: async (document, position, character, options, token, next) =>
            keepCursor(document, position, await next(document, position, character, options, token)),
        },
      },
    );
    this.client = client;
    this.command = found.command;
    try {
      await client.start();
    } catch (error) {
      client.outputChannel.appendLine(`${found.command} lsp (${found.where}) does not start: ${String(error)}`);
      void this.reportFailure(client);
    }
  }

  private async reportFailure(client: LanguageClient): Promise<void> {
    const show = "Show output";
    const install = "Install in a terminal…";
    const answer = await vscode.window.showErrorMessage(
      "The language server of elitescript does not start. It needs `elitescript[lsp]`.",
      show,
      install,
    );
    if (answer === show) {
      client.outputChannel.show();
    } else if (answer === install) {
      await offerInstall();
    }
  }

  private async end(): Promise<void> {
    const client = this.client;
    this.client = undefined;
    this.command = "";
    if (client?.needsStop()) {
      // A server that has died cannot answer that it ends.
      await client.stop().catch(() => undefined);
    }
  }

  /** Does one thing after the other, so that two starts do not cross. */
  private inTurn(work: () => Promise<void>): Promise<void> {
    this.queue = this.queue.then(work, work);
    return this.queue;
  }
}
