// Stands in for the client library of the language server: it keeps what was started.

export const State = { Stopped: 1, Starting: 3, Running: 2 };

export const started: { command: string; args: string[] }[] = [];
export const behaviour = { fails: false };

export class LanguageClient {
  state = State.Stopped;
  readonly outputChannel = { appendLine: () => undefined, show: () => undefined };
  constructor(
    _id: string,
    _name: string,
    readonly server: { command: string; args: string[] },
  ) {}
  async start(): Promise<void> {
    if (behaviour.fails) {
      throw new Error("it ended with code 2");
    }
    this.state = State.Running;
    started.push({ command: this.server.command, args: this.server.args });
  }
  needsStop(): boolean {
    return this.state === State.Running;
  }
  async stop(): Promise<void> {
    this.state = State.Stopped;
  }
}
