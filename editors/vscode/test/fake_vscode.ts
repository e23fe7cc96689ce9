// Stands in for the module `vscode`: no editor. It keeps what the extension registers, shows and asks, for the tests.

import * as path from "node:path";

type Listener<T> = (event: T) => unknown;

export class Disposable {
  constructor(private readonly end: () => void = () => undefined) {}
  dispose(): void {
    this.end();
  }
}

export class EventEmitter<T> {
  private readonly listeners = new Set<Listener<T>>();
  readonly event = (listener: Listener<T>): Disposable => {
    this.listeners.add(listener);
    return new Disposable(() => this.listeners.delete(listener));
  };
  async fire(event: T): Promise<void> {
    for (const listener of this.listeners) {
      await listener(event);
    }
  }
}

export class Uri {
  private constructor(
    readonly scheme: string,
    readonly fsPath: string,
  ) {}
  static file(file: string): Uri {
    return new Uri("file", file);
  }
  static parse(text: string): Uri {
    const [scheme = "", rest = ""] = text.split("://");
    return new Uri(scheme, decodeURIComponent(rest));
  }
  static joinPath(uri: Uri, ...parts: string[]): Uri {
    return new Uri(uri.scheme, path.join(uri.fsPath, ...parts));
  }
  toString(): string {
    return `${this.scheme}://${this.fsPath}`;
  }
}

export class Range {
  constructor(
    readonly startLine: number,
    readonly startCharacter: number,
    readonly endLine: number,
    readonly endCharacter: number,
  ) {}
  contains(place: { line: number; character: number }): boolean {
    const at = [place.line, place.character];
    return isOrdered([this.startLine, this.startCharacter], at) && isOrdered(at, [this.endLine, this.endCharacter]);
  }
}

function isOrdered(one: number[], other: number[]): boolean {
  return one[0]! < other[0]! || (one[0] === other[0] && one[1]! <= other[1]!);
}

export class RelativePattern {
  constructor(
    readonly folder: unknown,
    readonly pattern: string,
  ) {}
}

export class DebugAdapterExecutable {
  constructor(
    readonly command: string,
    readonly args: string[],
    readonly options: { cwd?: string },
  ) {}
}

export class ProcessExecution {
  constructor(
    readonly process: string,
    readonly args: string[],
    readonly options: { cwd?: string },
  ) {}
}

export class Task {
  group: unknown;
  presentationOptions: unknown;
  constructor(
    readonly definition: { type: string },
    readonly scope: unknown,
    readonly name: string,
    readonly source: string,
    readonly execution: ProcessExecution,
    readonly problemMatchers: string,
  ) {}
}

export class SnippetString {
  constructor(readonly value = "") {}
  appendText(text: string): SnippetString {
    return new SnippetString(this.value + text.replace(/[$}\\]/g, "\\$&"));
  }
  appendTabstop(number: number): SnippetString {
    return new SnippetString(`${this.value}$${number}`);
  }
}

export class Position {
  constructor(
    readonly line: number,
    readonly character: number,
  ) {}
}

export class Location {
  constructor(
    readonly uri: Uri,
    readonly place: Position,
  ) {}
}

export class TestMessage {
  location: Location | undefined;
  constructor(readonly message: string) {}
}

export const TaskGroup = { Build: "build" };
export const TaskScope = { Global: 1, Workspace: 2 };
export const TaskPanelKind = { Dedicated: 2 };
export const ViewColumn = { Beside: -2 };
export const TestRunProfileKind = { Run: 1 };
export const DebugConfigurationProviderTriggerKind = { Initial: 1, Dynamic: 2 };

/** What a test sets before, and looks at afterwards. */
export const fake = {
  settings: {} as Record<string, unknown>,
  folders: [] as { uri: Uri; name: string }[],
  documents: [] as { uri: Uri; isDirty: boolean; languageId: string; save(): Promise<boolean> }[],
  active: undefined as { uri: Uri; languageId: string } | undefined,
  editor: undefined as unknown,
  isTrusted: true,
  python: undefined as string | undefined,
  answer: undefined as string | undefined,
  files: [] as Uri[],
  commands: new Map<string, (...args: unknown[]) => unknown>(),
  executed: [] as unknown[][],
  messages: [] as string[],
  terminals: [] as { name: string; sent: [string, boolean][] }[],
  tasks: [] as Task[],
  debugged: [] as unknown[],
  session: undefined as { type: string; customRequest(name: string, given: unknown): Promise<unknown> } | undefined,
  panels: [] as FakePanel[],
  controllers: [] as FakeController[],
  results: [] as string[],
  onSaved: new EventEmitter<{ uri: Uri }>(),
  onTrusted: new EventEmitter<void>(),
  onSettings: new EventEmitter<{ affectsConfiguration(name: string): boolean }>(),
};

/** Forgets everything. */
export function reset(): void {
  Object.assign(fake, {
    settings: {}, folders: [], documents: [], active: undefined, editor: undefined, isTrusted: true, python: undefined, answer: undefined,
    files: [], commands: new Map(), executed: [], messages: [], terminals: [], tasks: [], debugged: [], session: undefined, panels: [],
    controllers: [], results: [], onSaved: new EventEmitter(), onTrusted: new EventEmitter(), onSettings: new EventEmitter(),
  });
}

export class FakePanel {
  isOpen = true;
  revealed = 0;
  readonly webview = { html: "" };
  private readonly closed = new EventEmitter<void>();
  readonly onDidDispose = this.closed.event;
  constructor(
    readonly title: string,
    readonly options: { enableScripts: boolean; localResourceRoots: unknown[] },
  ) {}
  reveal(): void {
    this.revealed += 1;
  }
  dispose(): void {
    this.isOpen = false;
    void this.closed.fire();
  }
}

export class FakeItem {
  error: string | undefined;
  range: Range | undefined;
  readonly children = new FakeItems();
  constructor(
    readonly id: string,
    readonly label: string,
    readonly uri?: Uri,
  ) {}
}

export class FakeItems {
  private items: FakeItem[] = [];
  get size(): number {
    return this.items.length;
  }
  add(item: FakeItem): void {
    this.items.push(item);
  }
  replace(items: FakeItem[]): void {
    this.items = [...items];
  }
  forEach(work: (item: FakeItem) => void): void {
    this.items.forEach((item) => work(item));
  }
  *[Symbol.iterator](): Iterator<[string, FakeItem]> {
    for (const item of this.items) {
      yield [item.id, item];
    }
  }
}

export class FakeController {
  readonly items = new FakeItems();
  run: (request: unknown, token: unknown) => Promise<void> = async () => undefined;
  createTestItem(id: string, label: string, uri?: Uri): FakeItem {
    return new FakeItem(id, label, uri);
  }
  createRunProfile(_name: string, _kind: number, run: typeof this.run): void {
    this.run = run;
  }
  createTestRun(): unknown {
    const say =
      (word: string) =>
      (item: FakeItem, message?: TestMessage): number =>
        fake.results.push(
          [word, item.label, ...(message ? [message.message, `line ${message.location?.place.line}`] : [])].join(" | "),
        );
    return {
      started: () => undefined,
      appendOutput: () => undefined,
      end: () => fake.results.push("end"),
      passed: say("passed"),
      failed: say("failed"),
      skipped: say("skipped"),
      errored: say("errored"),
    };
  }
  dispose(): void {}
}

const nothing = (): Disposable => new Disposable();

export const workspace = {
  get isTrusted(): boolean {
    return fake.isTrusted;
  },
  get workspaceFolders(): unknown {
    return fake.folders.length > 0 ? fake.folders : undefined;
  },
  get textDocuments(): unknown {
    return fake.documents;
  },
  getConfiguration: (section: string) => ({
    get: (name: string, fallback: unknown): unknown => fake.settings[`${section}.${name}`] ?? fallback,
  }),
  getWorkspaceFolder: (uri: Uri) => fake.folders.find((folder) => uri.fsPath.startsWith(folder.uri.fsPath)),
  asRelativePath: (uri: Uri) => path.basename(uri.fsPath),
  findFiles: async () => fake.files,
  createFileSystemWatcher: () => ({ onDidChange: nothing, onDidCreate: nothing, onDidDelete: nothing, dispose: () => undefined }),
  openTextDocument: async (given: { content: string }) => given,
  fs: { readFile: async (uri: Uri) => (await import("node:fs/promises")).readFile(uri.fsPath) },
  onDidSaveTextDocument: (listener: Listener<{ uri: Uri }>) => fake.onSaved.event(listener),
  onDidGrantWorkspaceTrust: (listener: Listener<void>) => fake.onTrusted.event(listener),
  onDidChangeConfiguration: (listener: Listener<{ affectsConfiguration(name: string): boolean }>) =>
    fake.onSettings.event(listener),
};

async function ask(text: string): Promise<string | undefined> {
  fake.messages.push(text);
  return fake.answer;
}

export const window = {
  get activeTextEditor(): unknown {
    return fake.editor ?? (fake.active && { document: fake.active });
  },
  showWarningMessage: ask,
  showErrorMessage: ask,
  showInformationMessage: ask,
  showInputBox: async (given: { value?: string }) => given.value || fake.answer,
  showQuickPick: async (items: unknown[]) => items[0],
  showTextDocument: async (document: { content: string }) => fake.messages.push(document.content),
  createTerminal: (given: { name: string }) => {
    const terminal = { name: given.name, sent: [] as [string, boolean][] };
    fake.terminals.push(terminal);
    return { show: () => undefined, sendText: (text: string, run: boolean) => terminal.sent.push([text, run]) };
  },
  createWebviewPanel: (_type: string, title: string, _place: unknown, options: FakePanel["options"]) => {
    const panel = new FakePanel(title, options);
    fake.panels.push(panel);
    return panel;
  },
};

export const commands = {
  registerCommand: (name: string, work: (...args: unknown[]) => unknown) => {
    fake.commands.set(name, work);
    return new Disposable(() => fake.commands.delete(name));
  },
  executeCommand: async (...words: unknown[]) => fake.executed.push(words),
};

export const extensions = {
  getExtension: (name: string) =>
    name === "ms-python.python" && fake.python
      ? { isActive: true, exports: { environments: { getActiveEnvironmentPath: () => ({ path: fake.python }) } } }
      : undefined,
};

export const debug = {
  activeStackItem: { frameId: 4 },
  get activeDebugSession(): unknown {
    return fake.session;
  },
  registerDebugAdapterDescriptorFactory: nothing,
  registerDebugConfigurationProvider: nothing,
  startDebugging: async (_folder: unknown, configuration: unknown) => fake.debugged.push(configuration),
};

export const tasks = {
  registerTaskProvider: nothing,
  executeTask: async (task: Task) => fake.tasks.push(task),
};

export const tests = {
  createTestController: () => {
    const controller = new FakeController();
    fake.controllers.push(controller);
    return controller;
  },
};
