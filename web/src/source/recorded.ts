/** A source that has everything already: the messages and rows of one run, in the order in which they were said. */

import type { FromSource, ToSource } from "./messages.ts";
import type { Rows } from "./rows.ts";
import type { Listener, Source } from "./source.ts";

export class RecordedSource implements Source {
  private readonly said: readonly (FromSource | Rows)[];

  constructor(said: readonly (FromSource | Rows)[]) {
    this.said = said;
  }

  start(listener: Listener): void {
    listener.linked("open");
    for (const entry of this.said) {
      if ("ticks" in entry) listener.rows(entry);
      else listener.message(entry);
    }
  }

  send(_message: ToSource): void {}

  close(): void {}
}
