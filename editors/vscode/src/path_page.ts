// The page of `elitescript plot`, beside the editor, new after each save.

import { promises as files } from "node:fs";
import * as os from "node:os";
import * as path from "node:path";
import * as vscode from "vscode";
import { Ended, folderOf, needElitescript, robotOptions, runToEnd } from "./program";
import { saved } from "./tasks";

/** Shows a page for each program that was asked for. */
export class PathPages implements vscode.Disposable {
  private readonly pages = new Map<string, PathPage>();
  private readonly listener = vscode.workspace.onDidSaveTextDocument((document) => {
    void this.pages.get(document.uri.toString())?.draw();
  });

  /** Shows the page of a program, drawn anew. */
  async show(uri: vscode.Uri): Promise<void> {
    await saved(uri);
    const key = uri.toString();
    let page = this.pages.get(key);
    if (!page) {
      page = new PathPage(uri, () => this.pages.delete(key));
      this.pages.set(key, page);
    }
    page.reveal();
    await page.draw();
  }

  dispose(): void {
    this.listener.dispose();
    for (const page of [...this.pages.values()]) {
      page.dispose();
    }
  }
}

class PathPage {
  private readonly panel: vscode.WebviewPanel;
  private drawing: AbortController | undefined;

  constructor(
    private readonly uri: vscode.Uri,
    onClosed: () => void,
  ) {
    const place = { viewColumn: vscode.ViewColumn.Beside, preserveFocus: true };
    this.panel = vscode.window.createWebviewPanel("elitescript.path", `Path of ${path.basename(uri.fsPath)}`, place, {
      // The page is made by elitescript, holds all that it needs, and may load nothing (its content policy).
      enableScripts: true,
      retainContextWhenHidden: true,
      localResourceRoots: [],
    });
    this.panel.onDidDispose(() => {
      this.drawing?.abort();
      onClosed();
    });
  }

  reveal(): void {
    this.panel.reveal(undefined, true);
  }

  dispose(): void {
    this.panel.dispose();
  }

  /** Runs the program and shows its page; a drawing that is under way is given up. */
  async draw(): Promise<void> {
    this.drawing?.abort();
    const drawing = new AbortController();
    this.drawing = drawing;
    const found = await needElitescript(this.uri);
    if (!found || drawing.signal.aborted) {
      return;
    }
    const folder = await files.mkdtemp(path.join(os.tmpdir(), "elitescript-"));
    try {
      const file = path.join(folder, "page.html");
      // It runs with every save: nothing real may be reached.
      const words = ["plot", this.uri.fsPath, "-o", file, ...robotOptions(this.uri), "--network", "none"];
      const ended = await runToEnd(found.command, words, folderOf(this.uri), drawing.signal);
      const html = await files.readFile(file, "utf8").catch(() => undefined);
      if (!drawing.signal.aborted) {
        this.panel.webview.html = html ?? failurePage(ended);
      }
    } catch (error) {
      if (!drawing.signal.aborted) {
        this.panel.webview.html = failurePage({ code: -1, output: "", error: String(error) });
      }
    } finally {
      await files.rm(folder, { recursive: true, force: true });
    }
  }
}

function failurePage(ended: Ended): string {
  const text = `${ended.error}${ended.output}`.replace(/&/g, "&amp;").replace(/</g, "&lt;");
  const policy = "default-src 'none'; style-src 'unsafe-inline'";
  return `<!DOCTYPE html><meta http-equiv="Content-Security-Policy" content="${policy}"><h3>There is no page</h3><pre style="white-space:pre-wrap">${text}</pre>`;
}
