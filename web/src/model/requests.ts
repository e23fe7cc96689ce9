/** Messages that are answered: each gets a number, and its promise is kept when the answer with that number comes. */

import type { FromSource, ToSource } from "../source/messages.ts";
import { text } from "../text/text.ts";

/** After which a request has failed; the longest are runs up to a stretch of rows. */
export const ANSWER_MS = 20_000;

export type Request = Extract<ToSource, { readonly ask: number }>;
export type Answer = Extract<FromSource, { readonly ask: number }> | Extract<FromSource, { readonly type: "refused" }>;

/** A request that the source has refused; `message` is its reason, for people. */
export class Refused extends Error {
  readonly answer: Extract<FromSource, { readonly type: "refused" }>;

  constructor(answer: Extract<FromSource, { readonly type: "refused" }>) {
    super(answer.text);
    this.answer = answer;
  }
}

export class Requests {
  private next = 1;
  private readonly waiting = new Map<number, { resolve: (answer: FromSource) => void; reject: (reason: Error) => void; timer: ReturnType<typeof setTimeout> }>();
  private readonly transmit: (message: ToSource) => void;
  private readonly refusal: () => string | null;

  /** @param refusal why nothing can be asked now; null if it can. */
  constructor(transmit: (message: ToSource) => void, refusal: () => string | null) {
    this.transmit = transmit;
    this.refusal = refusal;
  }

  /** Sends a message with the next number. Rejects with `Refused`, or an Error where no answer comes. */
  send(message: Request): Promise<FromSource> {
    const refusal = this.refusal();
    if (refusal !== null) return Promise.reject(new Error(refusal));
    const ask = this.next++;
    return new Promise((resolve, reject) => {
      const timer = setTimeout(() => this.fail(ask, text("no_answer", { s: ANSWER_MS / 1000, what: message.type })), ANSWER_MS);
      this.waiting.set(ask, { resolve, reject, timer });
      this.transmit({ ...message, ask });
    });
  }

  /** Takes an answer; returns whether anything waited for it. */
  settle(answer: Answer): boolean {
    const found = answer.ask === undefined ? undefined : this.take(answer.ask);
    if (answer.type === "refused") found?.reject(new Refused(answer));
    else found?.resolve(answer);
    return found !== undefined;
  }

  /** Fails all that wait: nothing that was asked over a lost link is answered. */
  drop(reason: string): void {
    for (const ask of [...this.waiting.keys()]) this.fail(ask, reason);
  }

  private fail(ask: number, reason: string): void {
    this.take(ask)?.reject(new Error(reason));
  }

  private take(ask: number) {
    const found = this.waiting.get(ask);
    if (found !== undefined) clearTimeout(found.timer);
    this.waiting.delete(ask);
    return found;
  }
}
