/** Where the page's data comes from. */

import type { FromSource, ToSource } from "./messages.ts";
import type { Rows } from "./rows.ts";

export type Link = "connecting" | "open" | "lost";

export interface Listener {
  message(message: FromSource): void;
  rows(rows: Rows): void;
  linked(link: Link): void;
}

export interface Source {
  /** Begins the conversation: the first message is `hello`. */
  start(listener: Listener): void;
  /** Sends a message; while the link is lost it is dropped, and `Studio` tells the present state again on `hello`. */
  send(message: ToSource): void;
  close(): void;
}
