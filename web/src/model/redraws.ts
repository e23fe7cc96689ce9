/** When pictures are drawn: while keys come one after another, what they show waits, because keys come first. */

import type { Frames } from "./playback.ts";

/** Keys nearer to each other than this are typing, ms: one key alone, or the first, delays nothing. */
export const BURST_MS = 250;
/** Quiet time after the last key, and longest wait of a picture, ms. */
export const QUIET_MS = 150;
export const LONGEST_MS = 400;

export class Typing {
  private last = -Infinity;
  private isBurst = false;

  key(now: number): void {
    this.isBurst = now - this.last < BURST_MS;
    this.last = now;
  }

  /** Returns how long a picture waits yet that was asked for at `since`, ms. */
  wait(now: number, since: number): number {
    return this.isBurst ? Math.max(0, Math.min(this.last + QUIET_MS, since + LONGEST_MS) - now) : 0;
  }
}

/** Frames of pictures that wait while keys come. */
export class RestingFrames implements Frames {
  private readonly typing: Typing;
  private readonly frames: Frames;
  private readonly now: () => number;
  private readonly cancels = new Map<number, () => void>();
  private next = 1;

  constructor(typing: Typing, frames: Frames, now: () => number = () => performance.now()) {
    this.typing = typing;
    this.frames = frames;
    this.now = now;
  }

  request(frame: (t: number) => void): number {
    const handle = this.next++;
    const since = this.now();
    const look = () => {
      const wait = this.typing.wait(this.now(), since);
      if (wait > 0) {
        const timer = setTimeout(look, wait);
        this.cancels.set(handle, () => clearTimeout(timer));
        return;
      }
      const asked = this.frames.request((t) => {
        this.cancels.delete(handle);
        frame(t);
      });
      this.cancels.set(handle, () => this.frames.cancel(asked));
    };
    look();
    return handle;
  }

  cancel(handle: number): void {
    this.cancels.get(handle)?.();
    this.cancels.delete(handle);
  }
}
